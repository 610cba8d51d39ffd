//! Packings as files of other programs.
//!
//! - `files`: the files of one packing or of a run, by format
//! - `csv`, `lammps_*`, `extended_xyz`, `vtp`: one format each

mod csv;
mod extended_xyz;
mod files;
mod lammps_data;
mod lammps_dump;
mod vtp;

pub use csv::{csv, sidecar};
pub use extended_xyz::extended_xyz;
pub use files::{ExportFormat, Exporter, FilePart};
pub use lammps_data::lammps_data;
pub use lammps_dump::{lammps_dump, lammps_local};
