//! The program `grainlab`, in a process of Python.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs a command line, whose first word is the program; its exit code. The program starts itself again by the words of `again`.
#[pyfunction]
pub(crate) fn run(py: Python<'_>, words: Vec<OsString>, again: Vec<OsString>) -> u8 {
    grainlab_console::set_program(again);
    py.detach(|| grainlab_command::main(words).code())
}
