//! Input and output of the servo.

use grainlab_core::{ComponentControl, ServoLaw, SymTensor};

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

/// The strain rate for a [`ServoInput`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoOutput {
    /// Strain rate, 1/s, tensor components, positive in extension. Finite, at most `rate_limit` in magnitude.
    pub rate: [f64; 6],
    /// True if the component was limited to `rate_limit`.
    pub saturated: [bool; 6],
}
