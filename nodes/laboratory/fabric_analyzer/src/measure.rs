//! From one `Packing` to one `Fabric` and one `Moduli`.

use crate::Settings;
use grainlab_core::Packing;
use grainlab_core::results::{Elasticity, NotJammed, PackingReport, SpringNote};
use grainlab_experiment::PathPosition;
use grainlab_micromechanics::{MicroError, analyze};
use grainlab_msgs::boundary::{BoundaryError, fabric_message, moduli_message};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{DecodeError, msg};

/// The messages published for one packing.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Its structure.
    pub fabric: msg::Fabric,
    /// Its stiffness, or the reason why it has none.
    pub moduli: Result<msg::Moduli, NotJammed>,
    /// What a reader should know about its springs.
    pub notes: Vec<SpringNote>,
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
        /// The reason.
        reason: MicroError,
    },
    /// The result is not a valid message.
    #[error("packing of step {step} is analysed, but the result cannot be published: {reason}")]
    Result {
        /// Step of the packing.
        step: u64,
        /// The reason.
        reason: BoundaryError,
    },
}

/// Measures one packing. Header and step are copied. The result depends only on the two arguments.
pub fn measure(message: &msg::Packing, settings: &Settings) -> Result<Measured, MeasureError> {
    let packing = Packing::try_from(message).map_err(MeasureError::Refused)?;
    let step = packing.step;
    let mut found =
        analyze(&packing, &settings.0).map_err(|reason| MeasureError::Analysis { step, reason })?;
    PathPosition::of(&message.run_state).inspect(|position| position.judge_strain(&mut found.report));
    let notes = found.report.stiffness().map(|s| SpringNote::of(&packing, s.method, s.smooth));
    Ok(Measured { notes: notes.unwrap_or_default(), ..messages(&message.header, &found.report)? })
}

/// The messages for a measured packing; `header` is that of the message of the packing. The caller
/// finds the notes.
pub fn messages(header: &Header, report: &PackingReport) -> Result<Measured, MeasureError> {
    let unfit = |reason| MeasureError::Result { step: report.step, reason };
    let fabric = fabric_message(header.clone(), report).map_err(unfit)?;
    let moduli = match &report.elasticity {
        Elasticity::NotJammed(why) => Err(*why),
        Elasticity::Jammed(stiffness) => {
            Ok(moduli_message(header.clone(), report, stiffness).map_err(unfit)?)
        }
    };
    Ok(Measured { fabric, moduli, notes: Vec::new() })
}
