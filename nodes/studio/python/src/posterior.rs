//! Draws from a posterior as the groups of ArviZ's InferenceData.

use grainlab_emt::{Draw, Draws};
use numpy::IntoPyArray;
use numpy::ndarray::{Array2, Array3};
use pyo3::prelude::*;
use pyo3::types::PyDict;

pub(crate) const CHAINS: usize = 4;

/// Keyword arguments of `arviz.from_dict`: arrays of shape (chains, draws) or (chains, draws, moduli).
pub(crate) fn groups<'py>(py: Python<'py>, draws: &Draws) -> PyResult<Bound<'py, PyDict>> {
    let each = draws.draws.len() / CHAINS;
    let draw = |chain: usize, number: usize| &draws.draws[chain * each + number];
    let scalars = |value: &dyn Fn(&Draw) -> f64| {
        Array2::from_shape_fn((CHAINS, each), |(chain, number)| value(draw(chain, number))).into_pyarray(py)
    };
    let of_moduli = |value: &dyn Fn(&Draw) -> &[f64]| -> PyResult<Bound<'py, PyDict>> {
        let shape = (CHAINS, each, draws.observed.len());
        let array = Array3::from_shape_fn(shape, |(chain, number, i)| value(draw(chain, number))[i]);
        one(py, "moduli", array.into_pyarray(py))
    };
    let posterior = PyDict::new(py);
    for quantity in &draws.quantities {
        let values = scalars(&|draw| draw.structure.get(*quantity).unwrap_or(f64::NAN));
        posterior.set_item(quantity.name(), values)?;
    }
    let stats = PyDict::new(py);
    stats.set_item("lp", scalars(&|draw| draw.ln_likelihood + draw.ln_prior))?;
    stats.set_item("log_likelihood", scalars(&|draw| draw.ln_likelihood))?;
    stats.set_item("log_prior", scalars(&|draw| draw.ln_prior))?;
    let observed: Vec<f64> = draws.observed.iter().map(|(_, value)| *value).collect();
    let names: Vec<&str> = draws.observed.iter().map(|(modulus, _)| modulus.name()).collect();
    let groups = PyDict::new(py);
    groups.set_item("posterior", posterior)?;
    groups.set_item("sample_stats", stats)?;
    groups.set_item("log_likelihood", of_moduli(&|draw| &draw.ln_likelihood_by_modulus)?)?;
    groups.set_item("posterior_predictive", of_moduli(&|draw| &draw.replicated)?)?;
    groups.set_item("observed_data", one(py, "moduli", observed.into_pyarray(py))?)?;
    groups.set_item("coords", one(py, "modulus", names)?)?;
    groups.set_item("dims", one(py, "moduli", ["modulus"])?)?;
    Ok(groups)
}

fn one<'py>(py: Python<'py>, key: &str, value: impl IntoPyObject<'py>) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item(key, value)?;
    Ok(dict)
}
