//! The program `grainlab`, in a process of Python.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs a command line, whose first word is the program; its exit code. The program starts itself again by the words of `again`. With
/// `ends_with_parent` it is told to end, by SIGTERM, when the process that started it has.
#[pyfunction]
pub(crate) fn run(py: Python<'_>, words: Vec<OsString>, again: Vec<OsString>, ends_with_parent: bool) -> u8 {
    grainlab_console::set_program(again);
    if ends_with_parent {
        // SAFETY: prctl takes integers, and accesses no memory.
        unsafe { libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGTERM) };
    }
    py.detach(|| grainlab_command::main(words).code())
}
