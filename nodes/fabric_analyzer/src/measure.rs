//! From one `Packing` to one `Fabric` and one `Moduli`.

use crate::Settings;
use grainlab_core::Packing;
use grainlab_core::results::{Elasticity, LeftOut, NotJammed, PackingReport};
use grainlab_micromechanics::{MicroError, analyze};
use grainlab_msgs::boundary::{BoundaryError, fabric_message, moduli_message};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{DecodeError, msg};

/// What is published about one packing.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Its structure.
    pub fabric: msg::Fabric,
    /// Its stiffness, or why it has none.
    pub moduli: Result<msg::Moduli, NotJammed>,
    /// What the stiffness leaves out of the contact law.
    pub left_out: Option<LeftOut>,
}

/// Why a packing is not measured.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The bytes are no message.
    #[error("a packing cannot be decoded: {0}")]
    Undecodable(#[from] DecodeError),
    /// The message is not a packing.
    #[error(transparent)]
    Refused(BoundaryError),
    /// The measurement failed.
    #[error("packing of step {step} is not analysed: {reason}")]
    Analysis {
        /// Its step.
        step: u64,
        /// What went wrong.
        reason: MicroError,
    },
    /// What was measured is nothing that a reader would accept.
    #[error("packing of step {step} is analysed, but the result cannot be published: {reason}")]
    Result {
        /// Its step.
        step: u64,
        /// What a reader would object to.
        reason: BoundaryError,
    },
}

/// Measures one packing. Header and step are copied; nothing but the two arguments enters.
pub fn measure(message: &msg::Packing, settings: &Settings) -> Result<Measured, MeasureError> {
    let packing = Packing::try_from(message).map_err(MeasureError::Refused)?;
    let step = packing.step;
    let found = analyze(&packing, &settings.0).map_err(|reason| MeasureError::Analysis { step, reason })?;
    let stiffness = found.report.stiffness();
    let left_out = stiffness.and_then(|stiffness| stiffness.method.leaves_out(&packing.law));
    Ok(Measured { left_out, ..messages(&message.header, &found.report)? })
}

/// The messages about a packing that has been measured; `header` is that of the packing's own message. What the stiffness
/// leaves out is for the caller to find.
pub fn messages(header: &Header, report: &PackingReport) -> Result<Measured, MeasureError> {
    let unfit = |reason| MeasureError::Result { step: report.step, reason };
    let fabric = fabric_message(header.clone(), report).map_err(unfit)?;
    let moduli = match &report.elasticity {
        Elasticity::NotJammed(why) => Err(*why),
        Elasticity::Jammed(stiffness) => {
            Ok(moduli_message(header.clone(), report, stiffness).map_err(unfit)?)
        }
    };
    Ok(Measured { fabric, moduli, left_out: None })
}
