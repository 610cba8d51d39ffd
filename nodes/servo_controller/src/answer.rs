//! From one `Stress` to one `StrainRate`.

use grainlab_msgs::boundary::{BoundaryError, StrainRateAnswer, StressRequest};
use grainlab_msgs::msg;

/// Why a stress has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The message is not a request, or the answer would not be one.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
    /// No law answers the request.
    #[error("request {sequence} is not answered: {reason}")]
    Servo {
        /// Its sequence.
        sequence: u64,
        /// What the law objects to.
        reason: grainlab_servo::ServoError,
    },
}

/// The answer to one stress, with its header and sequence copied.
pub fn answer(stress: &msg::Stress) -> Result<msg::StrainRate, Refusal> {
    let request = StressRequest::try_from(stress)?;
    let answered = grainlab_servo::answer(&grainlab_servo::Request {
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
        rate: answered.rate,
        saturated: answered.saturated,
    })?;
    Ok(msg::StrainRate { header: stress.header.clone(), ..message })
}
