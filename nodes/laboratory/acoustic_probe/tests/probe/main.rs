//! Tests of the acoustic node, on the bus in memory.

mod lattice;
mod node;
mod sample;
mod settings;
