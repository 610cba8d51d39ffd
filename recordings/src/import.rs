//! Packings from elsewhere: CSV with a JSON sidecar, LAMMPS dump and data files, text exports of YADE, and
//! recordings of ours.
//!
//! The parsers take text; [`load`] and [`each`] take a path, decompress `.gz` and pick the parser by content. Whatever the
//! source, the result is a validated [`grainlab_core::Packing`] in its conventions: contacts `i < j` by index,
//! normal from `i` to the image of `j`, tangential force on `i`. Where a source does not list contacts they
//! are found from positions, with Hertz normal forces and no tangential force.

use grainlab_core::{Mat3, Packing};
use grainlab_msgs::std_msgs::Header;

mod assemble;
pub mod contacts;
pub mod csv;
mod error;
pub mod lammps_data;
pub mod lammps_dump;
mod lammps_local;
mod load;
pub mod recording;
mod settings;
mod text;
pub mod yade;

pub use error::ImportError;
pub use load::{Loaded, each, load, text};
pub use settings::{ImportOptions, Setting};

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

/// The cell with edge vectors a = (lx, 0, 0), b = (xy, ly, 0), c = (xz, yz, lz), as LAMMPS has it, m.
fn lammps_cell(lengths: [f64; 3], [xy, xz, yz]: [f64; 3]) -> Mat3 {
    let [lx, ly, lz] = lengths;
    Mat3::new(
        lx, xy, xz, //
        0.0, ly, yz, //
        0.0, 0.0, lz,
    )
}
