//! The density of the mass that moves with a wave.

use grainlab_core::{Mat3, Stiffness, Vec3};

/// Density of the mass that moves with a wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectiveDensity {
    /// The tensor ρ, kg/m³: the effective density of the polarization p is pᵀ ρ p.
    pub density: Mat3,
}

impl EffectiveDensity {
    /// Mean over directions, kg/m³.
    pub fn mean(&self) -> f64 {
        self.density.trace() / 3.0
    }

    /// Standard deviation over directions, kg/m³.
    pub fn spread(&self) -> f64 {
        (self.density - Mat3::identity() * self.mean()).norm() / 3f64.sqrt()
    }

    /// Speed of long waves of a polarization in a medium of this density, m/s: v² = pᵀ ρ^-½ Γ ρ^-½ p, which is the mean of
    /// the squares of its modes' speeds weighted by their share in p. `direction` and `polarization` are unit vectors;
    /// NaN if the density is not positive definite.
    pub fn speed(&self, stiffness: &Stiffness, direction: &Vec3, polarization: &Vec3) -> f64 {
        let modes = self.density.symmetric_eigen();
        let inverse = Mat3::from_diagonal(&modes.eigenvalues.map(|rho| rho.powf(-0.5)));
        let moved = modes.eigenvectors * inverse * modes.eigenvectors.transpose() * polarization;
        moved.dot(&(stiffness.christoffel(direction) * moved)).sqrt()
    }
}
