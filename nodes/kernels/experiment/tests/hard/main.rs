//! Hard cases of whole runs, each with its expected outcome.

mod drag;
mod rattlers;
mod scenes;
#[allow(dead_code)] // used by the tests of the engine
#[path = "../../../dem/tests/hard/support.rs"]
mod support;
