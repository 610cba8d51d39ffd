//! Moduli of isotropic packings, Eqs. 21 and 22.

use super::CalibrationError;
use crate::structure::Quantity;

const MEGA: f64 = 1.0e6;

/// Isotropic packings: G = α(k̂ + β) p^⅓ and Θ = ρ(k̂ + ζ) p^⅓ with G, Θ, p in MPa (Eqs. 21 and 22). The methods take
/// and give Pa.
///
/// Built by [`Isotropic::new`], which is what makes the inversion unique: α, ρ > 0, β < ζ and β < 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Isotropic {
    pub(super) alpha: f64,
    pub(super) beta: f64,
    pub(super) rho: f64,
    pub(super) zeta: f64,
    /// Which coordination number k̂ is: [`Quantity::K`] or [`Quantity::Z`].
    pub abscissa: Quantity,
    /// Lowest and highest k̂ of the packings it was fitted to.
    pub fitted: [f64; 2],
    /// Covariance of (α, β, ρ, ζ), α and ρ in MPa^⅔; `None` if not known.
    pub covariance: Option<[[f64; 4]; 4]>,
    /// Relative scatter of G and Θ about the fit; `None` if not known.
    pub scatter: Option<[f64; 2]>,
}

impl Isotropic {
    /// The paper's: α = 170, β = −3.66, ρ = 75, ζ = −0.5, fitted for k̂ > 4.8.
    pub const PAPER: Isotropic = Isotropic {
        alpha: 170.0,
        beta: -3.66,
        rho: 75.0,
        zeta: -0.5,
        abscissa: Quantity::K,
        fitted: [4.8, f64::INFINITY],
        covariance: None,
        scatter: None,
    };

    /// `alpha` and `rho` in MPa^⅔, `beta` and `zeta` dimensionless, `fitted` the lowest and highest k̂ of the packings.
    pub fn new(
        [alpha, beta, rho, zeta]: [f64; 4],
        abscissa: Quantity,
        fitted: [f64; 2],
    ) -> Result<Self, CalibrationError> {
        let positive = |v: f64| v > 0.0 && v.is_finite();
        for (field, value, valid, requirement) in [
            ("alpha", alpha, positive(alpha), "it must be positive and finite"),
            ("rho", rho, positive(rho), "it must be positive and finite"),
            (
                "beta",
                beta,
                beta < 0.0 && beta.is_finite(),
                "shear must vanish at a positive coordination: beta < 0",
            ),
            (
                "zeta",
                zeta,
                zeta > beta && zeta.is_finite(),
                "shear must vanish before bulk does: zeta > beta",
            ),
            ("fitted", fitted[0], fitted[0].is_finite() && fitted[0] < fitted[1], "a range, low and high"),
        ] {
            if !valid {
                return Err(CalibrationError::Constant { field, value, requirement });
            }
        }
        Ok(Self { alpha, beta, rho, zeta, abscissa, fitted, covariance: None, scatter: None })
    }

    /// α, β, ρ, ζ; α and ρ in MPa^⅔.
    pub fn constants(&self) -> [f64; 4] {
        [self.alpha, self.beta, self.rho, self.zeta]
    }

    /// The same for grains whose contacts are `stiffer` times as stiff at the same pressure.
    #[must_use]
    pub(crate) fn scaled(&self, stiffer: f64) -> Self {
        Self { alpha: self.alpha * stiffer, rho: self.rho * stiffer, ..self.clone() }
    }

    /// Isotropic shear modulus, Pa, for coordination number `k_hat` at `pressure`, Pa (Eq. 21).
    ///
    /// ```
    /// // 170 (5.63 − 3.66) 0.05^⅓ MPa
    /// let g = grainlab_emt::Isotropic::PAPER.shear_modulus(5.63, 50.0e3);
    /// assert!((g / 1.0e6 - 123.378).abs() < 1e-3);
    /// ```
    pub fn shear_modulus(&self, k_hat: f64, pressure: f64) -> f64 {
        MEGA * self.alpha * (k_hat + self.beta) * (pressure / MEGA).cbrt()
    }

    /// Isotropic bulk modulus, Pa, for coordination number `k_hat` at `pressure`, Pa (Eq. 22).
    pub fn bulk_modulus(&self, k_hat: f64, pressure: f64) -> f64 {
        MEGA * self.rho * (k_hat + self.zeta) * (pressure / MEGA).cbrt()
    }

    /// s = (ρ/α)·G/Θ = (k̂ + β)/(k̂ + ζ) of an isotropic packing with shear over bulk modulus `ratio`; k̂ needs s < 1.
    pub(crate) fn reduced(&self, ratio: f64) -> f64 {
        self.rho / self.alpha * ratio
    }

    /// k̂ of [`Isotropic::reduced`] s in (0, 1).
    pub(crate) fn coordination(&self, s: f64) -> f64 {
        (self.zeta * s - self.beta) / (1.0 - s)
    }
}
