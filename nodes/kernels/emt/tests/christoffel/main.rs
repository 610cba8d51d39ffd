//! What the moduli from wave speeds claim, one file a subject.

mod axis;
mod departure;
mod faults;
mod incomplete;
mod laboratory;
mod noise;
mod recovery;
