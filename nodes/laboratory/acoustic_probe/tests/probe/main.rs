//! Tests of the acoustic node, on the bus in memory.

mod node;
mod sample;
mod settings;
