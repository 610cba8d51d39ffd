//! Checks of an input.

use crate::error::ServoError;
use crate::input::ServoInput;
use crate::stability::critical_gain;
use grainlab_core::{ComponentControl, ServoLaw, SymTensor};

pub(crate) fn check(input: &ServoInput) -> Result<(), ServoError> {
    finite("stress", &input.stress.voigt())?;
    finite("rate", &input.rate)?;
    finite("setpoint", &input.controls.map(setpoint))?;
    if let Some(tangent) = &input.tangent {
        finite("tangent", tangent)?;
        for (component, &value) in SymTensor::COMPONENTS.iter().zip(tangent) {
            if value < 0.0 {
                return Err(ServoError(format!(
                    "tangent[{component}] = {value:e} Pa is negative: send the affine stiffness of the contacts, or 0 for none"
                )));
            }
        }
    }
    positive("rate_limit", input.rate_limit, "1/s")?;
    positive("control_interval", input.control_interval, "s")?;
    check_stability(input)
}

/// Checks that the law of `input` is stable with its tangent stiffness and control interval: a part of the checks of
/// [`crate::control`], for callers that need the result earlier.
///
/// Without a stress target there is no control loop, and any law is accepted. Without a tangent stiffness only the integral
/// law is accepted, whose stability is then not known.
pub fn check_stability(input: &ServoInput) -> Result<(), ServoError> {
    let ServoInput { law, tangent, controls, control_interval, .. } = *input;
    if !controls.iter().any(|c| matches!(c, ComponentControl::Stress(_))) {
        return Ok(());
    }
    if tangent.is_none() && !matches!(law, ServoLaw::Integral { .. }) {
        let reason =
            "the engine does not measure the tangent stiffness: use law = \"integral\", which needs none";
        return Err(ServoError(reason.into()));
    }
    match law {
        ServoLaw::Scaled { response_time } => {
            positive("response_time", response_time, "s")?;
            if control_interval >= 2.0 * response_time {
                return Err(ServoError(format!(
                    "control_interval = {control_interval:e} s is not below twice response_time = {response_time:e} s, so the \
                     stiffness-scaled law would diverge: lengthen response_time or shorten control_period"
                )));
            }
        }
        ServoLaw::Normalised { share, leak } => {
            if !(share > 0.0 && share < 1.0) {
                return Err(ServoError(format!(
                    "share = {share} of the critical gain is outside (0, 1): from 1 on the stress error grows every control period"
                )));
            }
            check_leak(leak)?;
        }
        ServoLaw::Integral { gain, leak } => {
            positive("gain", gain, "1/(Pa s)")?;
            check_leak(leak)?;
            let critical = tangent.map(|t| critical_gain(&t, &controls, control_interval, leak));
            if let Some(critical) = critical.filter(|critical| gain >= *critical) {
                return Err(ServoError(format!(
                    "gain = {gain:e} 1/(Pa s) is not below {critical:e} 1/(Pa s), where Eq. 1 becomes unstable with the present \
                     contacts and a control interval of {control_interval:e} s: reduce the gain, shorten control_period, or use \
                     law = \"normalised\""
                )));
            }
        }
    }
    Ok(())
}

fn check_leak(value: f64) -> Result<(), ServoError> {
    let reason = || {
        format!("leak = {value} is outside [0, 1]; 0 is exactly Eq. 1, 1 resets the rate each control period")
    };
    (0.0..=1.0).contains(&value).then_some(()).ok_or_else(|| ServoError(reason()))
}

fn setpoint(control: ComponentControl) -> f64 {
    match control {
        ComponentControl::Held => 0.0,
        ComponentControl::Stress(value) | ComponentControl::StrainRate(value) => value,
    }
}

fn finite(field: &'static str, values: &[f64; 6]) -> Result<(), ServoError> {
    match SymTensor::COMPONENTS.iter().zip(values).find(|(_, v)| !v.is_finite()) {
        Some((component, value)) => Err(ServoError(format!(
            "{field}[{component}] = {value} is not finite; the simulation that sent it is unstable"
        ))),
        None => Ok(()),
    }
}

fn positive(field: &'static str, value: f64, unit: &'static str) -> Result<(), ServoError> {
    let reason = || format!("{field} = {value:e} {unit} must be positive and finite");
    (value > 0.0 && value.is_finite()).then_some(()).ok_or_else(|| ServoError(reason()))
}
