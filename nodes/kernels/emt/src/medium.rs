//! The effective medium: absolute moduli, Eqs. 12–15.
//!
//! They over-predict the shear moduli of real packings several times; the ratio models use their ratios alone.

use crate::eq16::Eq16Reading;
use crate::moments::Moments;
use grainlab_core::{Material, Stiffness, TransverseIsotropy};
use std::f64::consts::PI;

/// A random aggregate of equal spheres, axis e3, strained by Δ and γ since the grains touched (plain effective medium
/// theory with the mean spin, Eqs. 3–15; K_N taken as K_T in the increment, Eq. 11).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Material of the grains.
    pub material: Material,
    /// Solid fraction φ; n D³ = 6φ/π.
    pub solid_fraction: f64,
    /// Volume strain Δ since the grains touched, positive in compression. Positive.
    pub volume_strain: f64,
    /// Coordination number k.
    pub k: f64,
    /// Contact anisotropy ε, in [−1/2, 1].
    pub eps: f64,
    /// g = γ/Δ, in (−1, 1/2).
    pub gamma_over_delta: f64,
}

/// The elastic moduli of Eq. 12, Pa; ψ2 = ψ4 = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MediumModuli {
    /// ψ1, of h_i h_j h_k h_l (Eq. 13), Pa.
    pub psi1: f64,
    /// ψ3, of δ_ik δ_jl + δ_il δ_jk (Eq. 14), Pa: G12.
    pub psi3: f64,
    /// ψ5, of δ_ik h_j h_l and its permutations (Eq. 15), Pa: G13 − G12.
    pub psi5: f64,
}

impl Medium {
    /// C0 = n D³ G/(4−2ν) √(Δ/3), Pa: the scale of Eqs. 13–15, for one contact per grain.
    pub fn scale(&self) -> f64 {
        let m = &self.material;
        6.0 * self.solid_fraction / PI * m.shear_modulus / (4.0 - 2.0 * m.poisson_ratio)
            * (self.volume_strain / 3.0).sqrt()
    }

    /// Medium at the Δ that gives `pressure`, Pa, by [`Medium::pressure`]; the present Δ is ignored.
    #[must_use]
    pub fn at_pressure(self, pressure: f64) -> Self {
        let unit = Self { volume_strain: 1.0, ..self }.pressure();
        Self { volume_strain: (pressure / unit).cbrt().powi(2), ..self }
    }

    /// Mean of the normal stresses, Pa, from Eq. 4: p = (2/3π) φ k E* (Δ/3)^{3/2} J.
    ///
    /// Every contact carries the Hertz force for the overlap whose root is Eq. 10, (4/3) E* √R* (√δ)³ ∝ (1 +
    /// g − 3gx²)³, which is consistent with its stiffness. J is the mean of that cube over the contacts of
    /// Eq. 6. To first order in g it is 1 − 12εg/5 in any reading of Eq. 10.
    pub fn pressure(&self) -> f64 {
        let (eps, g) = (self.eps, self.gamma_over_delta);
        let mean_cube = 1.0 + g * g * (12.0 / 5.0 - 16.0 / 35.0 * g)
            - eps * g * (12.0 / 5.0 - 48.0 / 35.0 * g + 48.0 / 35.0 * g * g);
        let root = (self.volume_strain / 3.0).sqrt();
        2.0 / (3.0 * PI)
            * self.solid_fraction
            * self.k
            * self.material.effective_young()
            * root.powi(3)
            * mean_cube
    }

    /// ψ1, ψ3 and ψ5, Eqs. 13–15.
    pub fn moduli(&self, reading: Eq16Reading) -> MediumModuli {
        let m = Moments::new(self.eps, self.gamma_over_delta);
        let unit = self.scale() * self.k;
        MediumModuli {
            psi1: unit * reading.psi1_factor(self.eps, self.gamma_over_delta),
            psi3: unit * m.m1,
            psi5: unit * m.m1 * m.spin(),
        }
    }
}

impl MediumModuli {
    /// The 6×6 stiffness of Eq. 12, axis e3, Pa.
    pub fn stiffness(&self) -> Stiffness {
        TransverseIsotropy {
            c11: 2.0 * self.psi3,
            c12: 0.0,
            c13: 0.0,
            c33: self.psi1 + 2.0 * self.psi3 + 4.0 * self.psi5,
            g12: self.psi3,
            g13: self.psi3 + self.psi5,
            residual: 0.0,
        }
        .stiffness()
    }

    /// Voigt bulk modulus Θ = C_iijj/9, Pa.
    pub fn bulk(&self) -> f64 {
        (6.0 * self.psi3 + self.psi1 + 4.0 * self.psi5) / 9.0
    }
}
