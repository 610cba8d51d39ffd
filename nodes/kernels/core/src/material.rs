//! The grain's material and the contact stiffnesses that follow from it.

/// Elastic material of a grain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Shear modulus G of the grain, Pa. Positive.
    pub shear_modulus: f64,
    /// Poisson ratio ν of the grain. In [0, 0.5].
    pub poisson_ratio: f64,
    /// Density of the grain, kg/m³. Positive.
    pub density: f64,
}

impl Material {
    /// The paper's glass: G = 29 GPa, ν = 0.2, with a density of 2500 kg/m³ (which the paper does not give).
    pub const GLASS: Material = Material { shear_modulus: 29.0e9, poisson_ratio: 0.2, density: 2500.0 };

    /// Effective modulus E* = G/(1−ν) of two grains of this material, Pa.
    pub fn effective_young(&self) -> f64 {
        self.shear_modulus / (1.0 - self.poisson_ratio)
    }

    /// Effective shear modulus G* = G/(2(2−ν)) of two grains of this material, Pa.
    pub fn effective_shear(&self) -> f64 {
        self.shear_modulus / (2.0 * (2.0 - self.poisson_ratio))
    }

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

    /// Normal contact stiffness k_n = 2 E* √(R* δ), N/m (Eq. 8 with full overlap δ; K_N = 2 k_n).
    pub fn normal_stiffness(&self, r_eff: f64, overlap: f64) -> f64 {
        2.0 * self.effective_young() * (r_eff * overlap).sqrt()
    }

    /// Tangential contact stiffness without slip k_t = 8 G* √(R* δ), N/m (Eq. 9 with full overlap δ; K_T = 2 k_t).
    pub fn tangential_stiffness(&self, r_eff: f64, overlap: f64) -> f64 {
        8.0 * self.effective_shear() * (r_eff * overlap).sqrt()
    }

    /// k_t/k_n = 2(1−ν)/(2−ν): 8/9 at ν = 0.2.
    pub fn stiffness_ratio(&self) -> f64 {
        2.0 * (1.0 - self.poisson_ratio) / (2.0 - self.poisson_ratio)
    }

    /// Mass of a sphere of radius `radius` (m), kg.
    pub fn sphere_mass(&self, radius: f64) -> f64 {
        self.density * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
    }
}

/// Effective radius R* = R_i R_j/(R_i + R_j), m.
pub fn effective_radius(radius_i: f64, radius_j: f64) -> f64 {
    radius_i * radius_j / (radius_i + radius_j)
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn normal_stiffness_is_the_derivative_of_the_normal_force() {
        let (m, r, d) = (Material::GLASS, 5.0e-5, 4.0e-8);
        let h = 1e-5 * d;
        let slope = (m.normal_force(r, d + h) - m.normal_force(r, d - h)) / (2.0 * h);
        assert!((slope / m.normal_stiffness(r, d) - 1.0).abs() < 1e-9);
    }
}
