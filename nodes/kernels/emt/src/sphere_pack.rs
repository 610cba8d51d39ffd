//! A random pack of equal spheres with contacts in all directions alike, under uniform strain: stiffness and stress.
//!
//! Walton, J. Mech. Phys. Solids 35, 213 (1987), for equal strain along all axes; Johnson, Schwartz, Elata, Berryman, Hornby
//! & Norris, J. Appl. Mech. 65, 380 (1998), for unequal strain along e3. Every contact has the overlap that the strain
//! gives it, D (Δ/3)(1 + 2g − 6gx²) with x the cosine to e3, its Hertz force, and the springs k_n and k_t of that
//! overlap. Grains do not spin against the mean rotation. All that depends on g follows from the integrals
//! Iₙ = ∫₀¹ xⁿ (1 + 2g − 6gx²)^½ dx. Derived here, and tested against integration over the sphere and along paths of strain.

use crate::error::EmtError;
use crate::overlap;
use grainlab_core::{Material, TransverseIsotropy};
use std::f64::consts::PI;

/// How the tangential forces came about, which the stress depends on and the stiffness does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactHistory {
    /// No slip: equal strain along all axes first, then strain along e3.
    HydrostaticFirst,
    /// No slip: all strains in proportion.
    Proportional,
    /// Contacts slipped without friction: no tangential forces.
    Slip,
}

/// The shape of a pack's strain: g = γ/Δ of the strain since the grains touched, and what follows from it alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackShape {
    g: f64,
    /// k_t/k_n of the contacts.
    stiffness_ratio: f64,
    integrals: overlap::Integrals,
}

impl PackShape {
    /// Of g in [−1/2, 1/4], from strain along e3 alone to strain across it alone; `stiffness_ratio` is k_t/k_n, 2(1−ν)/(2−ν) by
    /// Mindlin. An error outside, where contacts would be open.
    pub fn new(g: f64, stiffness_ratio: f64) -> Result<Self, EmtError> {
        Ok(Self { g, stiffness_ratio, integrals: overlap::nonlinear(g)? })
    }

    /// The moduli, dimensionless: in units of (3/π) φ k E* (Δ/3)^½.
    pub fn stiffness(&self) -> TransverseIsotropy {
        let [i0, i2, i4, _] = self.integrals;
        let tangential = self.stiffness_ratio;
        let normal = 1.0 - tangential;
        let flat = i0 - 2.0 * i2 + i4;
        TransverseIsotropy {
            c11: 0.375 * normal * flat + 0.5 * tangential * (i0 - i2),
            c12: 0.125 * normal * flat,
            c13: 0.5 * normal * (i2 - i4),
            c33: normal * i4 + tangential * i2,
            g13: 0.5 * normal * (i2 - i4) + 0.125 * tangential * (i0 + i2),
            g12: 0.125 * normal * flat + 0.25 * tangential * (i0 - i2),
            residual: 0.0,
        }
    }

    /// σ_11 and σ_33, dimensionless: in units of (2/π) φ k E* (Δ/3)^{3/2}.
    pub fn stress(&self, history: ContactHistory) -> [f64; 2] {
        let [i0, i2, i4, _] = self.integrals;
        let (a, b) = (1.0 + 2.0 * self.g, 6.0 * self.g);
        // Integrals of the cube of the root, times x² and times (1 − x²)/2.
        let along = a * i2 - b * i4;
        let across = 0.5 * (a * (i0 - i2) - b * (i2 - i4));
        let tangential = match history {
            ContactHistory::HydrostaticFirst => 2.0 * across - 2.0 / 3.0 * a.powf(1.5),
            ContactHistory::Proportional => -b * (i2 - i4),
            ContactHistory::Slip => 0.0,
        } * self.stiffness_ratio;
        [across - 0.5 * tangential, along + tangential]
    }

    /// Mean stress in the unit of [`PackShape::stress`], whatever the history.
    pub fn pressure(&self) -> f64 {
        let [i0, i2, ..] = self.integrals;
        ((1.0 + 2.0 * self.g) * i0 - 6.0 * self.g * i2) / 3.0
    }

    /// (σ_33 − σ_11)/p, dimensionless.
    pub fn stress_ratio(&self, history: ContactHistory) -> f64 {
        let [across, along] = self.stress(history);
        (along - across) / self.pressure()
    }

    /// ε weighted by contact stiffness, 5/2 (L33 − L11): more overlap along e3 makes the contacts there stiffer.
    pub fn eps_stiffness(&self) -> f64 {
        let [i0, i2, ..] = self.integrals;
        2.5 * (1.5 * i2 / i0 - 0.5)
    }

    /// Moduli in units of [`PackShape::stiffness`], Pa, of a pack of this coordination number and solid fraction φ at this
    /// pressure, Pa.
    pub fn unit(&self, k: f64, solid_fraction: f64, material: &Material, pressure: f64) -> f64 {
        let network = solid_fraction * k * material.effective_young();
        let root = (0.5 * PI * pressure / (network * self.pressure())).cbrt();
        3.0 / PI * network * root
    }

    /// The coordination number that has this unit of the moduli, Pa: the inverse of [`PackShape::unit`].
    pub fn coordination(&self, unit: f64, solid_fraction: f64, material: &Material, pressure: f64) -> f64 {
        let network = (PI / 3.0 * unit).powf(1.5) * (2.0 * self.pressure() / (PI * pressure)).sqrt();
        network / (solid_fraction * material.effective_young())
    }
}

/// k_t/k_n of two spheres that stick, 2(1−ν)/(2−ν) (Mindlin).
pub(crate) fn mindlin(material: &Material) -> f64 {
    4.0 * material.effective_shear() / material.effective_young()
}
