//! The Python module `grainlab`: packings as numpy arrays without copies, measurements, inversion, simulation, and the program.
//!
//! - `packing`: a packing and its arrays; `arrays`: views of Rust memory as numpy arrays
//! - `recording`: recordings, their packings and messages; `files`: packings from files of other programs
//! - `measure`, `invert`, `simulate`: kernels and commands, with the interpreter lock released; `program`: the command line
//! - `posterior`: draws from a posterior; `parallel`: threads of this process
//! - `values`: messages and quantities as Python objects; `error`: exceptions
//!
//! The Python half is in `python/grainlab`. The classes and functions that users see have their texts here; `tests/test_texts.py`
//! compares them with the types for type checkers in `python/grainlab/_grainlab.pyi`.

#![allow(missing_docs)]

mod arrays;
mod error;
mod files;
mod invert;
mod measure;
mod packing;
mod parallel;
mod posterior;
mod program;
mod recording;
mod simulate;
mod values;

use pyo3::prelude::*;

#[pymodule]
fn _grainlab(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<packing::PyPacking>()?;
    module.add_class::<recording::PyRecording>()?;
    module.add_class::<recording::PackingIterator>()?;
    module.add_class::<recording::MessageIterator>()?;
    module.add_class::<simulate::Run>()?;
    module.add_function(wrap_pyfunction!(recording::open, module)?)?;
    module.add_function(wrap_pyfunction!(files::load, module)?)?;
    module.add_function(wrap_pyfunction!(packing::unpickled, module)?)?;
    module.add_function(wrap_pyfunction!(packing::page, module)?)?;
    module.add_function(wrap_pyfunction!(measure::analyze_one, module)?)?;
    module.add_function(wrap_pyfunction!(measure::analyze_all, module)?)?;
    module.add_function(wrap_pyfunction!(measure::probe_all, module)?)?;
    module.add_function(wrap_pyfunction!(measure::export, module)?)?;
    module.add_function(wrap_pyfunction!(measure::stiffness, module)?)?;
    module.add_function(wrap_pyfunction!(measure::quantities, module)?)?;
    module.add_function(wrap_pyfunction!(invert::inverted, module)?)?;
    module.add_function(wrap_pyfunction!(invert::models, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::begin, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::scene, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::scenes_built_in, module)?)?;
    module.add_function(wrap_pyfunction!(program::run, module)?)?;
    array_interface(module.py())?;
    error::add(module)
}

/// Loads the C interface of numpy. At its first use it would be loaded by Python code, which a signal may interrupt: the crate numpy then panics.
fn array_interface(py: Python<'_>) -> PyResult<()> {
    py.import("numpy")?;
    // Modules that are imported run no Python code, and so no handler of a signal.
    numpy::PyArray1::<f64>::zeros(py, 0, false);
    Ok(())
}
