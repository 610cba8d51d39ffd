//! Packings from other sources: CSV with a JSON sidecar, LAMMPS dump and data files, extended XYZ, text exports of YADE, and
//! recordings of grainlab.
//!
//! The parsers take the content of a file; [`load`] and [`each`] take a path, decompress `.gz` and select the parser by
//! content. For every source, the result is a validated [`grainlab_core::Packing`] in its conventions:
//! contacts `i < j` by index, normal from `i` to the image of `j`, tangential force on `i`. If a source does
//! not list contacts, they are found from positions, with the normal forces of their law and without tangential ones.

mod assemble;
mod columns;
mod contact_lists;
pub mod csv;
mod error;
pub mod extended_xyz;
mod imported;
mod lammps_columns;
pub mod lammps_data;
pub mod lammps_dump;
mod lammps_items;
mod lammps_local;
mod load;
pub mod recording;
mod rounding;
mod settings;
mod start;
mod stated;
mod text;
pub mod yade;

pub use error::{ImportError, Setting};
pub use imported::Imported;
pub(crate) use load::instead_of_hdf5;
pub use load::{Loaded, each, load, text};
pub use rounding::Rounding;
pub use settings::{Frames, ImportOptions};
pub use start::{Start, start};
