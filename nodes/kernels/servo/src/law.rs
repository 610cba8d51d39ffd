//! The two laws, for one component.

use grains::ServoLaw;

/// Stress gained per unit of the tensor strain component `index`, Pa: an off-diagonal strain enters twice.
pub(crate) fn stiffness(tangent: &[f64; 6], index: usize) -> f64 {
    if index < 3 { tangent[index] } else { 2.0 * tangent[index] }
}

/// Rate before the limit, 1/s; may be infinite, never NaN for finite arguments.
pub(crate) fn rate(law: &ServoLaw, error: f64, rate_in_force: f64, stiffness: f64) -> f64 {
    // The difference of two finite stresses can overflow, and ∞/∞ would be NaN.
    let error = error.clamp(-f64::MAX, f64::MAX);
    match *law {
        ServoLaw::Scaled { response_time } => scaled(error, stiffness * response_time),
        ServoLaw::Integral { gain, leak } => (1.0 - leak) * rate_in_force + gain * error,
    }
}

fn scaled(error: f64, viscosity: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / viscosity }
}
