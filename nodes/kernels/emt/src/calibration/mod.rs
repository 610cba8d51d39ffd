//! Constants of the models, learned from packings; their name is part of every result.

mod builtin;
mod constants;
mod discrepancy;
mod error;
mod file;
mod isotropic;
mod laws;
mod reach;
mod relaxation;

pub use constants::Calibration;
pub use discrepancy::ModelDiscrepancy;
pub use error::CalibrationError;
pub use isotropic::IsotropicCalibration;
pub(crate) use laws::REFERENCE_STIFFNESS_RATIO;
pub use laws::{DeviatorLaw, ISOSTATIC, NetworkState, RattlerLaw, ScalingLaw};
pub(crate) use reach::Outside;
pub use reach::Reach;
pub use relaxation::RESPONSE_STDDEV;
pub(crate) use relaxation::inverse_grains;
pub use relaxation::{GROUPS, RelaxationCalibration, SCATTERED, Scatter, ScatterLevels};
