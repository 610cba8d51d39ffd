//! A request, and the answers that it allows.

use grainlab_core::{ComponentControl, SymTensor};
use grainlab_msgs::builtin_interfaces::Time;
use grainlab_msgs::stamp;
use grainlab_servo::ServoRequest;

/// Relative rounding error that a servo in another language may add.
const ROUNDING: f64 = 1e-9;

/// The part of a request against which its answer is checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Question {
    pub(crate) sequence: u64,
    pub(crate) stamp: Time,
    /// Control of each component, Voigt order.
    pub(crate) controls: [ComponentControl; 6],
    /// Largest magnitude of a component of the answer, 1/s.
    pub(crate) rate_limit: f64,
}

impl Question {
    pub(crate) fn of(request: &ServoRequest) -> Self {
        Self {
            sequence: request.sequence,
            stamp: stamp(request.time),
            controls: request.input.controls,
            rate_limit: request.input.rate_limit,
        }
    }

    /// Checks that these rates, 1/s, are allowed: within the limit, zero where a component is held, and equal to an imposed
    /// rate. The servo chooses only the rates of components with a stress target.
    pub(crate) fn check(&self, rate: &[f64; 6]) -> Result<(), String> {
        let limit = self.rate_limit;
        for ((component, control), found) in SymTensor::COMPONENTS.into_iter().zip(&self.controls).zip(*rate)
        {
            if found.abs() > limit * (1.0 + ROUNDING) {
                return Err(format!(
                    "rate {component} = {found} 1/s is beyond the rate limit of the request, {limit} 1/s"
                ));
            }
            let imposed = match control {
                ComponentControl::Held => 0.0,
                ComponentControl::StrainRate(imposed) => imposed.clamp(-limit, limit),
                ComponentControl::Stress(_) => continue,
            };
            if (found - imposed).abs() > ROUNDING * imposed.abs() {
                return Err(format!(
                    "rate {component} = {found} 1/s, where the request imposes {imposed} 1/s"
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_component_with_a_stress_target_is_the_servos_to_choose() {
        let mut controls = [ComponentControl::Stress(1e3); 6];
        controls[1] = ComponentControl::Held;
        controls[2] = ComponentControl::StrainRate(-0.5);
        let question = Question { sequence: 3, stamp: Time::default(), controls, rate_limit: 2.0 };
        assert_eq!(question.check(&[2.0, 0.0, -0.5, -1.0, 0.0, 0.1]), Ok(()));
        for (rate, reason) in [
            (
                [0.0, 0.0, -0.5, -2.1, 0.0, 0.0],
                "rate yz = -2.1 1/s is beyond the rate limit of the request, 2 1/s",
            ),
            ([0.0, 1e-6, -0.5, 0.0, 0.0, 0.0], "rate yy = 0.000001 1/s, where the request imposes 0 1/s"),
            ([0.0, 0.0, 0.5, 0.0, 0.0, 0.0], "rate zz = 0.5 1/s, where the request imposes -0.5 1/s"),
        ] {
            assert_eq!(question.check(&rate), Err(reason.to_owned()));
        }
    }
}
