//! Why no axis was found.

use super::error::ChristoffelError;
use grainlab_core::Vec3;

/// Why wave speeds do not determine an axis of symmetry.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AxisError {
    /// The speeds are invalid.
    #[error(transparent)]
    Speeds(#[from] ChristoffelError),
    /// Fewer speeds than unknowns.
    #[error(
        "{speeds} wave speeds cannot determine {unknowns} unknowns, including the axis{}: add speeds in other directions, \
         first along {}", if *scatter { " and the scatter of the speeds" } else { "" }, in_brackets(direction)
    )]
    TooFew {
        /// Number of speeds.
        speeds: usize,
        /// Number of combinations of moduli that they determine, plus two for the axis, plus one if their error is not
        /// known.
        unknowns: usize,
        /// True if the error of the speeds is one of the unknowns.
        scatter: bool,
        /// The unit direction furthest from all measured ones.
        direction: Vec3,
    },
    /// An isotropic medium fits as well.
    #[error(
        "the wave speeds do not distinguish the medium from an isotropic one ({sigma:.1} sigma, and {needed:.1} are needed): \
         any axis would serve"
    )]
    Isotropic {
        /// Number of standard deviations by which the best axis fits better.
        sigma: f64,
        /// Number of standard deviations needed.
        needed: f64,
    },
    /// Two axes fit equally well.
    #[error(
        "the wave speeds fit the axes {} and {} equally well: measure along {}, where {}",
        in_brackets(&axes[0]), in_brackets(&axes[1]), in_brackets(direction),
        difference.map_or_else(|| "nothing is known".to_owned(), |d| format!("their P speeds differ by {:.1} %", 100.0 * d))
    )]
    NotUnique {
        /// The best two axes, unit vectors.
        axes: [Vec3; 2],
        /// The unit direction in which their media differ most.
        direction: Vec3,
        /// Relative difference of the P speeds there; `None` if no P speed is known.
        difference: Option<f64>,
    },
}

fn in_brackets(v: &Vec3) -> String {
    format!("({:.2}, {:.2}, {:.2})", v.x, v.y, v.z)
}
