//! Tests of structure and stiffness.

mod bounds;
mod dense;
mod directions;
mod factorised;
mod forces;
mod golden;
#[path = "../../../acoustics/tests/claims/golden_packing.rs"]
mod golden_packing;
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
mod touching_itself;
mod warnings;
