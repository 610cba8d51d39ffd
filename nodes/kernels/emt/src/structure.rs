//! Microstructure: the result of an inversion.

use nalgebra::SMatrix;
use std::fmt;

/// Number of [`Quantity`]s.
pub const QUANTITIES: usize = 5;

/// A covariance of the quantities, in the order of [`Quantity::ALL`]; rows and columns of undetermined
/// quantities are zero.
pub type StructureCovariance = SMatrix<f64, QUANTITIES, QUANTITIES>;

/// One number of the microstructure, dimensionless.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
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

impl Quantity {
    /// All of them, in the order of every array and matrix.
    pub const ALL: [Quantity; QUANTITIES] =
        [Quantity::K, Quantity::KHat, Quantity::Z, Quantity::Eps, Quantity::EpsStiffness];

    /// Its name in messages, tables and files.
    pub const fn name(self) -> &'static str {
        match self {
            Quantity::K => "k",
            Quantity::KHat => "k_hat",
            Quantity::Z => "z",
            Quantity::Eps => "eps",
            Quantity::EpsStiffness => "eps_stiffness",
        }
    }

    /// Whether its errors are given relative to it: true for coordination numbers, false for anisotropies.
    pub(crate) const fn is_coordination(self) -> bool {
        matches!(self, Quantity::K | Quantity::KHat | Quantity::Z)
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Microstructure: what a model infers, or predicts from. `None` is undetermined, or not part of the model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Structure {
    /// [`Quantity::K`].
    pub k: Option<f64>,
    /// [`Quantity::KHat`].
    pub k_hat: Option<f64>,
    /// [`Quantity::Z`].
    pub z: Option<f64>,
    /// [`Quantity::Eps`].
    pub eps: Option<f64>,
    /// [`Quantity::EpsStiffness`].
    pub eps_stiffness: Option<f64>,
}

impl Structure {
    /// The quantities of the paper's models.
    pub const fn paper(k: f64, k_hat: f64, eps: f64) -> Self {
        Self { k: Some(k), k_hat: Some(k_hat), z: None, eps: Some(eps), eps_stiffness: None }
    }

    /// In the order of [`Quantity::ALL`].
    pub const fn values(&self) -> [Option<f64>; QUANTITIES] {
        [self.k, self.k_hat, self.z, self.eps, self.eps_stiffness]
    }

    /// From the order of [`Quantity::ALL`].
    pub const fn of_values([k, k_hat, z, eps, eps_stiffness]: [Option<f64>; QUANTITIES]) -> Self {
        Self { k, k_hat, z, eps, eps_stiffness }
    }

    /// The same with this quantity.
    #[must_use]
    pub const fn with(self, quantity: Quantity, value: f64) -> Self {
        let mut values = self.values();
        values[quantity as usize] = Some(value);
        Self::of_values(values)
    }

    /// One quantity.
    pub const fn get(&self, quantity: Quantity) -> Option<f64> {
        self.values()[quantity as usize]
    }
}
