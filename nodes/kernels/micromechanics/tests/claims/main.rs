//! What this kernel claims, each claim a test.

mod bounds;
mod dense;
mod direct;
mod directions;
mod forces;
mod golden;
mod hard;
mod invariance;
mod lattices;
mod probe;
mod reference;
mod samples;
mod sizes;
mod structure;
