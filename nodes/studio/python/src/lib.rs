//! The Python module `grainlab`: packings as numpy arrays without copies, measurements, inversion, simulation.
//!
//! - `packing`: a packing and its arrays; `arrays`: views of Rust memory as numpy arrays
//! - `recording`: recordings, their packings and messages; `files`: packings from files of other programs
//! - `measure`, `invert`, `simulate`: the kernels, with the interpreter lock released
//! - `posterior`: draws from a posterior
//! - `values`: messages and quantities as Python objects; `error`: exceptions
//!
//! The Python half is in `python/grainlab`, the types for type checkers in `python/grainlab/_grainlab.pyi`.

// The documentation is in the type stubs, which Python users see.
#![allow(missing_docs)]

mod arrays;
mod error;
mod files;
mod invert;
mod measure;
mod packing;
mod posterior;
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
    module.add_class::<simulate::PySimulation>()?;
    module.add_function(wrap_pyfunction!(recording::open, module)?)?;
    module.add_function(wrap_pyfunction!(files::load, module)?)?;
    module.add_function(wrap_pyfunction!(measure::analyze, module)?)?;
    module.add_function(wrap_pyfunction!(measure::stiffness, module)?)?;
    module.add_function(wrap_pyfunction!(measure::quantities, module)?)?;
    module.add_function(wrap_pyfunction!(invert::invert, module)?)?;
    module.add_function(wrap_pyfunction!(invert::models, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulate, module)?)?;
    error::add(module)
}
