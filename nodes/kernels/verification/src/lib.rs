//! The engine and the measurements beside numbers of other codes and of the literature.

pub mod chung_ooi;
mod error;
mod forced_contact;
pub mod grainlearning;
mod hertz;
mod lammps_impacts;
pub mod lammps_pairs;
pub mod mercury;
pub mod ondem;
mod reference;
mod restitution;
mod row;
mod two_spheres;

pub use error::VerificationError;
pub use row::{Measure, Point, Row, Verdict};
