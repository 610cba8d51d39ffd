//! Why a measurement failed.

use grainlab_core::Vec3;
use grainlab_core::results::NoStiffness;

/// Why a packing's wave speeds could not be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AcousticsError {
    /// A setting is out of its range.
    #[error("setting {name} = {value:e} is out of range: {requirement}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// The value found.
        value: f64,
        /// Requirement on the value.
        requirement: &'static str,
    },
    /// No contact carries force, so that no wave propagates.
    #[error(transparent)]
    NoStiffness(#[from] NoStiffness),
    /// Waves of this frequency do not propagate in the packing.
    #[error(
        "a frequency of {frequency:.4e} Hz is above the cut-off of {cutoff:.4e} Hz, where waves along {} are two grains long and \
         do not propagate; use less than half of it",
        in_brackets(direction)
    )]
    CutOff {
        /// The frequency, Hz.
        frequency: f64,
        /// The cut-off, Hz.
        cutoff: f64,
        /// Direction of propagation.
        direction: [f64; 3],
    },
    /// A record without an arrival.
    #[error("no arrival: {0}")]
    NoArrival(String),
    /// The sample is too short for the wave.
    #[error(
        "{copies} repetitions of the packing are a path of {path:.4e} m, and {needed:.4e} m are needed: the wave in the opposite \
         direction must not reach the furthest receiver during the recording; use {enough} repetitions or a shorter wave"
    )]
    PathTooShort {
        /// Number of repetitions.
        copies: u32,
        /// Length of the path, m.
        path: f64,
        /// Length needed, m.
        needed: f64,
        /// Number of repetitions that suffices.
        enough: u32,
    },
    /// The ray is not normal to lattice planes, so that the packing cannot be repeated along it.
    #[error(
        "the packing cannot be repeated along {}, which is not normal to lattice planes",
        in_brackets(direction)
    )]
    NoLatticePlane {
        /// Direction of propagation.
        direction: [f64; 3],
    },
    /// The modes of a wave vector did not converge.
    #[error(
        "the modes along {} at a wavelength of {wavelength:.4e} m were not found: {reason}",
        in_brackets(direction)
    )]
    NotConverged {
        /// Direction of propagation.
        direction: [f64; 3],
        /// Wavelength of the modes, m.
        wavelength: f64,
        /// Reason of the failure.
        reason: String,
    },
    /// No arrival or long wave was found.
    #[error(
        "no {what} along {}, polarization {}: {reason}",
        in_brackets(direction),
        in_brackets(polarization)
    )]
    NoSignal {
        /// Name of the missing signal.
        what: &'static str,
        /// Direction of propagation.
        direction: [f64; 3],
        /// Polarization of the wave.
        polarization: [f64; 3],
        /// Reason of the failure.
        reason: String,
    },
    /// The contact network could not be built.
    #[error(transparent)]
    Network(#[from] grainlab_micromechanics::MicroError),
    /// The engine failed.
    #[error(transparent)]
    Engine(#[from] grainlab_engine::EngineError),
}

pub(crate) fn setting(
    name: &'static str,
    value: f64,
    valid: bool,
    requirement: &'static str,
) -> Result<(), AcousticsError> {
    if valid { Ok(()) } else { Err(AcousticsError::Setting { name, value, requirement }) }
}

pub(crate) fn no_signal(
    what: &'static str,
    direction: &Vec3,
    polarization: &Vec3,
    reason: impl Into<String>,
) -> AcousticsError {
    let (direction, polarization) = ((*direction).into(), (*polarization).into());
    AcousticsError::NoSignal { what, direction, polarization, reason: reason.into() }
}

pub(crate) fn in_brackets(v: &[f64; 3]) -> String {
    format!("({:.3}, {:.3}, {:.3})", v[0], v[1], v[2])
}
