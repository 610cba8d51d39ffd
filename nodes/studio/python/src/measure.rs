//! Structure and stiffness of a packing.

use crate::arrays::{matrix, numbers};
use crate::error;
use crate::packing::PyPacking;
use crate::parallel;
use crate::values;
use grainlab_command::in_memory;
use grainlab_core::Vec3;
use grainlab_core::notes::texts;
use grainlab_core::results::QUANTITIES;
use grainlab_micromechanics::network::Springs;
use grainlab_micromechanics::{Settings, analyze as measure};
use grainlab_recordings::import::Imported;
use grainlab_results::MeasuredPacking;
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

fn settings(axis: Option<&Bound<'_, PyAny>>, springs: &str, tolerance: Option<f64>) -> PyResult<Settings> {
    let axis = axis.map(|axis| numbers("axis", axis, &[Some(3)])).transpose()?;
    let settings = Settings {
        axis: axis.map_or(Vec3::z(), |axis| Vec3::from_column_slice(&axis)),
        springs: match springs {
            "carried" => Springs::Carried,
            "both" => Springs::NormalAndTangential,
            "normal" => Springs::Normal,
            other => {
                let known = "it must be one of: carried, both, normal";
                return Err(PyValueError::new_err(format!("springs is {other:?}; {known}")));
            }
        },
        tolerance,
        ..Settings::default()
    };
    settings.check().map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok(settings)
}

/// Everything that `grainlab analyze` reports of a packing, by key, and its warnings.
#[pyfunction]
pub(crate) fn analyze_one<'py>(
    py: Python<'py>,
    packing: &Bound<'py, PyPacking>,
    axis: Bound<'_, PyAny>,
    springs: &str,
    tolerance: Option<f64>,
) -> PyResult<(Bound<'py, PyDict>, Vec<String>)> {
    let settings = settings(Some(&axis), springs, tolerance)?;
    let owner = packing.clone().unbind();
    let found =
        parallel::detach(py, move |_| measure(owner.get().packing(), &settings))?.map_err(error::physics)?;
    let without = found.why_no_stiffness();
    let found = MeasuredPacking::new(String::new(), found.report).doubted(packing.get().packing(), &[]);
    let doubts = texts(&found.notes).into_iter().chain(without).collect();
    Ok((values::quantities(py, QUANTITIES, &found.report)?, doubts))
}

/// The text of `grainlab analyze --format csv`, a row for each packing, with its status and reason.
#[pyfunction]
pub(crate) fn analyze_all(
    py: Python<'_>,
    packings: Vec<Py<PyPacking>>,
    axis: Bound<'_, PyAny>,
    springs: &str,
    tolerance: Option<f64>,
) -> PyResult<String> {
    let settings = settings(Some(&axis), springs, tolerance)?;
    parallel::detach(py, move |stop| values::csv(&in_memory::analyze(&settings, &imported(&packings), stop)))
}

/// The text of `grainlab probe --format csv`, a row for each packing, with its status and reason; and the JSON of the first, if it has any.
#[pyfunction]
pub(crate) fn probe_all(
    py: Python<'_>,
    packings: Vec<Py<PyPacking>>,
    flags: Vec<(String, String)>,
) -> PyResult<(String, Option<String>)> {
    let found = parallel::detach(py, move |stop| in_memory::probe(&flags, &imported(&packings), stop))?
        .map_err(error::failure)?;
    let first = found.first().and_then(|result| result.as_ref().ok());
    Ok((values::csv(&found), first.and_then(|(found, _)| serde_json::to_string(found).ok())))
}

/// Writes packings in a format of `grainlab bag export` into a folder; notes on them.
#[pyfunction]
pub(crate) fn export(
    py: Python<'_>,
    packings: Vec<Py<PyPacking>>,
    format: &str,
    folder: PathBuf,
) -> PyResult<Vec<String>> {
    py.detach(|| in_memory::export(format, &folder, &imported(&packings))).map_err(error::failure)
}

fn imported(packings: &[Py<PyPacking>]) -> Vec<&Imported> {
    packings.iter().map(|packing| packing.get().imported()).collect()
}

/// Stiffness of the contact network, Pa, (6, 6), Voigt order with engineering shear: with relaxation of the grains, or
/// affine. Springs and tolerance are those of :func:`analyze`. Raises PhysicsError if the packing is not jammed.
///
/// >>> grainlab.stiffness(packing)[2, 2]
#[pyfunction]
#[pyo3(signature = (packing, *, affine=false, springs="carried", tolerance=None))]
pub(crate) fn stiffness<'py>(
    py: Python<'py>,
    packing: &Bound<'py, PyPacking>,
    affine: bool,
    springs: &str,
    tolerance: Option<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let settings = settings(None, springs, tolerance)?;
    let owner = packing.clone().unbind();
    let found =
        parallel::detach(py, move |_| measure(owner.get().packing(), &settings))?.map_err(error::physics)?;
    let c = match &found.report.elasticity {
        Ok(found) => {
            if affine {
                found.bounds.affine
            } else {
                found.tensor
            }
        }
        Err(why) => return Err(error::physics(found.why_no_stiffness().unwrap_or_else(|| why.to_string()))),
    };
    Ok(matrix(py, 6, |i, j| c.0[(i, j)]))
}

/// The keys of :func:`analyze`, each with (symbol, unit, meaning). Raises nothing.
///
/// >>> grainlab.quantities()["phi"]
/// ('φ', '1', 'solid fraction')
#[pyfunction]
pub(crate) fn quantities(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for q in QUANTITIES {
        dict.set_item(q.key, (q.symbol, q.unit, q.meaning))?;
    }
    Ok(dict)
}
