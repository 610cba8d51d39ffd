//! Moduli of isotropic packings, Eqs. 21 and 22.

use std::borrow::Cow;

/// Isotropic packings: G = α(k̂ + β) p^⅓ and Θ = ρ(k̂ + ζ) p^⅓ with G, Θ, p in MPa (Eqs. 21 and 22). The methods take
/// and give Pa.
///
/// Built by [`Calibration::new`], which is what makes the inversion unique: α, ρ > 0 and β < ζ, β < 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    name: Cow<'static, str>,
    alpha: f64,
    beta: f64,
    rho: f64,
    zeta: f64,
    fitted_above: f64,
}

/// Why four numbers are not a calibration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("calibration `{name}`: {field} = {value} is invalid: {requirement}")]
pub struct CalibrationError {
    /// Name of the calibration.
    pub name: String,
    /// Which constant.
    pub field: &'static str,
    /// The value found.
    pub value: f64,
    /// What is required.
    pub requirement: &'static str,
}

const MEGA: f64 = 1.0e6;

impl Calibration {
    /// The paper's: α = 170, β = −3.66, ρ = 75, ζ = −0.5, fitted for k̂ > 4.8.
    pub const PAPER: Calibration = Calibration {
        name: Cow::Borrowed("paper"),
        alpha: 170.0,
        beta: -3.66,
        rho: 75.0,
        zeta: -0.5,
        fitted_above: 4.8,
    };

    /// A calibration by name: `alpha` and `rho` in MPa^⅔, `beta` and `zeta` dimensionless, `fitted_above` the lowest k̂
    /// of the packings it was fitted to.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        [alpha, beta, rho, zeta]: [f64; 4],
        fitted_above: f64,
    ) -> Result<Self, CalibrationError> {
        let name = name.into();
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
            ("fitted_above", fitted_above, fitted_above.is_finite(), "it must be finite"),
        ] {
            if !valid {
                return Err(CalibrationError { name: name.into_owned(), field, value, requirement });
            }
        }
        Ok(Self { name, alpha, beta, rho, zeta, fitted_above })
    }

    /// Its name, reported with every estimate.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// α, β, ρ, ζ; α and ρ in MPa^⅔.
    pub fn constants(&self) -> [f64; 4] {
        [self.alpha, self.beta, self.rho, self.zeta]
    }

    /// Lowest k̂ of the packings it was fitted to.
    pub fn fitted_above(&self) -> f64 {
        self.fitted_above
    }

    /// Isotropic shear modulus, Pa, for coordination number `k_hat` at `pressure`, Pa (Eq. 21).
    ///
    /// ```
    /// // 170 (5.63 − 3.66) 0.05^⅓ MPa
    /// let g = emt::Calibration::PAPER.shear_modulus(5.63, 50.0e3);
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

    /// k̂ of [`Calibration::reduced`] s in (0, 1), and dk̂/ds = (k̂ + ζ)²/(ζ − β).
    pub(crate) fn coordination(&self, s: f64) -> (f64, f64) {
        let k_hat = (self.zeta * s - self.beta) / (1.0 - s);
        (k_hat, (k_hat + self.zeta).powi(2) / (self.zeta - self.beta))
    }

    /// d ln[k̂/(k̂ + ζ)]/dk̂: what an error of k̂ does to k.
    pub(crate) fn bulk_sensitivity(&self, k_hat: f64) -> f64 {
        self.zeta / (k_hat * (k_hat + self.zeta))
    }
}
