//! Tests of the acoustic node, on the bus in memory.

#[path = "../../../../kernels/micromechanics/tests/claims/touching_itself.rs"]
mod lattice;
mod node;
mod sample;
mod settings;
