//! Limitations of a measurement.

use crate::error::{AcousticsError, in_brackets};
use grainlab_core::results::SpringNote;

/// A limitation of a measurement.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Warning {
    /// The response is nonlinear.
    #[error(
        "the response along {}, polarization {}, is nonlinear: {opened} contacts opened, {closed} closed at a strain of \
         {amplitude:e}, the trace changes by {change:.1e} of itself at half of that; reduce the amplitude",
        in_brackets(direction),
        in_brackets(polarization)
    )]
    Nonlinear {
        /// Direction of propagation.
        direction: [f64; 3],
        /// Polarization of the wave.
        polarization: [f64; 3],
        /// Peak strain of the wave.
        amplitude: f64,
        /// Number of contacts that were missing in at least one comparison.
        opened: u32,
        /// Number of contacts that were new in at least one comparison.
        closed: u32,
        /// Root mean square of the relative change of the normalised trace at half the amplitude.
        change: f64,
    },
    /// A speed of large uncertainty.
    #[error(
        "the speed along {}, polarization {}, has a relative error of {relative:.1e}; average more shots if there is noise, \
         reduce the amplitude if contacts open",
        in_brackets(direction),
        in_brackets(polarization)
    )]
    Noisy {
        /// Direction of propagation.
        direction: [f64; 3],
        /// Polarization of the wave.
        polarization: [f64; 3],
        /// Relative standard deviation of the speed.
        relative: f64,
    },
    /// The packing is not at rest.
    #[error(
        "the packing did not come to rest (unbalanced force ratio {unbalanced:.1e}): its own motion is superposed on the waves; \
         relax it further, or increase the amplitude"
    )]
    NotAtRest {
        /// Mean net force of the grains that carry force, over the mean contact force.
        unbalanced: f64,
    },
    /// The springs of the network are not those of the contact law, or not those that inversions are calibrated for.
    #[error("waves {0}")]
    Springs(SpringNote),
    /// The waves are too short for an extrapolation to long ones.
    #[error(
        "the waves along {} are too short: the last term of their series is {ratio:.1} times the one before at the shortest, \
         and the stated errors may be too small; use longer waves",
        in_brackets(direction)
    )]
    TooShort {
        /// Direction of propagation.
        direction: [f64; 3],
        /// Last term of v² over the one before at the shortest wave.
        ratio: f64,
    },
    /// A mode was left out.
    #[error("left out: {0}")]
    LeftOut(AcousticsError),
}

/// Takes what was measured. What failed for want of a signal or a solution is left out with a warning; if all did, the first such error is
/// returned.
pub(crate) fn keep<T>(
    results: Vec<Result<T, AcousticsError>>,
    warnings: &mut Vec<Warning>,
    mut take: impl FnMut(T, &mut Vec<Warning>),
) -> Result<(), AcousticsError> {
    let (mut taken, mut first_error) = (false, None);
    for result in results {
        match result {
            Ok(found) => {
                taken = true;
                take(found, warnings);
            }
            Err(error @ (AcousticsError::NotConverged { .. } | AcousticsError::NoSignal { .. })) => {
                first_error = first_error.or_else(|| Some(error.clone()));
                warnings.push(Warning::LeftOut(error));
            }
            Err(error) => return Err(error),
        }
    }
    first_error.filter(|_| !taken).map_or(Ok(()), Err)
}
