//! From moduli to microstructure.

use crate::{error, posterior};
use grainlab_core::Material;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{
    Calibration, Conditions, EmtError, Estimate, Measured, Model, Moduli, Modulus, Observation, Posterior,
    PosteriorSettings, Prior, StrainRatio,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Names of the models, the one with the smallest error on held-out packings first.
#[pyfunction]
pub(crate) fn models() -> Vec<&'static str> {
    grainlab_emt::models().iter().map(|m| m.name()).collect()
}

/// Infers coordination and anisotropy from moduli.
#[pyfunction]
#[pyo3(signature = (*, pressure, g12=None, g13=None, theta=None, c11=None, c33=None, c13=None, phi=None, gamma=None,
    stress_ratio=None, size_spread=None, error=0.01, shear_modulus=None, poisson_ratio=None, pressure_sigma=0.0,
    stress_ratio_sigma=0.0, shear_modulus_sigma=0.0, poisson_ratio_sigma=0.0, model="relaxed", prior=None, draws=None, seed=0))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn invert<'py>(
    py: Python<'py>,
    pressure: f64,
    g12: Option<f64>,
    g13: Option<f64>,
    theta: Option<f64>,
    c11: Option<f64>,
    c33: Option<f64>,
    c13: Option<f64>,
    phi: Option<f64>,
    gamma: Option<f64>,
    stress_ratio: Option<f64>,
    size_spread: Option<f64>,
    error: f64,
    shear_modulus: Option<f64>,
    poisson_ratio: Option<f64>,
    pressure_sigma: f64,
    stress_ratio_sigma: f64,
    shear_modulus_sigma: f64,
    poisson_ratio_sigma: f64,
    model: &str,
    prior: Option<&str>,
    draws: Option<usize>,
    seed: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let known = grainlab_emt::model(model).ok_or_else(|| {
        PyValueError::new_err(format!("model is {model:?}; it must be one of: {}", models().join(", ")))
    })?;
    if !(error >= 0.0 && error.is_finite()) {
        return Err(PyValueError::new_err(format!(
            "error is {error}; it must be a relative error, 0 or more"
        )));
    }
    let given = [g12, g13, theta, c11, c33, c13];
    let moduli = Modulus::ALL.into_iter().zip(given);
    let moduli = moduli.fold(Moduli::NONE, |all, (m, value)| value.map_or(all, |v| all.with(m, v)));
    let calibration = known.default_calibration();
    let mut conditions = Conditions::at(pressure);
    if stress_ratio.is_none() && stress_ratio_sigma != 0.0 {
        return Err(PyValueError::new_err("stress_ratio_sigma is given without stress_ratio"));
    }
    conditions.pressure.stddev = pressure_sigma;
    conditions.solid_fraction = phi.map(Measured::exact);
    conditions.stress_ratio = stress_ratio.map(|value| Measured { value, stddev: stress_ratio_sigma });
    (conditions.shear_modulus_stddev, conditions.poisson_ratio_stddev) =
        (shear_modulus_sigma, poisson_ratio_sigma);
    conditions.size_spread = size_spread;
    conditions.gamma = gamma.map_or(StrainRatio::ZERO, StrainRatio::given);
    let own = calibration.material();
    let has_error = shear_modulus_sigma != 0.0 || poisson_ratio_sigma != 0.0;
    conditions.material =
        (shear_modulus.is_some() || poisson_ratio.is_some() || has_error).then(|| Material {
            shear_modulus: shear_modulus.unwrap_or(own.shear_modulus),
            poisson_ratio: poisson_ratio.unwrap_or(own.poisson_ratio),
            ..*own
        });
    let observation = Observation::new(moduli, conditions).with_relative_error(error);
    let prior = prior.map(|text| prior_of(known, calibration, text)).transpose()?;
    let computed = || {
        let mut estimate = known.infer(&observation, calibration)?;
        if let Some(prior) = &prior {
            estimate = estimate.with_prior(prior)?.within(&known.prior_domain(calibration))?;
        }
        let Some(each) = draws else { return Ok((estimate, None)) };
        let settings = PosteriorSettings { seed, ..PosteriorSettings::default() };
        let prior = prior.as_ref().cloned().unwrap_or_default();
        let posterior = Posterior::new(known, &observation, calibration, &prior, settings)?;
        Ok((estimate, Some(posterior.draws(posterior::CHAINS * each)?)))
    };
    let (estimate, drawn) = py.detach(computed).map_err(|e: EmtError| error::physics(e))?;
    let found = described(py, &estimate)?;
    if let Some(drawn) = drawn {
        found.set_item("draws", posterior::groups(py, &drawn)?)?;
    }
    Ok(found)
}

/// A prior of quantities that the model infers.
fn prior_of(model: &dyn Model, calibration: &Calibration, text: &str) -> PyResult<Prior> {
    let invalid = |e: String| PyValueError::new_err(format!("prior: {e}"));
    let prior = Prior::parse(text).map_err(|e| invalid(e.to_string()))?;
    let known = model.quantities(calibration);
    if let Some(other) = prior.quantities().find(|q| !known.contains(q)) {
        return Err(invalid(format!("[{other}]: model {} does not infer it", model.name())));
    }
    prior.completed(&model.prior_domain(calibration)).map_err(|e| invalid(e.to_string()))?;
    Ok(prior)
}

/// By key: value, `KEY_sigma` and `KEY_interval`; the model, its status and warnings.
fn described<'py>(py: Python<'py>, estimate: &Estimate) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("model", estimate.model)?;
    dict.set_item("calibration", &estimate.calibration)?;
    for quantity in InferredQuantity::ALL {
        let name = quantity.name();
        dict.set_item(name, estimate.structure.get(quantity))?;
        dict.set_item(format!("{name}_sigma"), estimate.stddev(quantity))?;
        dict.set_item(
            format!("{name}_interval"),
            estimate.interval(quantity).map(|[low, high]| (low, high)),
        )?;
    }
    dict.set_item("status", estimate.status.name())?;
    let warnings: Vec<String> = estimate.warnings.iter().map(ToString::to_string).collect();
    dict.set_item("warnings", warnings)?;
    Ok(dict)
}
