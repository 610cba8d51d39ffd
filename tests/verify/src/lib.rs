//! The engine and the measurements compared with numbers of other codes and of the literature.
//!
//! Each suite is a module with its rows, and its data in the folder `data`, with their sources. Everything is computed by the
//! engine, its contact law and the measurements themselves. The program `grainlab_verify` prints every row.
//!
//! - [`Row`], [`Point`], [`Measure`], [`Verdict`]: a comparison and what follows from it
//! - [`lammps_pairs`]: two spheres, as LAMMPS's own tests record them
//! - [`chung_ooi`]: the eight tests of Chung & Ooi (2011)
//! - [`mercury`], [`ondem`]: one contact under prescribed motions
//! - [`grainlearning`]: what a force curve fixes, and what it does not
//! - [`smooth_moduli`], [`lammps_packings`], [`uniaxial`]: packings, which the program reads
//! - [`laboratory`]: wave speeds of real samples
//! - [`agnolin_roux`]: packings prepared as published; takes minutes
//! - [`conformance`]: tests of an engine, ours or that of another crate

pub mod agnolin_roux;
pub mod chung_ooi;
pub mod conformance;
mod error;
mod forced_contact;
pub mod grainlearning;
mod hertz;
pub mod laboratory;
mod lammps_impacts;
pub mod lammps_packings;
pub mod lammps_pairs;
pub mod mercury;
pub mod ondem;
mod reference;
mod restitution;
mod row;
pub mod smooth_moduli;
mod two_spheres;
pub mod uniaxial;

pub use error::VerificationError;
pub use row::{Measure, Point, Row, Verdict};
