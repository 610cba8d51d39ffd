//! Contribution of each datum to the uncertainty of each unknown, and the parts due to data and model.

use super::case::Case;
use grainlab_console::{Table, fixed};
use grainlab_core::results::{INFERENCE_INPUTS, InferredQuantity, MicrostructureCovariance};
use grainlab_emt::{EmtError, Inversion};
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Debug, Serialize)]
pub(super) struct Explained {
    model: &'static str,
    calibration: String,
    gamma_over_delta_source: Option<&'static str>,
    quantity: &'static str,
    value: Option<f64>,
    sigma: Option<f64>,
    /// Parts of sigma: from the errors of the data, and from the model.
    sigma_data: Option<f64>,
    sigma_model: Option<f64>,
    /// From the width of the prior.
    #[serde(skip_serializing_if = "Option::is_none")]
    sigma_prior: Option<f64>,
    /// Contribution of each input to the variance from the errors of the data, as fractions.
    information: BTreeMap<&'static str, f64>,
    condition_number: Option<f64>,
}

pub(super) fn explained(outcomes: &[Result<Inversion, EmtError>], cases: &[Case]) -> Vec<Explained> {
    let found = outcomes.iter().zip(cases).filter_map(|(o, case)| Some((o.as_ref().ok()?, case)));
    found.flat_map(|(estimate, case)| of_estimate(estimate, case)).collect()
}

fn of_estimate(estimate: &Inversion, case: &Case) -> Vec<Explained> {
    let condition_number = estimate.condition_number();
    let determined = InferredQuantity::ALL.into_iter().filter(|q| estimate.structure.get(*q).is_some());
    let one = |quantity: InferredQuantity| {
        let i = quantity as usize;
        let part = |c: Option<MicrostructureCovariance>| c.map(|c| c[(i, i)].max(0.0).sqrt());
        let shares = estimate.information(quantity).unwrap_or_default();
        Explained {
            model: case.model.name(),
            calibration: estimate.calibration.clone(),
            gamma_over_delta_source: estimate.gamma.map(|g| g.source.name()),
            quantity: quantity.name(),
            value: estimate.structure.get(quantity),
            sigma: estimate.stddev(quantity),
            sigma_data: part(estimate.data_covariance),
            sigma_model: part(estimate.model_covariance),
            sigma_prior: part(estimate.prior_covariance),
            information: INFERENCE_INPUTS.into_iter().zip(shares).filter(|(_, s)| *s != 0.0).collect(),
            condition_number,
        }
    };
    determined.map(one).collect()
}

pub(super) fn people(explained: &[Explained]) -> String {
    let has_a_say = |name: &&&str| explained.iter().any(|e| e.information.contains_key(**name));
    let inputs: Vec<&str> = INFERENCE_INPUTS.iter().filter(has_a_say).copied().collect();
    let columns = ["model", "inferred", "value", "sigma", "from data", "from model", "from prior"];
    let mut t = Table::new(columns.into_iter().chain(inputs.iter().copied()).chain(["condition"]));
    for e in explained {
        let digits = if e.quantity.starts_with("eps") { 4 } else { 3 };
        let numbers =
            [e.value, e.sigma, e.sigma_data, e.sigma_model, e.sigma_prior].map(|v| fixed(v, digits));
        let share = |name: &&str| {
            let share = e.information.get(*name).map(|s| format!("{:.0} %", 100.0 * s));
            share.unwrap_or_else(|| "-".to_owned())
        };
        let labels = [e.model, e.quantity].map(str::to_owned);
        let shares = inputs.iter().map(share);
        t.row(labels.into_iter().chain(numbers).chain(shares).chain([fixed(e.condition_number, 1)]));
    }
    let errors_known = explained.iter().any(|e| e.sigma_data.is_some());
    let of_what = if errors_known {
        "share of each datum in the variance that the errors of the data cause"
    } else {
        "errors of the data are not known: shares are those of equal relative errors"
    };
    format!("\n{}  {of_what}\n", t.without_empty_columns().text())
}
