//! From moduli to microstructure.

use crate::{error, parallel, posterior};
use grainlab_command::in_memory::{self, By, InvertedRow};
use grainlab_core::notes::texts;
use grainlab_core::results::InferredQuantity;
use grainlab_msgs::Exit;
use grainlab_results::Inference;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Names of the models of :func:`invert`, the one with the smallest error on held-out packings first. It has no units and raises nothing.
///
/// >>> grainlab.models()[0]
/// 'relaxed'
#[pyfunction]
pub(crate) fn models() -> Vec<&'static str> {
    grainlab_emt::models().iter().map(|m| m.name()).collect()
}

/// Inverts the rows of a table, the text of a file: columns of the answers, and draws from the posterior of the first row, if a number of
/// them in each chain and a seed are given. `by` has model, calibration, prior and relative error.
#[pyfunction]
pub(crate) fn inverted<'py>(
    py: Python<'py>,
    table: Vec<u8>,
    by: (String, String, Option<String>, Option<f64>),
    draws: Option<(usize, u64)>,
) -> PyResult<(Bound<'py, PyDict>, Option<Bound<'py, PyDict>>)> {
    let draws = draws.map(|(each, seed)| (posterior::CHAINS * each, seed));
    let found = parallel::detach(py, move |stop| {
        let (model, calibration, prior, error) = &by;
        let by = By { model, calibration, prior: prior.as_deref(), error: *error, draws };
        in_memory::invert(table, &by, stop)
    });
    let found = found?.map_err(error::failure)?;
    let drawn = found.draws.map(|draws| posterior::groups(py, &draws)).transpose()?;
    Ok((answers(py, &found.rows)?, drawn))
}

fn answers<'py>(py: Python<'py>, rows: &[InvertedRow]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let numbers = |key: String, value: &dyn Fn(&Inference) -> Option<f64>| {
        py.check_signals()?;
        let values: Vec<f64> = rows.iter().map(|row| value(&row.inference).unwrap_or(f64::NAN)).collect();
        dict.set_item(key, values.into_pyarray(py))
    };
    let words = |key: &str, value: &dyn Fn(&InvertedRow) -> String| {
        py.check_signals()?;
        dict.set_item(key, rows.iter().map(value).collect::<Vec<_>>())
    };
    if rows.iter().any(|row| row.sample.is_some()) {
        words("sample", &|row| row.sample.clone().unwrap_or_default())?;
    }
    words("model", &|row| row.inference.model.clone())?;
    words("calibration", &|row| row.inference.calibration.clone())?;
    for quantity in InferredQuantity::ALL {
        let (name, at) = (quantity.name(), quantity as usize);
        numbers(name.to_owned(), &|row| row.values.0[at])?;
        numbers(format!("{name}_sigma"), &|row| row.sigma(InferredQuantity::ALL[at]))?;
        numbers(format!("{name}_low"), &|row| row.interval.bounds.0[at].map(|b| b[0]))?;
        numbers(format!("{name}_high"), &|row| row.interval.bounds.0[at].map(|b| b[1]))?;
    }
    numbers("chi_square".to_owned(), &|row| row.chi_square)?;
    numbers("gamma_over_delta".to_owned(), &|row| row.gamma.map(|gamma| gamma.value))?;
    words("status", &|row| row.inference.status.to_string())?;
    words("reason", &|row| texts(&row.inference.notes).join("; "))?;
    dict.set_item("warnings", rows.iter().map(|row| texts(&row.inference.notes)).collect::<Vec<_>>())?;
    dict.set_item("contradictions", rows.iter().map(|row| row.contradictions.clone()).collect::<Vec<_>>())?;
    dict.set_item("failed", rows.iter().map(|row| row.failed.map_or(0, Exit::code)).collect::<Vec<_>>())?;
    Ok(dict)
}
