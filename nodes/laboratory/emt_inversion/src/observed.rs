//! The input of the models, from a packing, moduli or wave speeds.

use grainlab_core::notes::Note;
use grainlab_emt::christoffel::{AxisError, ChristoffelError};
use grainlab_emt::{Misfit, Modulus, Observation};
use grainlab_msgs::boundary::BoundaryError;

/// Moduli with their state, and details of how they were obtained.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Observed {
    pub(crate) observation: Observation,
    /// Misfit of the data about the moduli; `None` without degrees of freedom.
    pub(crate) misfit: Option<Misfit>,
    /// Notes, added to every estimate.
    pub(crate) notes: Vec<Note>,
}

/// Why data have no moduli about the axis set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Unobservable {
    /// The message is invalid.
    #[error(transparent)]
    Refused(#[from] BoundaryError),
    /// The moduli cannot be transformed to another axis.
    #[error(
        "the moduli given are those about e3, and without the full stiffness they do not determine those about \
         ({:.4}, {:.4}, {:.4})", axis[0], axis[1], axis[2]
    )]
    NoStiffness { axis: [f64; 3] },
    /// Moduli, strain ratios and anisotropy refer to one axis, and another one is set.
    #[error(
        "these moduli and their gamma/Delta are about ({:.4}, {:.4}, {:.4}), and the parameter axis is \
         ({:.4}, {:.4}, {:.4}): give the analyzer that axis, or leave the parameter at stated",
        stated[0], stated[1], stated[2], asked[0], asked[1], asked[2]
    )]
    OtherAxis {
        /// The axis of the moduli.
        stated: [f64; 3],
        asked: [f64; 3],
    },
    /// No medium has these wave speeds.
    #[error(transparent)]
    Speeds(#[from] ChristoffelError),
    /// The wave speeds do not determine an axis.
    #[error("no axis was named, and none was found: {0}")]
    Axis(#[from] AxisError),
}

/// The moduli, unchanged.
impl From<Observation> for Observed {
    fn from(observation: Observation) -> Self {
        Self { observation, misfit: None, notes: Vec::new() }
    }
}

/// Observation with an independent relative error of every measured modulus; if these are the five of a medium,
/// Θ follows from them.
pub(crate) fn with_error(observation: Observation, relative: f64) -> Observation {
    const BESIDE_THETA: [Modulus; 4] = [Modulus::C11, Modulus::C33, Modulus::C13, Modulus::G12];
    if relative == 0.0 {
        return observation;
    }
    let theta_follows = BESIDE_THETA.iter().all(|m| observation.moduli.get(*m).is_some());
    let measured =
        if theta_follows { observation.moduli.without(Modulus::Theta) } else { observation.moduli };
    Observation { moduli: measured, ..observation }.with_relative_error(relative)
}
