//! A packing from an external source.

use grainlab_core::Packing;
use grainlab_msgs::Exit;
use grainlab_msgs::std_msgs::Header;

use super::rounding::Rounding;

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
    /// How far its positions may be off, if the file has few digits of them.
    pub rounding: Option<Rounding>,
    /// Warnings: contacts found rather than given, quantities that disagree.
    pub notes: Vec<String>,
}

impl Imported {
    /// Returns the exit code that the packing alone causes: 4 where grains overlap beyond every contact law, which its notes say.
    pub fn exit(&self) -> Exit {
        let is_fault = self.packing.overlaps().is_some_and(|overlaps| overlaps.are_too_deep());
        if is_fault { Exit::PhysicsInvalid } else { Exit::Done }
    }
}
