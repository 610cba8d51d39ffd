//! Packings from other sources: CSV with a JSON sidecar, LAMMPS dump and data files, text exports of YADE, and
//! our own recordings.
//!
//! The parsers take text; [`load`] and [`each`] take a path, decompress `.gz` and pick the parser by content. Whatever
//! the source, the result is a validated [`grainlab_core::Packing`] in its conventions: contacts `i < j` by index,
//! normal from `i` to the image of `j`, tangential force on `i`. Where a source does not list contacts they are found
//! from positions, with Hertz normal forces and no tangential force.

mod assemble;
pub mod contacts;
pub mod csv;
mod error;
mod imported;
mod lammps_cell;
pub mod lammps_data;
pub mod lammps_dump;
mod lammps_local;
mod load;
pub mod recording;
mod setting;
mod settings;
mod text;
pub mod yade;

pub use error::ImportError;
pub use imported::Imported;
pub use load::{Loaded, each, load, text};
pub use setting::Setting;
pub use settings::ImportOptions;
