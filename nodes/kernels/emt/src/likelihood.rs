//! The probability of observed moduli, as a model states it for a structure.
//!
//! Given the independent quantities of the structure, the moduli are normal, with errors of data and model. Other quantities
//! may follow: normal, too, given the structure and the moduli.

use crate::moduli::{MODULI, Modulus};
use crate::normal::LN_SQRT_TAU;
use grainlab_core::results::InferredQuantity;
use nalgebra::{Cholesky, Const, Matrix2, SMatrix, SVector, Vector2};

/// Unit of the moduli in every density, Pa: evidences of models are compared in the same unit.
pub(crate) const UNIT: f64 = 1e6;

pub(crate) const FOLLOWING: usize = 2;

/// A likelihood for one observation.
pub trait Likelihood: Sync {
    /// The independent quantities, in the order of [`Likelihood::at`].
    fn unknowns(&self) -> &[InferredQuantity];

    /// The quantities that follow.
    fn following(&self) -> &[InferredQuantity];

    /// The moduli that the likelihood is of.
    fn moduli(&self) -> &[Modulus];

    /// Observed values of these moduli, Pa.
    fn observed(&self) -> Vec<f64>;

    /// The distribution of the moduli for these independent quantities; `None` where the model has none.
    fn at(&self, unknowns: &[f64]) -> Option<Predicted>;
}

/// Normal distribution of the moduli for one structure, and of what follows. Rows of moduli that are not part of the likelihood
/// have residual 0, variance 1 and no covariance.
#[derive(Clone, Debug)]
pub struct Predicted {
    residual: SVector<f64, MODULI>,
    cholesky: Cholesky<f64, Const<MODULI>>,
    inverse: SMatrix<f64, MODULI, MODULI>,
    /// Number of moduli.
    pub(crate) count: usize,
    /// Means of what follows, given the observed moduli, and their covariance.
    pub following: (Vector2<f64>, Matrix2<f64>),
}

impl Predicted {
    /// From observed less predicted moduli in units of [`UNIT`] and their covariance; `None` if it is singular.
    pub(crate) fn new(
        residual: SVector<f64, MODULI>,
        covariance: SMatrix<f64, MODULI, MODULI>,
        count: usize,
    ) -> Option<Self> {
        let cholesky = Cholesky::new(covariance)?;
        let inverse = cholesky.inverse();
        let finite = residual.iter().chain(inverse.iter()).all(|v| v.is_finite());
        let following = (Vector2::zeros(), Matrix2::zeros());
        finite.then_some(Self { residual, cholesky, inverse, count, following })
    }

    /// The residual in units of its covariance: C⁻¹ r.
    pub(crate) fn weighted(&self) -> SVector<f64, MODULI> {
        self.inverse * self.residual
    }

    /// Inverse of the covariance.
    pub(crate) fn inverse(&self) -> &SMatrix<f64, MODULI, MODULI> {
        &self.inverse
    }

    /// χ² of the observed moduli.
    pub fn chi_square(&self) -> f64 {
        self.residual.dot(&self.weighted())
    }

    /// ln of the probability density of the observed moduli.
    pub fn ln(&self) -> f64 {
        let ln_root: f64 = self.cholesky.l().diagonal().map(f64::ln).sum();
        -0.5 * self.chi_square() - ln_root - self.count as f64 * LN_SQRT_TAU
    }

    /// ln of the density of one observed modulus given the others, and the distance from its prediction by them in standard
    /// deviations. For correlated errors these densities, not the marginal ones, are left out one by one (Bürkner, Gabry &
    /// Vehtari, Comput. Stat. 36, 1243, 2021).
    pub(crate) fn given_others(&self, modulus: Modulus) -> (f64, f64) {
        let i = modulus as usize;
        let precision = self.inverse[(i, i)];
        let sigma = self.weighted()[i] / precision.sqrt();
        (-0.5 * sigma * sigma + 0.5 * precision.ln() - LN_SQRT_TAU, sigma)
    }

    /// Observed less predicted value of one modulus in standard deviations, the other moduli not known.
    pub(crate) fn sigma(&self, modulus: Modulus) -> f64 {
        let i = modulus as usize;
        self.residual[i] / self.cholesky.l().row(i).norm()
    }

    /// Difference from the observed moduli of moduli drawn from this distribution by independent normal numbers, Pa.
    pub fn replicated(&self, normal: &SVector<f64, MODULI>) -> SVector<f64, MODULI> {
        (self.cholesky.l() * normal - self.residual) * UNIT
    }
}
