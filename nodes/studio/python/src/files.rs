//! Packings from files of other programs.

use crate::arrays::numbers;
use crate::error;
use crate::packing::PyPacking;
use crate::parallel;
use grainlab_core::Mat3;
use grainlab_recordings::import::{self, ImportOptions};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use std::ffi::CString;
use std::path::PathBuf;

/// All packings of a recording, CSV, LAMMPS dump or data file, or YADE export; keywords give what the file lacks, in SI
/// units: cell (3, 3) and radius, m; shear modulus, Pa; density, kg/m3. Raises FileError.
///
/// >>> (packing,) = grainlab.load("packing.data", shear_modulus=29e9, poisson_ratio=0.2, friction=0.3)
#[pyfunction]
#[pyo3(signature = (path, *, cell=None, shear_modulus=None, poisson_ratio=None, density=None, friction=None, radius=None,
    topic=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn load(
    py: Python<'_>,
    path: PathBuf,
    cell: Option<Bound<'_, PyAny>>,
    shear_modulus: Option<f64>,
    poisson_ratio: Option<f64>,
    density: Option<f64>,
    friction: Option<f64>,
    radius: Option<f64>,
    topic: Option<String>,
) -> PyResult<Vec<PyPacking>> {
    let cell = cell.map(|cell| numbers("cell", &cell, &[Some(3), Some(3)])).transpose()?;
    let options = ImportOptions {
        cell: cell.map(|cell| Mat3::from_row_slice(&cell)),
        shear_modulus,
        poisson_ratio,
        density,
        friction,
        radius,
        topic,
        ..ImportOptions::default()
    };
    let loaded = parallel::detach(py, move |_| import::load(&path, &options))?.map_err(error::file)?;
    for warning in &loaded.warnings {
        warn(py, &warning.to_string())?;
    }
    Ok(loaded.packings.into_iter().map(PyPacking::from).collect())
}

pub(crate) fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let text = CString::new(text.replace('\0', " "))?;
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)
}
