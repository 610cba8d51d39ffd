//! Why no axis is found.

use super::ChristoffelError;
use grainlab_core::Vec3;

/// Why wave speeds tell no axis of symmetry.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AxisError {
    /// The speeds are none.
    #[error(transparent)]
    Speeds(#[from] ChristoffelError),
    /// Fewer speeds than unknowns.
    #[error(
        "{speeds} wave speeds cannot tell {unknowns} unknowns, the axis among them{}: add speeds in other directions, first \
         along {}", if *scatter { " and the scatter of the speeds" } else { "" }, in_brackets(direction)
    )]
    TooFew {
        /// Speeds given.
        speeds: usize,
        /// Combinations of moduli that they see, and two for the axis; one more if their error is not known.
        unknowns: usize,
        /// Whether that one is in it.
        scatter: bool,
        /// The unit direction furthest from all measured.
        direction: Vec3,
    },
    /// An isotropic medium fits as well.
    #[error(
        "the wave speeds do not tell the medium from an isotropic one ({sigma:.1} sigma, and {needed:.1} are needed): any axis \
         would serve"
    )]
    Isotropic {
        /// By how many standard deviations they prefer an axis.
        sigma: f64,
        /// How many it takes.
        needed: f64,
    },
    /// Two axes fit alike.
    #[error(
        "the wave speeds fit the axes {} and {} alike: measure along {}, where {}",
        in_brackets(&axes[0]), in_brackets(&axes[1]), in_brackets(direction),
        difference.map_or_else(|| "nothing is known".to_owned(), |d| format!("their P speeds differ by {:.1} %", 100.0 * d))
    )]
    NotUnique {
        /// The best two, unit vectors.
        axes: [Vec3; 2],
        /// The unit direction in which they differ most.
        direction: Vec3,
        /// By which part of the P speed; `None` if no P speed is known.
        difference: Option<f64>,
    },
}

fn in_brackets(v: &Vec3) -> String {
    format!("({:.2}, {:.2}, {:.2})", v.x, v.y, v.z)
}
