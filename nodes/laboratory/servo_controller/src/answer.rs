//! From one `Stress` to one `StrainRate`.

use grainlab_msgs::boundary::{BoundaryError, StrainRateAnswer, StressRequest};
use grainlab_msgs::msg;

/// Why there is no answer to a stress.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The message is not a valid request, or its answer would not be valid.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
    /// The control law refuses the request.
    #[error("request {sequence} is not answered: {reason}")]
    Servo {
        /// Sequence number of the request.
        sequence: u64,
        /// The reason.
        reason: grainlab_servo::ServoError,
    },
}

/// The answer to one stress, with the same header and sequence number.
pub fn answer(stress: &msg::Stress) -> Result<msg::StrainRate, Refusal> {
    let request = StressRequest::try_from(stress)?;
    let output = grainlab_servo::control(&grainlab_servo::ServoInput {
        stress: request.stress,
        controls: request.controls,
        rate: request.rate,
        rate_limit: request.rate_limit,
        law: request.law,
        tangent: request.tangent,
        control_interval: request.control_interval,
    })
    .map_err(|reason| Refusal::Servo { sequence: request.sequence, reason })?;
    let message = msg::StrainRate::try_from(&StrainRateAnswer {
        stamp: request.stamp,
        sequence: request.sequence,
        rate: output.rate,
        saturated: output.saturated,
    })?;
    Ok(msg::StrainRate { header: stress.header.clone(), ..message })
}
