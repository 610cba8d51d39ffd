//! What this kernel claims, each claim a test.

mod dense;
mod direct;
mod golden;
mod invariance;
mod lattices;
mod probe;
mod reference;
mod samples;
mod structure;
