//! Settings of the probe.

use crate::error::ProbeError;
use grainlab_core::Packing;

/// Settings of the probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainProbe {
    /// Magnitude of each strain (engineering strain for shears), in (0, 0.01]. It should be far below
    /// overlap/diameter, or contacts open: 1e-6 to 1e-7 is a plateau at 100 kPa in glass. Far below 1e-9
    /// rounding errors appear.
    pub amplitude: f64,
    /// Tolerance of the relaxation, about the error of C relative to the largest entry of a column, in [1e-8,
    /// 1e-2].
    pub tolerance: f64,
    /// Maximum number of steps of a relaxation.
    pub max_steps: u32,
    /// Friction while probing: infinite ("set very high") prevents all sliding, 0 removes tangential springs;
    /// other values let contacts slide. `None`: infinite, but 0 for a packing without friction.
    pub friction: Option<f64>,
}

impl Default for StrainProbe {
    fn default() -> Self {
        Self { amplitude: 1e-7, tolerance: 1e-5, max_steps: 50_000, friction: None }
    }
}

impl StrainProbe {
    pub(super) fn friction_of(&self, packing: &Packing) -> f64 {
        let carried = if packing.friction > 0.0 { f64::INFINITY } else { 0.0 };
        self.friction.unwrap_or(carried)
    }

    pub(super) fn check(&self) -> Result<(), ProbeError> {
        let range = |name, value: f64, accept: bool, requirement| {
            if accept { Ok(()) } else { Err(ProbeError::Setting { name, value, requirement }) }
        };
        let (a, t, f) = (self.amplitude, self.tolerance, self.friction.unwrap_or(0.0));
        range("amplitude", a, a > 0.0 && a <= 0.01, "a strain above 0 and at most 0.01")?;
        range("tolerance", t, (1e-8..=1e-2).contains(&t), "between 1e-8 and 1e-2")?;
        range("friction", f, f >= 0.0, "0 or more; inf is allowed")
    }
}
