//! The `grainlab` binary.

fn main() {}
