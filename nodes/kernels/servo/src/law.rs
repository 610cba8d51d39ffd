//! The two laws, for one component.

use grainlab_core::ServoLaw;

/// What one component's law works on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Component {
    /// σ − σ*, Pa; infinite where the difference overflows.
    pub(crate) error: f64,
    /// Strain rate in force, 1/s.
    pub(crate) rate: f64,
    /// Stress gained per unit of this tensor strain component alone, Pa.
    pub(crate) own_stiffness: f64,
    /// The same when every servoed component of its kind strains along, Pa.
    pub(crate) loop_stiffness: f64,
    /// Simulated time until the next request, s.
    pub(crate) interval: f64,
}

/// Stress gained per unit of the tensor strain component `index`, Pa: an off-diagonal strain enters twice.
pub(crate) fn stiffness(tangent: &[f64; 6], index: usize) -> f64 {
    if index < 3 { tangent[index] } else { 2.0 * tangent[index] }
}

/// Rate before the limit, 1/s; may be infinite, never NaN for finite arguments.
pub(crate) fn rate(law: &ServoLaw, c: &Component) -> f64 {
    // The difference of two finite stresses can overflow, and ∞/∞ would be NaN.
    let error = c.error.clamp(-f64::MAX, f64::MAX);
    match *law {
        ServoLaw::Scaled { response_time } => over(error, c.own_stiffness * response_time),
        ServoLaw::Normalised { share, leak } => {
            let kick = over(error, c.loop_stiffness * c.interval);
            (1.0 - leak) * c.rate + share * (4.0 - 2.0 * leak) * kick
        }
        ServoLaw::Integral { gain, leak } => (1.0 - leak) * c.rate + gain * error,
    }
}

fn over(error: f64, viscosity: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / viscosity }
}
