//! The error of a model.

use super::error::{CalibrationError, constant};
use crate::conditions::StrainRatioSource;
use serde::{Deserialize, Serialize};

/// The difference of a model from the packings of the calibration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelDiscrepancy {
    /// Name of the model.
    pub model: String,
    /// The γ/Δ that the model takes; `None` if it uses none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gamma: Option<StrainRatioSource>,
    /// Means of the products of the errors (bias included) of the coordination number, k̂ and ε; zero for k̂
    /// where the model does not use it.
    pub mean_square: [[f64; 3]; 3],
    /// Means of the errors: the part of them that does not depend on the size of the sample.
    pub bias: [f64; 3],
    /// f0 and f1: where ε is inferred, the mean square of its error is multiplied by f0 + f1 ε², which is 1 in the
    /// mean.
    pub by_eps: [f64; 2],
}

impl ModelDiscrepancy {
    /// Means of the products of the errors where this ε is inferred, of samples whose scatter has this variance over that of the
    /// packings.
    pub(super) fn at(&self, eps: Option<f64>, scatter: f64) -> [[f64; 3]; 3] {
        let [constant, square] = self.by_eps;
        let of_eps = eps.map_or(1.0, |eps| (constant + square * eps * eps).sqrt());
        let scale = [1.0, 1.0, of_eps];
        let grown = |i: usize, j: usize| {
            self.mean_square[i][j] * scatter - self.bias[i] * self.bias[j] * (scatter - 1.0)
        };
        std::array::from_fn(|i| std::array::from_fn(|j| scale[i] * scale[j] * grown(i, j)))
    }

    pub(super) fn check(&self) -> Result<(), CalibrationError> {
        let m = nalgebra::Matrix3::from_fn(|i, j| self.mean_square[i][j]);
        let lowest = if m.iter().all(|v| v.is_finite()) { m.symmetric_eigenvalues().min() } else { f64::NAN };
        let valid = m == m.transpose() && lowest >= -1e-9 * m.amax();
        constant(
            "discrepancy.mean_square",
            lowest,
            valid,
            "it must be symmetric without negative eigenvalues",
        )?;
        let [f0, f1] = self.by_eps;
        constant("discrepancy.by_eps", f0.min(f1), f0 >= 0.0 && f1 >= 0.0, "it must not be negative")
    }
}
