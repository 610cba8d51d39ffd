//! What the moduli from wave speeds claim, one file a subject.

mod faults;
mod incomplete;
mod laboratory;
mod noise;
mod recovery;
