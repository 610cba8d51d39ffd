//! Microstructure: the result of an inversion.

use nalgebra::SMatrix;
use std::fmt;

/// A covariance of the quantities, in the order of [`InferredQuantity::ALL`]; rows and columns of undetermined
/// quantities are zero.
pub type MicrostructureCovariance = SMatrix<f64, { InferredQuantity::COUNT }, { InferredQuantity::COUNT }>;

/// One number of the microstructure, dimensionless.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum InferredQuantity {
    /// Coordination number k: twice the contacts over all grains.
    K,
    /// Coordination number k̂ of the equivalent isotropic packing, in the sense of the calibration.
    KHat,
    /// Coordination number z of the grains without rattlers.
    Z,
    /// Anisotropy ε of the number of contacts about the axis, Eq. 6.
    Eps,
    /// The same with every contact weighted by its normal stiffness.
    EpsStiffness,
}

impl InferredQuantity {
    /// Number of quantities.
    pub const COUNT: usize = 5;

    /// All of them, in the order of every array and matrix.
    pub const ALL: [InferredQuantity; InferredQuantity::COUNT] = [
        InferredQuantity::K,
        InferredQuantity::KHat,
        InferredQuantity::Z,
        InferredQuantity::Eps,
        InferredQuantity::EpsStiffness,
    ];

    /// Its name in messages, tables and files.
    pub const fn name(self) -> &'static str {
        match self {
            InferredQuantity::K => "k",
            InferredQuantity::KHat => "k_hat",
            InferredQuantity::Z => "z",
            InferredQuantity::Eps => "eps",
            InferredQuantity::EpsStiffness => "eps_stiffness",
        }
    }

    /// Whether its errors are given relative to it: true for coordination numbers, false for anisotropies.
    pub const fn is_coordination(self) -> bool {
        matches!(self, InferredQuantity::K | InferredQuantity::KHat | InferredQuantity::Z)
    }
}

impl fmt::Display for InferredQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Microstructure: what a model infers, or predicts from. `None` is undetermined, or not part of the model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Microstructure {
    /// [`InferredQuantity::K`].
    pub k: Option<f64>,
    /// [`InferredQuantity::KHat`].
    pub k_hat: Option<f64>,
    /// [`InferredQuantity::Z`].
    pub z: Option<f64>,
    /// [`InferredQuantity::Eps`].
    pub eps: Option<f64>,
    /// [`InferredQuantity::EpsStiffness`].
    pub eps_stiffness: Option<f64>,
}

impl Microstructure {
    /// The quantities of the paper's models.
    pub const fn paper(k: f64, k_hat: f64, eps: f64) -> Self {
        Self { k: Some(k), k_hat: Some(k_hat), z: None, eps: Some(eps), eps_stiffness: None }
    }

    /// In the order of [`InferredQuantity::ALL`].
    pub const fn values(&self) -> [Option<f64>; InferredQuantity::COUNT] {
        [self.k, self.k_hat, self.z, self.eps, self.eps_stiffness]
    }

    /// From the order of [`InferredQuantity::ALL`].
    pub const fn of_values(
        [k, k_hat, z, eps, eps_stiffness]: [Option<f64>; InferredQuantity::COUNT],
    ) -> Self {
        Self { k, k_hat, z, eps, eps_stiffness }
    }

    /// The same with this quantity.
    #[must_use]
    pub const fn with(self, quantity: InferredQuantity, value: f64) -> Self {
        let mut values = self.values();
        values[quantity as usize] = Some(value);
        Self::of_values(values)
    }

    /// One quantity.
    pub const fn get(&self, quantity: InferredQuantity) -> Option<f64> {
        self.values()[quantity as usize]
    }
}
