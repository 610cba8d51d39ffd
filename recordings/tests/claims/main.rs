//! Tests of recordings and imports on whole files.

mod copies;
mod damage;
mod definitions;
mod foreign;
mod imports;
mod index;
mod lammps_forces;
mod malformed;
mod playback;
mod recovery;
mod reference_packing;
mod start;
mod stated_twice;
mod support;
mod write_and_read;
mod yade;
