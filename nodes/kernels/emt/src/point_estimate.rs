//! Point estimates of a model, before errors are propagated.

use crate::observation::INPUTS;
use grainlab_core::notes::Note;
use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};
use nalgebra::SMatrix;

/// Change of each quantity per relative change of each input (for γ/Δ: per absolute change). Rows in the order of
/// [`InferredQuantity::ALL`], columns in the order of [`grainlab_core::results::INFERENCE_INPUTS`].
pub type Jacobian = SMatrix<f64, { InferredQuantity::COUNT }, INPUTS>;

/// A point estimate, with the data on its error that depend on the model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointEstimate {
    /// Structure that was inferred.
    pub structure: Microstructure,
    /// Derivatives of the structure with respect to the inputs; `None`: by central differences of [`crate::Model::solve`].
    pub jacobian: Option<Jacobian>,
    /// Covariance of the model's own error where the model computes it; `None`: as the calibration has it for the
    /// model.
    pub discrepancy: Option<MicrostructureCovariance>,
    /// Central intervals of a posterior that is not normal, in the order of [`InferredQuantity::ALL`].
    pub bounds: Option<[Option<[f64; 2]>; InferredQuantity::COUNT]>,
    /// Misfit, where there are more data than unknowns.
    pub misfit: Option<Misfit>,
    /// Notes of this model; those common to all models are added later.
    pub notes: Vec<Note>,
}

impl PointEstimate {
    /// A structure that fits exactly, without notes.
    pub fn exact(structure: Microstructure) -> Self {
        Self { structure, ..Self::default() }
    }
}

/// Distance of the data from every structure, where there are more data than unknowns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// Sum of squares weighted by the errors of data and model.
    pub chi_square: f64,
    /// Number of data minus number of unknowns.
    pub degrees_of_freedom: usize,
}
