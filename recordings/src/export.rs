//! Writes packings as files of other programs.

mod csv;
mod lammps_dump;

pub use csv::{csv, sidecar};
pub use lammps_dump::{DumpError, lammps_dump};
