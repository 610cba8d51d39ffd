//! The cases by which a state is inverted: a model, its constants, and its γ/Δ.

use super::calibrations;
use grainlab_console::Failure;
use grainlab_emt::{Calibration, Model, Prior, StrainRatioSource};
use std::sync::Arc;

/// Choices of γ/Δ for the models that use one: that of the column gamma_over_delta, those of g_total, g_elastic and g_contact, 0,
/// and each of the last four.
pub(super) const GAMMAS: [&str; 6] = ["given", "total", "elastic", "contact", "zero", "all"];

#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) model: &'static dyn Model,
    pub(super) calibration: Arc<Calibration>,
    /// `None`: the one given, else that of the paper's models.
    pub(super) gamma: Option<StrainRatioSource>,
    /// Prior of the quantities in the file of the user; `None`: none.
    pub(super) prior: Option<Arc<Prior>>,
}

impl Case {
    /// The prior of the user; without one an empty prior.
    pub(super) fn own_prior(&self) -> Prior {
        self.prior.as_deref().cloned().unwrap_or_default()
    }
}

/// Every model, or those of these names, with every calibration and every γ/Δ set.
pub(super) fn cases(
    models: &[String],
    calibrations: &[String],
    gamma: Option<&str>,
) -> Result<Vec<Case>, Failure> {
    let named = models.iter().map(|name| grainlab_emt::model(name).ok_or_else(|| no_model(name)));
    let named = named.collect::<Result<Vec<_>, _>>()?;
    for (flag, given) in [("--model", models), ("--calibration", calibrations)] {
        if let Some((i, twice)) = given.iter().enumerate().find(|(i, name)| given[..*i].contains(name)) {
            return Err(Failure::usage(format!(
                "{flag} {twice} is given twice, the second time as number {}",
                i + 1
            )));
        }
    }
    let models = if named.is_empty() { grainlab_emt::models().to_vec() } else { named };
    let choices = calibrations.iter().map(|name| calibrations::named(name)).collect::<Result<Vec<_>, _>>()?;
    use StrainRatioSource::{Contact, Elastic, Given, Total, Zero};
    let sources = [Given, Total, Elastic, Contact, Zero].into_iter();
    let gammas: Vec<Option<StrainRatioSource>> = match gamma {
        None => vec![None],
        Some("all") => sources.skip(1).map(Some).collect(),
        Some(name) => sources.filter(|source| source.name() == name).map(Some).collect(),
    };
    let mut cases = Vec::new();
    for model in models {
        let gammas = if model.uses_gamma() { gammas.as_slice() } else { &[None] };
        for choice in &choices {
            let calibration = choice.clone().unwrap_or_else(|| Arc::new(model.default_calibration().clone()));
            let with =
                |gamma: &_| Case { model, calibration: Arc::clone(&calibration), gamma: *gamma, prior: None };
            cases.extend(gammas.iter().map(with));
        }
    }
    Ok(cases)
}

fn no_model(name: &str) -> Failure {
    let all = grainlab_emt::models().iter().copied().chain([grainlab_emt::free_contact()]);
    let known: Vec<&str> = all.map(|m| m.name()).collect();
    Failure::usage(format!("no model {name:?}; there are: {}", known.join(", ")))
}
