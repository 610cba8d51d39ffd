//! Hard cases of whole runs, each with its expected outcome.

mod drag;
mod rattlers;
mod scenes;
#[allow(dead_code)] // the engine's tests use more of it
#[path = "../../../dem/tests/hard/support.rs"]
mod support;
