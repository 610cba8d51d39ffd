//! Structure and stiffness of a packing.

use crate::arrays::matrix;
use crate::error;
use crate::packing::PyPacking;
use crate::values;
use grainlab_core::Vec3;
use grainlab_core::results::QUANTITIES;
use grainlab_micromechanics::network::{SpringNetwork, Springs, relaxed_stiffness};
use grainlab_micromechanics::{PackingView, Settings, analyze as measure};
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn settings(axis: [f64; 3], springs: &str, tolerance: Option<f64>) -> PyResult<Settings> {
    Ok(Settings {
        axis: Vec3::from(axis),
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
    })
}

/// Everything that `grainlab analyze` reports of a packing, by key.
#[pyfunction]
#[pyo3(signature = (packing, *, axis=[0.0, 0.0, 1.0], springs="carried", tolerance=None))]
pub(crate) fn analyze<'py>(
    py: Python<'py>,
    packing: &Bound<'py, PyPacking>,
    axis: [f64; 3],
    springs: &str,
    tolerance: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let settings = settings(axis, springs, tolerance)?;
    let (packing, position) = (packing.get().packing(), packing.get().position());
    let mut found = py.detach(|| measure(packing, &settings)).map_err(error::physics)?;
    position.inspect(|position| position.judge_strain(&mut found.report));
    values::quantities(py, QUANTITIES, &found.report)
}

/// The stiffness of the contact network, Pa, shape `(6, 6)`: relaxed, or affine (Voigt).
#[pyfunction]
#[pyo3(signature = (packing, *, affine=false, springs="carried", tolerance=None))]
pub(crate) fn stiffness<'py>(
    py: Python<'py>,
    packing: &Bound<'py, PyPacking>,
    affine: bool,
    springs: &str,
    tolerance: Option<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let settings = settings([0.0, 0.0, 1.0], springs, tolerance)?;
    let packing = packing.get().packing();
    let solve = || {
        let network = SpringNetwork::new(&PackingView::new(packing)?, settings.springs)?;
        relaxed_stiffness(&network, settings.tolerance_for(packing.grains())?, settings.max_iterations)
    };
    let found = py.detach(solve).map_err(error::physics)?;
    let found =
        found.ok_or_else(|| error::physics("the packing is not jammed: its network has no stiffness"))?;
    let c = if affine { found.affine } else { found.relaxed };
    Ok(matrix(py, 6, |i, j| c.0[(i, j)]))
}

/// Quantities of `analyze`: by key, symbol, unit and meaning.
#[pyfunction]
pub(crate) fn quantities(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for q in QUANTITIES {
        dict.set_item(q.key, (q.symbol, q.unit, q.meaning))?;
    }
    Ok(dict)
}
