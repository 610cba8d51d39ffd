//! From one `Packing` to one `PackingReport`.

use crate::Settings;
use grainlab_core::Packing;
use grainlab_core::results::PackingReport;
use grainlab_micromechanics::{MicroError, analyze};
use grainlab_msgs::boundary::{BoundaryError, packing_report_message};
use grainlab_msgs::{DecodeError, msg};

/// The measurement of one packing.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Result of the measurement.
    pub report: PackingReport,
    /// The message that is published.
    pub message: msg::PackingReport,
    /// Details of why the packing has no stiffness, which the message lacks.
    pub why_no_stiffness: Option<String>,
}

/// Why a packing is not measured.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The message cannot be decoded.
    #[error("a packing cannot be decoded: {0}")]
    Undecodable(#[from] DecodeError),
    /// The message is not a valid packing.
    #[error(transparent)]
    Refused(BoundaryError),
    /// The measurement failed.
    #[error("packing of step {step} is not analysed: {reason}")]
    Analysis {
        /// Step of the packing.
        step: u64,
        /// Error of the measurement.
        reason: MicroError,
    },
    /// The result is not a valid message.
    #[error("packing of step {step} is analysed, but the result cannot be published: {reason}")]
    Result {
        /// Step of the packing.
        step: u64,
        /// Error of the measurement.
        reason: BoundaryError,
    },
}

/// Measures one packing. Header and step are copied. The result depends only on the two arguments.
pub fn measure(message: &msg::Packing, settings: &Settings) -> Result<Measured, MeasureError> {
    let packing = Packing::try_from(message).map_err(MeasureError::Refused)?;
    let step = packing.step;
    let found = analyze(&packing, &settings.0).map_err(|reason| MeasureError::Analysis { step, reason })?;
    let why_no_stiffness = found.why_no_stiffness();
    let message = packing_report_message(message.header.clone(), &found.report)
        .map_err(|reason| MeasureError::Result { step, reason })?;
    Ok(Measured { report: found.report, message, why_no_stiffness })
}
