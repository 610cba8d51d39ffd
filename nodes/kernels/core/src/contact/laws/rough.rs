//! Springs of rough grains: asperities first, then a transition to the springs of Hertz and Mindlin.
//!
//! Otsubo, O'Sullivan, Hanley & Sim, Géotechnique 67, 452 (2017). The combined roughness of two surfaces is S = √2 S_q, and the
//! normal force over the full overlap δ has three stages:
//!
//! - F = F₁ (δ/δ₁)^c up to F₁ = S E* √(2 R* S), where asperities carry it
//! - F = F₂ ((δ − 0.82 S)/(δ₂ − 0.82 S))^b up to F₂ = 100 F₁
//! - F = (4/3) E* √R* (δ − 2.06 S)^{3/2} beyond, as between smooth grains that are 2.06 S smaller
//!
//! From the source, as its authors' program states it (geoLAMMPS, pair style `gran/CM/history`): the stages, √2, 0.82,
//! 2.06 = 0.82 + 1.24, F₁ and F₂, k_t/k_n of Mindlin. From continuous force and stiffness, there as here: δ₁, δ₂, b and c. All
//! four are pure numbers, with lengths in units of S. Not from the source: the factor on k_t/k_n, at most 1.

use crate::contact::law_parameter::LawParameter;
use crate::contact::laws::HertzMindlin;
use crate::contact::springs::ContactSprings;
use crate::lanes::Lanes;
use crate::material::Material;
use crate::power::power;
use std::ops::Bound;

/// Springs of rough grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rough {
    /// Root mean square roughness S_q of a grain's surface, m. Zero or positive; tens to hundreds of nm for glass beads.
    pub roughness: f64,
    /// k_t/k_n over that of Mindlin. Positive, at most 1.
    pub tangential_factor: f64,
}

impl Rough {
    /// Parameters in scenes and messages, in the order of the fields.
    pub const PARAMETERS: [LawParameter; 2] = [
        LawParameter::new(
            "roughness",
            "m",
            "root mean square roughness S_q of a grain's surface",
            None,
            LawParameter::FROM_ZERO,
        ),
        LawParameter::new(
            "tangential_factor",
            "",
            "k_t/k_n over that of Mindlin, 2(1 - nu)/(2 - nu)",
            Some(1.0),
            (Bound::Excluded(0.0), Bound::Included(1.0)),
        ),
    ];

    /// Springs of grains of `material`.
    pub fn springs(&self, material: &Material) -> RoughSprings {
        let hertz = HertzMindlin::new(material);
        let scale = std::f64::consts::SQRT_2 * self.roughness;
        RoughSprings { hertz, scale, tangential_factor: self.tangential_factor }
    }
}

/// δ₁/S: end of the first stage.
const FIRST: f64 = 2.1093188701006973;
/// δ₂/S: end of the second stage.
const SECOND: f64 = 24.467023732785822;
/// Lengths by which each stage starts later than the overlap, in units of S.
const OFFSETS: [f64; 3] = [0.0, 0.82, 2.06];
/// Exponents c and b of the force.
const C: f64 = 2.589795495330664;
const B: f64 = 1.583009685810189;
/// Stiffness at the end of the first and the second stage, over that of the second: 0.01^(1 − 1/b) and 1.
const LEVELS: [f64; 3] = [0.18340710185168518, 1.0, 1.0];
/// Energy beyond F (δ − offset)/(exponent + 1) in each stage, in units of F₁ S.
const ENERGIES: [f64; 3] = [0.0, 0.08843376383294597, 19.290839497144173];

/// Coefficients of the law for grains of one material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughSprings {
    hertz: HertzMindlin,
    /// Combined roughness S, m.
    scale: f64,
    tangential_factor: f64,
}

impl RoughSprings {
    /// The value of the stage that an overlap is in.
    #[inline(always)]
    fn at_stage<L: Lanes>(&self, overlap: L, [first, second, third]: [L; 3]) -> L {
        let from_second = L::select(overlap.gt(L::splat(SECOND * self.scale)), third, second);
        L::select(overlap.gt(L::splat(FIRST * self.scale)), from_second, first)
    }

    #[inline(always)]
    fn number_at_stage<L: Lanes>(&self, overlap: L, numbers: [f64; 3]) -> L {
        let [first, second, third] = numbers;
        self.at_stage(overlap, [L::splat(first), L::splat(second), L::splat(third)])
    }

    /// Overlap less the offset of its stage, m.
    #[inline(always)]
    fn compression<L: Lanes>(&self, overlap: L) -> L {
        overlap - self.number_at_stage(overlap, OFFSETS) * L::splat(self.scale)
    }

    /// Stiffness over that of smooth grains with this overlap.
    #[inline(always)]
    fn softening<L: Lanes>(&self, overlap: L) -> L {
        let s = self.scale;
        let end = self.number_at_stage(overlap, [FIRST, SECOND - OFFSETS[1], 1.0]) * L::splat(s);
        let base = self.compression(overlap) / end.max(L::splat(f64::MIN_POSITIVE));
        let base = L::select(overlap.gt(L::splat(SECOND * s)), L::splat(1.0), base);
        let exponent = self.number_at_stage(overlap, [C - 1.0, B - 1.0, 0.5]);
        let level = self.number_at_stage(overlap, LEVELS);
        // Hertz's compression, which is that at the end of the second stage up to there.
        let smooth = (overlap - L::splat(OFFSETS[2] * s)).max(L::splat((SECOND - OFFSETS[2]) * s));
        (smooth / overlap.max(L::splat(f64::MIN_POSITIVE))).sqrt() * level * power(base, exponent)
    }
}

impl ContactSprings for RoughSprings {
    #[inline(always)]
    fn normal_stiffness<L: Lanes>(&self, contact_radius: L, overlap: L) -> L {
        self.hertz.normal_stiffness(contact_radius, overlap) * self.softening(overlap)
    }

    #[inline(always)]
    fn normal_force<L: Lanes>(&self, normal_stiffness: L, overlap: L) -> L {
        let inverse = [1.0 / C, 1.0 / B, 2.0 / 3.0];
        self.number_at_stage(overlap, inverse) * normal_stiffness * self.compression(overlap)
    }

    #[inline(always)]
    fn normal_energy<L: Lanes>(&self, normal_force: L, contact_radius: L, overlap: L) -> L {
        let inverse = [1.0 / (C + 1.0), 1.0 / (B + 1.0), 0.4];
        let present = self.number_at_stage(overlap, inverse) * normal_force * self.compression(overlap);
        // F₁ = S E* √(2 R* S)
        let smooth = L::splat(self.scale) / overlap.max(L::splat(f64::MIN_POSITIVE));
        let first = self.hertz.normal_stiffness(contact_radius, overlap)
            * smooth.sqrt()
            * L::splat(std::f64::consts::FRAC_1_SQRT_2 * self.scale * self.scale);
        first.mul_add(self.number_at_stage(overlap, ENERGIES), present)
    }

    #[inline(always)]
    fn tangential_stiffness<L: Lanes>(&self, contact_radius: L, overlap: L, factor: f64) -> L {
        let smooth =
            self.hertz.tangential_stiffness(contact_radius, overlap, self.tangential_factor * factor);
        smooth * self.softening(overlap)
    }

    fn stiffness_ratio(&self) -> f64 {
        self.hertz.stiffness_ratio() * self.tangential_factor
    }

    #[inline(always)]
    fn dashpot_ratio(&self) -> f64 {
        self.hertz.dashpot_ratio() * self.tangential_factor.sqrt()
    }

    #[inline(always)]
    fn unloading<L: Lanes>(&self, before: L, contact_radius: L, overlap: L) -> L {
        let (one, fell) = (L::splat(1.0), before.gt(contact_radius));
        if !L::any(fell) {
            return one;
        }
        let kept = contact_radius / before;
        let softer = self.softening(overlap) / self.softening(overlap / (kept * kept));
        L::select(fell, kept * softer, one)
    }

    fn collision_overlap(&self, r_eff: f64, m_eff: f64, speed: f64) -> f64 {
        // Newton's method from above: the energy is convex in the overlap.
        let smooth = self.hertz.collision_overlap(r_eff, m_eff, speed);
        (0..100).fold(smooth + OFFSETS[2] * self.scale, |overlap, _| {
            let contact_radius = (r_eff * overlap).sqrt();
            let force = self.normal_force(self.normal_stiffness(contact_radius, overlap), overlap);
            let energy = self.normal_energy(force, contact_radius, overlap);
            overlap - (energy - 0.5 * m_eff * speed * speed) / force.max(f64::MIN_POSITIVE)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const R_EFF: f64 = 5e-5;

    fn law(roughness: f64) -> RoughSprings {
        Rough { roughness, tangential_factor: 1.0 }.springs(&Material::GLASS)
    }

    /// Stiffness, force and energy, in units of E* √R* and S.
    fn response(law: &RoughSprings, overlap: f64) -> [f64; 3] {
        let contact_radius = (R_EFF * overlap).sqrt();
        let k_n = law.normal_stiffness(contact_radius, overlap);
        let force = law.normal_force(k_n, overlap);
        let unit = Material::GLASS.effective_young() * (R_EFF * law.scale).sqrt();
        let energy = law.normal_energy(force, contact_radius, overlap);
        [k_n / unit, force / (unit * law.scale), energy / (unit * law.scale * law.scale)]
    }

    #[test]
    fn the_numbers_of_the_law_follow_from_continuity() {
        let ([_, offset, shift], c, b) = (OFFSETS, C, B);
        let (first_force, second_force) = (2f64.sqrt(), 100.0 * 2f64.sqrt());
        let second = (0.75 * second_force).powf(2.0 / 3.0) + shift;
        let exponent = 2.0 * (second - shift).sqrt() * (second - offset) / second_force;
        let first = (second - offset) * 0.01f64.powf(1.0 / exponent) + offset;
        let stiffness = exponent * first_force / (first - offset);
        let stored = first_force * first / (c + 1.0);
        let transition = (second_force * (second - offset) - first_force * (first - offset)) / (b + 1.0);
        for (number, expected) in [
            (SECOND, second),
            (b, exponent),
            (FIRST, first),
            (c, stiffness * first / first_force),
            (LEVELS[0], 0.01f64.powf(1.0 - 1.0 / b)),
            (ENERGIES[1], (stored - first_force * (first - offset) / (b + 1.0)) / first_force),
            (ENERGIES[2], (stored + transition - 0.4 * second_force * (second - shift)) / first_force),
        ] {
            assert!((number / expected - 1.0).abs() < 1e-13, "{number} {expected}");
        }
    }

    #[test]
    fn force_stiffness_and_energy_are_continuous_where_the_stages_meet() {
        let law = law(1e-7);
        for (end, force) in [(FIRST, 2f64.sqrt()), (SECOND, 100.0 * 2f64.sqrt())] {
            let [below, above] = [1.0 - 1e-15, 1.0 + 1e-15].map(|f| response(&law, f * end * law.scale));
            assert!((below[1] / force - 1.0).abs() < 1e-13, "{below:?}");
            for (a, b) in below.into_iter().zip(above) {
                assert!((a / b - 1.0).abs() < 1e-13, "{below:?} {above:?}");
            }
        }
    }

    #[test]
    fn without_roughness_the_springs_are_those_of_hertz_and_mindlin_to_the_bit() {
        let (smooth, hertz) = (law(0.0), HertzMindlin::new(&Material::GLASS));
        for overlap in [0.0, 1e-12, 3e-9, 4e-7] {
            let a: f64 = (R_EFF * overlap).sqrt();
            let force = hertz.normal_force(hertz.normal_stiffness(a, overlap), overlap);
            assert_eq!(smooth.normal_stiffness(a, overlap), hertz.normal_stiffness(a, overlap));
            assert_eq!(smooth.normal_force(smooth.normal_stiffness(a, overlap), overlap), force);
            assert_eq!(smooth.normal_energy(force, a, overlap), hertz.normal_energy(force, a, overlap));
            assert_eq!(
                smooth.tangential_stiffness(a, overlap, 1.0),
                hertz.tangential_stiffness(a, overlap, 1.0)
            );
        }
        // The difference vanishes with the roughness.
        for roughness in [1e-11, 1e-14] {
            let (rough, a) = (law(roughness), (R_EFF * 4e-8f64).sqrt());
            let softer = 1.0 - rough.normal_stiffness(a, 4e-8) / hertz.normal_stiffness(a, 4e-8);
            assert!((softer / (1.03 * rough.scale / 4e-8) - 1.0).abs() < 1e-2, "{softer}");
        }
    }
}
