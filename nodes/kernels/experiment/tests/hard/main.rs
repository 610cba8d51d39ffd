//! Hard cases of whole runs, each with its expected outcome.

mod drag;
mod rattlers;
mod scenes;
