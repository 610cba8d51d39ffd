//! Tests of structure and stiffness.

mod bounds;
mod dense;
mod directions;
mod factorised;
mod forces;
mod golden;
mod hard;
mod invariance;
mod lattices;
mod probe;
mod reference;
mod samples;
mod sizes;
mod springs;
mod stated_errors;
mod structure;
mod warnings;
