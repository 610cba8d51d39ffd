//! From one `Packing` to one `Fabric` and one `Moduli`.

use crate::Settings;
use grainlab_core::Packing;
use grainlab_micromechanics::{Analysis, MicroError, NoNetwork};
use grainlab_msgs::boundary::{BoundaryError, fabric_message, moduli_message};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{DecodeError, msg};

/// What is published about one packing.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Its structure.
    pub fabric: msg::Fabric,
    /// Its stiffness, or why it has none.
    pub moduli: Result<msg::Moduli, NoNetwork>,
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
    let found = grainlab_micromechanics::analyse(&packing, &settings.0)
        .map_err(|reason| MeasureError::Analysis { step, reason })?;
    messages(&message.header, &packing, found)
}

/// The messages about a packing that has been measured; `header` is that of the packing's own message.
pub fn messages(header: &Header, packing: &Packing, found: Analysis) -> Result<Measured, MeasureError> {
    let step = packing.step;
    let unfit = |reason| MeasureError::Result { step, reason };
    let fabric = fabric_message(header.clone(), step, &found.fabric).map_err(unfit)?;
    let moduli = match found.moduli {
        Err(none) => Err(none),
        Ok(moduli) => {
            let message = moduli_message(
                header.clone(),
                step,
                &found.fabric,
                &moduli,
                found.pressure,
                found.solid_fraction,
                &packing.material,
            )
            .map_err(unfit)?;
            Ok(message)
        }
    };
    Ok(Measured { fabric, moduli })
}
