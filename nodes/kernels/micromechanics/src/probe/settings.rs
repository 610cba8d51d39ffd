//! How a packing is probed.

use crate::error::ProbeError;
use grainlab_core::contact::TangentialLaw;

/// How a packing is probed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainProbe {
    /// Magnitude of each strain (engineering strain for shears), in (0, 0.01]. It should be far below overlap/diameter, or
    /// contacts open: 1e-6 to 1e-7 is a plateau at 100 kPa in glass; far below 1e-9 rounding shows.
    pub amplitude: f64,
    /// Which strains are compared.
    pub sides: DifferenceScheme,
    /// Error allowed to the relaxation, about that of C relative to the largest entry of a column, in [1e-8, 1e-2].
    pub tolerance: f64,
    /// Steps after which a relaxation gives up.
    pub max_steps: u32,
    /// Friction while probing: infinite ("set very high") sticks every contact, 0 takes tangential springs away, what
    /// is between lets contacts slide.
    pub friction: f64,
    /// How the tangential force follows a change of normal stiffness. [`TangentialLaw::Incremental`] has the frozen
    /// network as its linear limit; the other law depends on the direction of the strain however small.
    pub tangential: TangentialLaw,
}

impl Default for StrainProbe {
    fn default() -> Self {
        Self {
            amplitude: 1e-7,
            sides: DifferenceScheme::Central,
            tolerance: 1e-5,
            max_steps: 50_000,
            friction: f64::INFINITY,
            tangential: TangentialLaw::Incremental,
        }
    }
}

/// Which strains a column is the difference of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DifferenceScheme {
    /// +amplitude and −amplitude: the error is of second order in the amplitude while no contact opens.
    Central,
    /// +amplitude (extension) and none.
    Forward,
}

impl StrainProbe {
    /// The settings, or what is out of range.
    pub(super) fn check(&self) -> Result<(), ProbeError> {
        let range = |name, value: f64, accept: bool, requirement| {
            if accept { Ok(()) } else { Err(ProbeError::Setting { name, value, requirement }) }
        };
        let (a, t, f) = (self.amplitude, self.tolerance, self.friction);
        range("amplitude", a, a > 0.0 && a <= 0.01, "a strain above 0 and at most 0.01")?;
        range("tolerance", t, (1e-8..=1e-2).contains(&t), "between 1e-8 and 1e-2")?;
        range("friction", f, f >= 0.0, "0 or more; inf is allowed")
    }
}
