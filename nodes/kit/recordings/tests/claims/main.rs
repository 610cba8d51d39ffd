//! Tests of recordings and imports on whole files.

mod after_end;
mod by_hand;
mod contact_lists;
mod copies;
mod damage;
mod definitions;
mod forbidden;
mod foreign;
mod framings;
mod full_disk;
mod imports;
mod index;
mod lammps_forces;
mod malformed;
mod many_topics;
mod playback;
mod recovery;
mod reference_packing;
mod start;
mod stated_twice;
mod support;
mod write_and_read;
mod yade;
