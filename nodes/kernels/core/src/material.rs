//! The grain's material.

use std::ops::RangeInclusive;

/// Shear moduli of grains, Pa, that are not implausible: the softest gels have about 1e3, and diamond has 5e11.
const SHEAR_MODULI: RangeInclusive<f64> = 1e3..=1e12;

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

    /// Returns what is implausible about the shear modulus, as after "the shear modulus is".
    pub fn shear_modulus_doubt(&self) -> Option<String> {
        let shear_modulus = self.shear_modulus;
        (!SHEAR_MODULI.contains(&shear_modulus)).then(|| {
            let than = if shear_modulus < *SHEAR_MODULI.start() {
                "softer than gels"
            } else {
                "stiffer than diamond"
            };
            format!("{shear_modulus} Pa, {than}: is its unit Pa?")
        })
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
