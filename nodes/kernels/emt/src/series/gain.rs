//! Contact laws by what they change in a packing: the mean contact stiffness over that of Hertz contacts with the same forces.

use grainlab_core::Material;
use grainlab_core::contact::{ContactSprings, Rough};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_1_SQRT_2;
use std::fmt;
use std::sync::OnceLock;

/// A family of contact laws: the stiffness over force, but for the force at which it changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ContactKind {
    /// Smooth spheres: k ∝ F^⅓.
    Hertz,
    /// A stiffness that does not depend on the force.
    Linear,
    /// Asperities, a transition, and Hertz (Otsubo et al. 2017).
    Rough,
    /// Cones at small forces, k ∝ F^½ (Goddard 1990), and Hertz at large ones.
    Blunt,
}

/// ln(p/p_r) of the tables: from here to its negative, in so many steps.
const FROM: f64 = -16.0;
const STEPS: usize = 320;

/// Forces of the quadrature, in units of their mean: midpoints up to 8.
const FORCES: usize = 400;
const PER_MEAN: f64 = 50.0;

/// z at which ln(p/p_r) is meant.
const REFERENCE_Z: f64 = 5.0;

impl ContactKind {
    /// All of them.
    pub const ALL: [ContactKind; 4] = [Self::Hertz, Self::Linear, Self::Rough, Self::Blunt];

    /// Name in files and answers.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hertz => "hertz",
            Self::Linear => "linear",
            Self::Rough => "rough",
            Self::Blunt => "blunt",
        }
    }

    /// True if the law has a stiffness of its own and no limit in the material's: its level is meant at the middle pressure.
    pub(super) const fn is_free(self) -> bool {
        matches!(self, Self::Linear | Self::Blunt)
    }

    /// True if the stiffness changes its exponent at a pressure.
    pub const fn has_crossover(self) -> bool {
        matches!(self, Self::Rough | Self::Blunt)
    }

    /// ln of the mean stiffness over that of Hertz contacts, and its slope by ln p, at this ln p − ln p_r and z.
    pub fn gain(self, ln_pressure: f64, z: f64) -> [f64; 2] {
        let table = &tables()[self as usize];
        let step = -2.0 * FROM / STEPS as f64;
        let at = ((ln_pressure - (z / REFERENCE_Z).ln() - FROM) / step).clamp(0.0, STEPS as f64 - 1e-9);
        let (cell, part) = (at as usize, at.fract());
        let value = table[cell] + part * (table[cell + 1] - table[cell]);
        // The slope is continuous, so that steps of an iteration settle.
        let slope = |k: usize| {
            (table[(k + 1).min(STEPS)] - table[k.saturating_sub(1)])
                / (step * ((k + 1).min(STEPS) - k.saturating_sub(1)) as f64)
        };
        [value, slope(cell) + part * (slope(cell + 1) - slope(cell))]
    }

    /// Crossover pressure of rough grains, Pa: the mean contact force is F₁ = S E* √(R S), S = √2 S_q, at z = 5; from S_q over
    /// the diameter, E* and the solid fraction.
    pub fn crossover(roughness_over_diameter: f64, material: &Material, solid_fraction: f64) -> f64 {
        let combined = 2.0 * std::f64::consts::SQRT_2 * roughness_over_diameter;
        REFERENCE_Z * solid_fraction * material.effective_young() * combined.powf(1.5)
            / (4.0 * std::f64::consts::PI)
    }

    /// Stiffness over that of a Hertz contact at these forces, in units of the force at the crossover.
    fn over_hertz(self) -> Box<dyn Fn(f64) -> f64> {
        match self {
            Self::Hertz => Box::new(|_| 1.0),
            Self::Linear => Box::new(|force| force.powf(-1.0 / 3.0)),
            Self::Blunt => Box::new(|force| (force / (force + 1.0)).powf(1.0 / 6.0)),
            Self::Rough => {
                // E* = R* = S = 1.
                let unit = Material { shear_modulus: 1.0, poisson_ratio: 0.0, density: 1.0 };
                let springs = Rough { roughness: FRAC_1_SQRT_2, tangential_factor: 1.0 }.springs(&unit);
                let first = std::f64::consts::SQRT_2;
                let of = move |overlap: f64| {
                    let stiffness: f64 = springs.normal_stiffness(overlap.sqrt(), overlap);
                    [springs.normal_force(stiffness, overlap), stiffness]
                };
                Box::new(move |force| {
                    // The force rises with the overlap.
                    let (mut low, mut high) = (-30f64, 30f64);
                    for _ in 0..60 {
                        let middle = 0.5 * (low + high);
                        *(if of(middle.exp())[0] < force * first { &mut low } else { &mut high }) = middle;
                    }
                    of(low.exp())[1] / (6.0 * force * first).cbrt()
                })
            }
        }
    }

    /// The table over ln(p/p_r). Forces are distributed as f exp(−2 f), as in packings of frictional grains.
    fn table(self) -> Vec<f64> {
        let over_hertz = self.over_hertz();
        let force = |k: usize| (k as f64 + 0.5) / PER_MEAN;
        let weight = |f: f64| f * (-2.0 * f).exp();
        let sum = |of: &dyn Fn(f64) -> f64| (0..FORCES).map(|k| weight(force(k)) * of(force(k))).sum::<f64>();
        let mean = sum(&|f| f) / sum(&|_| 1.0);
        let hertz = sum(&|f| (f / mean).cbrt());
        let step = -2.0 * FROM / STEPS as f64;
        let at = |k: usize| {
            let scale = (FROM + step * k as f64).exp();
            (sum(&|f| (f / mean).cbrt() * over_hertz(f / mean * scale)) / hertz).ln()
        };
        (0..=STEPS).map(at).collect()
    }
}

fn tables() -> &'static [Vec<f64>; 4] {
    static TABLES: OnceLock<[Vec<f64>; 4]> = OnceLock::new();
    TABLES.get_or_init(|| ContactKind::ALL.map(ContactKind::table))
}

impl fmt::Display for ContactKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_the_laws_and_the_slope_is_that_of_the_value() {
        for (kind, low, high) in [
            (ContactKind::Hertz, 0.0, 0.0),
            (ContactKind::Linear, -1.0 / 3.0, -1.0 / 3.0),
            (ContactKind::Rough, 1.0 - 1.0 / 2.589_795 - 1.0 / 3.0, 0.0),
            (ContactKind::Blunt, 1.0 / 6.0, 0.0),
        ] {
            assert!((kind.gain(-14.0, 5.0)[1] - low).abs() < 2e-3, "{kind}: {:?}", kind.gain(-14.0, 5.0));
            assert!((kind.gain(14.0, 5.0)[1] - high).abs() < 2e-3, "{kind}");
            for x in [-5.0, -1.02, 0.33, 3.0] {
                let [up, down] = [0.05, -0.05].map(|d| kind.gain(x + d, 5.0)[0]);
                assert!(((up - down) / 0.1 - kind.gain(x, 5.0)[1]).abs() < 3e-3, "{kind} {x}");
            }
            assert_eq!(kind.gain(1.0 + (6f64 / 5.0).ln(), 6.0)[0], kind.gain(1.0, 5.0)[0]);
        }
    }

    /// 0.23, 0.45, 0.85 and 0.92 at 0.01, 0.1, 1 and 10 times the force of the crossover.
    #[test]
    fn a_rough_contact_is_softer_than_a_smooth_one_up_to_a_hundred_times_the_crossover() {
        let over = ContactKind::Rough.over_hertz();
        for (force, expected) in
            [(0.01, 0.23), (0.1, 0.45), (1.0, 0.85), (10.0, 0.92), (100.0, 1.0), (1e4, 1.0)]
        {
            assert!((over(force) - expected).abs() < 0.01, "{force}: {}", over(force));
        }
    }
}
