//! Exceptions, with the texts of the errors of Rust.

use grainlab_console::Failure;
use grainlab_msgs::Exit;
use pyo3::exceptions::{PyException, PyValueError};
use pyo3::prelude::*;
use pyo3::{PyErr, create_exception};
use std::fmt::Display;

create_exception!(grainlab, GrainlabError, PyException, "Any error of grainlab.");
create_exception!(
    grainlab,
    FileError,
    GrainlabError,
    "A file that cannot be read, or is not what it should be."
);
create_exception!(grainlab, SceneError, GrainlabError, "A scene with faults, or keys that it does not have.");
create_exception!(
    grainlab,
    PhysicsError,
    GrainlabError,
    "Physics that cannot go on: a packing that is not jammed, an unstable run, moduli without a solution."
);

/// The exception of an error of the library.
pub(crate) fn of(error: grainlab::Error) -> PyErr {
    match error {
        grainlab::Error::Scene(_) => scene(error),
        grainlab::Error::File(_) => file(error),
        _ => physics(error),
    }
}

/// The exception of a command that failed: wrong usage is a `ValueError`, and a file that cannot be read a `FileError`.
pub(crate) fn failure(failure: Failure) -> PyErr {
    match failure.exit {
        Exit::Usage => PyValueError::new_err(failure.to_string()),
        Exit::PhysicsInvalid => physics(failure),
        _ => file(failure),
    }
}

pub(crate) fn file(error: impl Display) -> PyErr {
    FileError::new_err(error.to_string())
}

pub(crate) fn scene(error: impl Display) -> PyErr {
    SceneError::new_err(error.to_string())
}

pub(crate) fn physics(error: impl Display) -> PyErr {
    PhysicsError::new_err(error.to_string())
}

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("GrainlabError", py.get_type::<GrainlabError>())?;
    module.add("FileError", py.get_type::<FileError>())?;
    module.add("SceneError", py.get_type::<SceneError>())?;
    module.add("PhysicsError", py.get_type::<PhysicsError>())
}
