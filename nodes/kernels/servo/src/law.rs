//! The three laws, for one component.

use grainlab_core::ServoLaw;

/// The input of a law for one component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Component {
    /// σ − σ*, Pa; infinite where the difference overflows.
    pub(crate) error: f64,
    /// Present strain rate, 1/s.
    pub(crate) rate: f64,
    /// Change of stress per unit of this tensor strain component alone, Pa.
    pub(crate) diagonal_stiffness: f64,
    /// Change of stress with all servoed components of its kind strained together, Pa.
    pub(crate) closed_loop_stiffness: f64,
    /// Simulated time until the next input, s.
    pub(crate) interval: f64,
}

/// Change of stress per unit of the tensor strain component `index`, Pa: an off-diagonal strain counts twice.
pub(crate) fn stiffness(tangent: &[f64; 6], index: usize) -> f64 {
    if index < 3 { tangent[index] } else { 2.0 * tangent[index] }
}

/// Rate before the limit, 1/s; possibly infinite, but not NaN for finite arguments.
pub(crate) fn rate(law: &ServoLaw, c: &Component) -> f64 {
    // The difference of two finite stresses can overflow, and ∞/∞ is NaN.
    let error = c.error.clamp(-f64::MAX, f64::MAX);
    match *law {
        ServoLaw::Scaled { response_time } => over(error, c.diagonal_stiffness * response_time),
        ServoLaw::Normalised { share, leak } => {
            let change = over(error, c.closed_loop_stiffness * c.interval);
            (1.0 - leak) * c.rate + share * (4.0 - 2.0 * leak) * change
        }
        ServoLaw::Integral { gain, leak } => (1.0 - leak) * c.rate + gain * error,
    }
}

fn over(error: f64, viscosity: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / viscosity }
}
