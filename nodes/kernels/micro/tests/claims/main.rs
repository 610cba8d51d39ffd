//! What this kernel claims, each claim a test.

mod dense;
mod invariance;
mod lattices;
mod reference;
mod samples;
mod structure;
