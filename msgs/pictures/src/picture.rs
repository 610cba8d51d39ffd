//! From the bytes of a packing to the bytes of its pictures.

use crate::drawn::Drawn;
use crate::markers::markers;
use crate::points::points;
use grainlab_core::Packing;
use grainlab_msgs::{Topic, from_cdr, msg, to_cdr, topics};

/// A picture of a packing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Picture {
    /// Message of [`points`].
    Points,
    /// Message of [`markers`].
    Markers,
}

impl Picture {
    /// List of all pictures.
    pub const ALL: [Self; 2] = [Self::Points, Self::Markers];

    /// The row of its topic.
    pub const fn topic(self) -> &'static Topic {
        match self {
            Self::Points => &topics::PACKING_POINTS,
            Self::Markers => &topics::PACKING_MARKERS,
        }
    }

    /// Name of its topic below that of a topic with packings: `/lab/packing/points`.
    pub fn beside(self, packings: &str) -> String {
        let last = match self {
            Self::Points => "points",
            Self::Markers => "markers",
        };
        format!("{packings}/{last}")
    }

    /// The picture as CDR.
    pub fn encoded(self, drawn: &Drawn<'_>) -> Vec<u8> {
        match self {
            Self::Points => to_cdr(&points(drawn)),
            Self::Markers => to_cdr(&markers(drawn)),
        }
    }
}

/// The packing in a message, checked.
///
/// # Errors
/// If the bytes are not a message of a packing, or its values are not those of a packing.
pub fn packing(body: &[u8]) -> Result<Packing, String> {
    let message: msg::Packing = from_cdr(body).map_err(|e| e.to_string())?;
    Packing::try_from(&message).map_err(|e| e.to_string())
}
