//! Input and output of the servo, and the answers that an input allows.

use crate::error::ServoError;
use grainlab_core::{ComponentControl, ServoLaw, SymTensor};

/// Relative rounding error that a servo in another language may add.
const RATE_ROUNDING: f64 = 1e-9;

/// The complete input of the servo, which has no state of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoInput {
    /// Stress now, Pa, positive in compression.
    pub stress: SymTensor,
    /// Control of each component.
    pub controls: [ComponentControl; 6],
    /// Present strain rate, 1/s, tensor components, positive in extension. The one that Eq. 1 integrates.
    pub rate: [f64; 6],
    /// Largest magnitude of a component of the output, 1/s. Positive.
    pub rate_limit: f64,
    /// Control law, from stress error to rate.
    pub law: ServoLaw,
    /// Tangent stiffness of the present contacts, Pa, not negative: C_iiii (xx, yy, zz) and C_ijij (yz, xz, xy). Zero
    /// without contacts, `None` if the engine does not measure it.
    pub tangent: Option<[f64; 6]>,
    /// Simulated time until the next input, s. Positive.
    pub control_interval: f64,
}

impl ServoInput {
    /// Checks that an answer with these rates, 1/s, is allowed: within the limit, zero where a component is held, and equal to an
    /// imposed rate. The servo chooses only the rates of components with a stress target.
    ///
    /// # Errors
    /// The first component that is not allowed.
    pub fn allows(&self, rate: &[f64; 6]) -> Result<(), ServoError> {
        let limit = self.rate_limit;
        for ((component, control), found) in SymTensor::COMPONENTS.into_iter().zip(self.controls).zip(*rate) {
            if found.abs() > limit * (1.0 + RATE_ROUNDING) {
                return Err(ServoError(format!(
                    "rate {component} = {found} 1/s is beyond the rate limit of the request, {limit} 1/s"
                )));
            }
            let imposed = match control {
                ComponentControl::Held => 0.0,
                ComponentControl::StrainRate(imposed) => imposed.clamp(-limit, limit),
                ComponentControl::Stress(_) => continue,
            };
            if (found - imposed).abs() > RATE_ROUNDING * imposed.abs() {
                return Err(ServoError(format!(
                    "rate {component} = {found} 1/s, where the request imposes {imposed} 1/s"
                )));
            }
        }
        Ok(())
    }
}

/// The strain rate for a [`ServoInput`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoOutput {
    /// Strain rate, 1/s, tensor components, positive in extension. Finite, at most `rate_limit` in magnitude.
    pub rate: [f64; 6],
    /// True if the component was limited to `rate_limit`.
    pub saturated: [bool; 6],
}
