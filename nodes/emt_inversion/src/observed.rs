//! What the models are asked with, wherever it is from.

use grainlab_emt::christoffel::{AxisError, ChristoffelError};
use grainlab_emt::{Misfit, Modulus, Observation};

/// Moduli with their state, and what was seen on the way to them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Observed {
    /// What the models take.
    pub(crate) observation: Observation,
    /// How far the data are from any moduli; `None` if they are as many.
    pub(crate) misfit: Option<Misfit>,
    /// Whether that is further than their errors allow.
    pub(crate) in_conflict: bool,
    /// For a reader of every estimate.
    pub(crate) notes: Vec<String>,
}

/// Why data have no moduli about the axis asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Unobservable {
    /// The axis is to come with the data, and did not.
    #[error("the axis is to be the one found, and these data name none: set the parameter axis")]
    NoAxis,
    /// Moduli cannot be turned.
    #[error(
        "the moduli given are those about e3, and without the full stiffness they say nothing about the axis \
         ({:.4}, {:.4}, {:.4})", axis[0], axis[1], axis[2]
    )]
    NoStiffness {
        /// The axis.
        axis: [f64; 3],
    },
    /// Moduli, strain ratios and anisotropy are about one axis, and another is asked for.
    #[error(
        "these moduli and their gamma/Delta are about ({:.4}, {:.4}, {:.4}), and the parameter axis asks for \
         ({:.4}, {:.4}, {:.4}): give the analyzer that axis, or leave the parameter at stated",
        stated[0], stated[1], stated[2], asked[0], asked[1], asked[2]
    )]
    OtherAxis {
        /// The axis of the moduli.
        stated: [f64; 3],
        /// The axis asked for.
        asked: [f64; 3],
    },
    /// Wave speeds without a medium.
    #[error(transparent)]
    Speeds(#[from] ChristoffelError),
    /// Wave speeds without an axis.
    #[error("no axis was named, and none was found: {0}")]
    Axis(#[from] AxisError),
}

impl Unobservable {
    /// Whether the data are too few, or are no data, rather than those of no medium.
    pub(crate) fn is_input_error(&self) -> bool {
        match self {
            Unobservable::Speeds(error) | Unobservable::Axis(AxisError::Speeds(error)) => {
                error.is_input_error()
            }
            _ => true,
        }
    }
}

/// The moduli as they are.
impl From<Observation> for Observed {
    fn from(observation: Observation) -> Self {
        Self { observation, misfit: None, in_conflict: false, notes: Vec::new() }
    }
}

/// The same with an independent relative error of every modulus measured; where these are the five of a medium, Θ follows
/// from them.
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
