//! From one `Stress` to one `StrainRate`.

use grainlab_msgs::boundary::BoundaryError;
use grainlab_msgs::msg;
use grainlab_servo::ServoRequest;

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
        /// Error of the control law.
        reason: grainlab_servo::ServoError,
    },
}

/// The answer to one stress, with the same header and sequence number.
pub fn answer(stress: &msg::Stress) -> Result<msg::StrainRate, Refusal> {
    let request = ServoRequest::try_from(stress)?;
    let output = grainlab_servo::control(&request.input)
        .map_err(|reason| Refusal::Servo { sequence: request.sequence, reason })?;
    let message = msg::StrainRate {
        header: stress.header.clone(),
        sequence: request.sequence,
        rate: output.rate,
        saturated: output.saturated,
    };
    message.checked()?;
    Ok(message)
}
