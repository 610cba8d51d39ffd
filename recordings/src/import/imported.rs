//! A packing from an external source.

use grainlab_core::Packing;
use grainlab_msgs::std_msgs::Header;

/// A packing and its source.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// Packing in SI units.
    pub packing: Packing,
    /// The header of its message: the recorded one, or that of an equivalent message.
    pub header: Header,
    /// Solver step of the state; 0 if unknown.
    pub step: u64,
    /// The run state of its message; empty if it was not recorded by a simulator.
    pub run_state: Vec<u8>,
    /// Description of its source, for the user.
    pub source: String,
    /// Warnings: contacts found rather than given, quantities that disagree.
    pub notes: Vec<String>,
}
