//! Hertz's normal spring with Mindlin's tangential spring without slip.
//!
//! F = (4/3) E* √R* δ^{3/2}, k_n = 2 E* a, k_t = 8 G* a with the contact radius a = √(R* δ).

use crate::contact::springs::ContactSprings;
use crate::lanes::Lanes;
use crate::material::Material;

/// Coefficients of the law for grains of one material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HertzMindlin {
    /// 2 E*, Pa.
    normal: f64,
    /// 8 G*, Pa.
    tangential: f64,
    young: f64,
    stiffness_ratio: f64,
}

impl HertzMindlin {
    /// Coefficients for grains of `material`.
    pub fn new(material: &Material) -> Self {
        Self {
            normal: 2.0 * material.effective_young(),
            tangential: 8.0 * material.effective_shear(),
            young: material.effective_young(),
            stiffness_ratio: material.stiffness_ratio(),
        }
    }
}

impl ContactSprings for HertzMindlin {
    #[inline(always)]
    fn normal_stiffness<L: Lanes>(&self, contact_radius: L, _: L) -> L {
        L::splat(self.normal) * contact_radius
    }

    #[inline(always)]
    fn normal_force<L: Lanes>(&self, normal_stiffness: L, overlap: L) -> L {
        // F = (4/3) E* √(R*) δ^{3/2} = (2/3) k_n δ
        L::splat(2.0 / 3.0) * normal_stiffness * overlap
    }

    #[inline(always)]
    fn normal_energy<L: Lanes>(&self, normal_force: L, _: L, overlap: L) -> L {
        L::splat(0.4) * normal_force * overlap
    }

    #[inline(always)]
    fn tangential_stiffness<L: Lanes>(&self, contact_radius: L, _: L, factor: f64) -> L {
        L::splat(self.tangential * factor) * contact_radius
    }

    fn stiffness_ratio(&self) -> f64 {
        self.stiffness_ratio
    }

    #[inline(always)]
    fn dashpot_ratio(&self) -> f64 {
        (self.tangential / self.normal).sqrt()
    }

    #[inline(always)]
    fn unloading<L: Lanes>(&self, before: L, contact_radius: L, _: L) -> L {
        L::select(before.gt(contact_radius), contact_radius / before, L::splat(1.0))
    }

    fn collision_overlap(&self, r_eff: f64, m_eff: f64, speed: f64) -> f64 {
        // m v²/2 = (8/15) E* √R* δ^{5/2}
        (15.0 / 16.0 * m_eff * speed * speed / (self.young * r_eff.sqrt())).powf(0.4)
    }
}

impl Material {
    /// Hertz normal force F = (4/3) E* √R* δ^{3/2}, N, for effective radius `r_eff` (m) and full overlap `overlap`
    /// (m, ≥ 0).
    ///
    /// ```
    /// let f = grainlab_core::Material::GLASS.normal_force(5.0e-5, 4.0e-8);
    /// assert!((f - 4.0 / 3.0 * 36.25e9 * (5.0e-5f64).sqrt() * (4.0e-8f64).powf(1.5)).abs() < 1e-14);
    /// ```
    pub fn normal_force(&self, r_eff: f64, overlap: f64) -> f64 {
        4.0 / 3.0 * self.effective_young() * (r_eff * overlap).sqrt() * overlap
    }

    /// Hertz normal stiffness k_n = 2 E* √(R* δ), N/m (Eq. 8 with full overlap δ; K_N = 2 k_n).
    pub fn normal_stiffness(&self, r_eff: f64, overlap: f64) -> f64 {
        2.0 * self.effective_young() * (r_eff * overlap).sqrt()
    }

    /// Mindlin tangential stiffness without slip k_t = 8 G* √(R* δ), N/m (Eq. 9 with full overlap δ; K_T = 2 k_t).
    pub fn tangential_stiffness(&self, r_eff: f64, overlap: f64) -> f64 {
        8.0 * self.effective_shear() * (r_eff * overlap).sqrt()
    }

    /// k_t/k_n = 2(1−ν)/(2−ν) of Hertz and Mindlin: 8/9 at ν = 0.2.
    pub fn stiffness_ratio(&self) -> f64 {
        2.0 * (1.0 - self.poisson_ratio) / (2.0 - self.poisson_ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::effective_radius;

    /// Eqs. 8 and 9 as printed, with δ half of the full overlap and D the diameter: K_N = 2 k_n, K_T = 2 k_t.
    #[test]
    fn stiffnesses_are_eqs_8_and_9_in_full_overlap() {
        let (m, d, overlap) = (Material::GLASS, 2.0e-4f64, 3.0e-8f64);
        let half = overlap / 2.0;
        let k_n = 2f64.powf(1.5) * m.shear_modulus * d.sqrt() / (1.0 - m.poisson_ratio) * half.sqrt();
        let k_t = 2f64.powf(2.5) * m.shear_modulus * d.sqrt() / (2.0 - m.poisson_ratio) * half.sqrt();
        let r_eff = effective_radius(d / 2.0, d / 2.0);
        assert!((m.normal_stiffness(r_eff, overlap) / (k_n / 2.0) - 1.0).abs() < 1e-14);
        assert!((m.tangential_stiffness(r_eff, overlap) / (k_t / 2.0) - 1.0).abs() < 1e-14);
        assert!((m.stiffness_ratio() - 8.0 / 9.0).abs() < 1e-15);
    }
}
