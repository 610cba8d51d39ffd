//! What makes a request unanswerable.

use crate::{Request, critical_gain};
use grainlab_core::{ComponentControl, ServoLaw};

/// Why a request has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ServoError {
    /// A component of a six-component quantity is not finite.
    #[error("{field}[{component}] = {value} is not finite; the simulation that sent it has gone wrong")]
    ComponentNotFinite {
        /// Which quantity.
        field: &'static str,
        /// Which component: xx, yy, zz, yz, xz or xy.
        component: &'static str,
        /// The value found.
        value: f64,
    },
    /// A number that must be positive and finite is not.
    #[error("{field} = {value:e} {unit} must be positive and finite")]
    NotPositive {
        /// Which quantity.
        field: &'static str,
        /// The value found.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// The leak of the integral law is not a share.
    #[error(
        "leak = {value} is outside [0, 1]; 0 is Eq. 1 to the letter, 1 forgets the rate each control period"
    )]
    Leak {
        /// The value found.
        value: f64,
    },
    /// The share of the critical gain is not between 0 and 1.
    #[error(
        "share = {value} of the critical gain is outside (0, 1): from 1 on the stress error grows every control period"
    )]
    Share {
        /// The value found.
        value: f64,
    },
    /// The gain of Eq. 1 is not below the critical one.
    #[error(
        "gain = {gain:e} 1/(Pa s) is not below {critical:e} 1/(Pa s), where Eq. 1 goes unstable with the present contacts \
         and a control interval of {control_interval:e} s: lower gain, shorten control_period, or use law = \"normalised\""
    )]
    Gain {
        /// Gain of Eq. 1, 1/(Pa s).
        gain: f64,
        /// The critical gain, 1/(Pa s).
        critical: f64,
        /// Simulated time between requests, s.
        control_interval: f64,
    },
    /// A tangent stiffness is negative.
    #[error(
        "tangent[{component}] = {value:e} Pa is negative: send the affine stiffness of the contacts, or 0 for none"
    )]
    NegativeTangent {
        /// Which component.
        component: &'static str,
        /// The value found, Pa.
        value: f64,
    },
    /// The stiffness-scaled law would overshoot by more than the error it corrects.
    #[error(
        "control_interval = {control_interval:e} s is not below twice response_time = {response_time:e} s, so the \
         stiffness-scaled law would diverge: lengthen response_time or shorten control_period"
    )]
    Unstable {
        /// Simulated time between requests, s.
        control_interval: f64,
        /// Response time of the law, s.
        response_time: f64,
    },
}

const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "yz", "xz", "xy"];

/// The first fault of a request.
pub(crate) fn check(request: &Request) -> Result<(), ServoError> {
    finite("stress", &request.stress.voigt())?;
    finite("rate", &request.rate)?;
    finite("tangent", &request.tangent)?;
    finite("setpoint", &request.controls.map(setpoint))?;
    for (component, &value) in COMPONENTS.iter().zip(&request.tangent) {
        if value < 0.0 {
            return Err(ServoError::NegativeTangent { component, value });
        }
    }
    positive("rate_limit", request.rate_limit, "1/s")?;
    positive("control_interval", request.control_interval, "s")?;
    check_stability(&request.law, &request.tangent, &request.controls, request.control_interval)
}

/// Whether `law` is stable with `tangent` (C_iiii and C_ijij, Pa) and `control_interval` (s): what [`crate::answer`]
/// checks, for those who ask the servo and want to know before.
///
/// A path without a stress target has no loop to close, and its law may be left at any value.
pub fn check_stability(
    law: &ServoLaw,
    tangent: &[f64; 6],
    controls: &[ComponentControl; 6],
    control_interval: f64,
) -> Result<(), ServoError> {
    if !controls.iter().any(|c| matches!(c, ComponentControl::Stress(_))) {
        return Ok(());
    }
    match *law {
        ServoLaw::Scaled { response_time } => {
            positive("response_time", response_time, "s")?;
            if control_interval >= 2.0 * response_time {
                return Err(ServoError::Unstable { control_interval, response_time });
            }
        }
        ServoLaw::Normalised { share, leak } => {
            if !(share > 0.0 && share < 1.0) {
                return Err(ServoError::Share { value: share });
            }
            check_leak(leak)?;
        }
        ServoLaw::Integral { gain, leak } => {
            positive("gain", gain, "1/(Pa s)")?;
            check_leak(leak)?;
            let critical = critical_gain(tangent, controls, control_interval, leak);
            if gain >= critical {
                return Err(ServoError::Gain { gain, critical, control_interval });
            }
        }
    }
    Ok(())
}

fn check_leak(value: f64) -> Result<(), ServoError> {
    if (0.0..=1.0).contains(&value) { Ok(()) } else { Err(ServoError::Leak { value }) }
}

fn setpoint(control: ComponentControl) -> f64 {
    match control {
        ComponentControl::Held => 0.0,
        ComponentControl::Stress(value) | ComponentControl::StrainRate(value) => value,
    }
}

fn finite(field: &'static str, values: &[f64; 6]) -> Result<(), ServoError> {
    match COMPONENTS.iter().zip(values).find(|(_, v)| !v.is_finite()) {
        Some((component, &value)) => Err(ServoError::ComponentNotFinite { field, component, value }),
        None => Ok(()),
    }
}

fn positive(field: &'static str, value: f64, unit: &'static str) -> Result<(), ServoError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(ServoError::NotPositive { field, value, unit })
    }
}
