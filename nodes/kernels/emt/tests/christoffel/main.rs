//! Tests of the moduli from wave speeds, one file per subject.

mod axis;
mod departure;
mod faults;
mod laboratory;
mod noise;
mod recovery;
