//! Constants of the models, learned from packings; their name is part of every result.

mod builtin;
mod constants;
mod discrepancy;
mod error;
mod file;
mod isotropic;
mod names;
mod relaxation;

pub use constants::Calibration;
pub use discrepancy::ModelDiscrepancy;
pub use error::CalibrationError;
pub use isotropic::IsotropicCalibration;
pub use relaxation::{AmplitudeLaw, RelaxationCalibration, ScalingLaw};
pub(crate) use relaxation::{ISOSTATIC, SCATTERED};
