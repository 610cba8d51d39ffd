//! Packings as files of other programs.
//!
//! - `files`: the files of one packing or of a run, by format; `columns`: what formats with named columns hold
//! - `csv`, `lammps_*`, `extended_xyz`, `vtp`: one format each

mod columns;
mod csv;
mod extended_xyz;
mod files;
mod lammps_data;
mod lammps_dump;
mod lammps_local;
mod vtp;

pub use csv::{csv, sidecar};
pub use extended_xyz::extended_xyz;
pub use files::{ExportFormat, Exporter, FilePart};
pub use lammps_data::lammps_data;
pub use lammps_dump::lammps_dump;
pub use lammps_local::lammps_local;
