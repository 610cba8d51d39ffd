//! A packing from an external source.

use grainlab_core::Packing;
use grainlab_msgs::std_msgs::Header;

/// A packing and where it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The packing.
    pub packing: Packing,
    /// The header of its message: as recorded, or as a message of it would have.
    pub header: Header,
    /// Solver step at which it was taken; 0 if the source does not say.
    pub step: u64,
    /// What it was read from, for people.
    pub source: String,
    /// What people should know about it: contacts found rather than given, quantities that disagree.
    pub notes: Vec<String>,
}
