//! The error of the models in which the pack is strained uniformly: what all of them leave out, the relaxation of the network.
//!
//! Root mean squares over the 1,068 states of the calibration `grainlab`, bias included; they take no constants from it.

use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};

/// Error of k over the k inferred.
const K: f64 = 0.21;

/// Error of ε weighted by contact stiffness.
const EPS_STIFFNESS: f64 = 0.05;

/// Covariance of the model's own error where it infers this structure.
pub(super) fn own_error(structure: &Microstructure) -> MicrostructureCovariance {
    let mut covariance = MicrostructureCovariance::zeros();
    let mut of = |quantity: InferredQuantity, error: Option<f64>| {
        let i = quantity as usize;
        covariance[(i, i)] = error.unwrap_or(0.0).powi(2);
    };
    of(InferredQuantity::K, structure.k.map(|k| K * k));
    of(InferredQuantity::EpsStiffness, structure.eps_stiffness.map(|_| EPS_STIFFNESS));
    covariance
}
