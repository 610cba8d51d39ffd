//! The cases by which a state is inverted: a model, its constants, and its γ/Δ.

use super::calibrations;
use grainlab_console::Failure;
use grainlab_emt::{Calibration, Model, Prior, StrainRatioSource};
use std::sync::Arc;

/// The γ/Δ of the models that use one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum GammaChoice {
    /// The column gamma_over_delta, or --gamma-over-delta
    Given,
    /// The column g_total: of the strain since the reference state
    Total,
    /// The column g_elastic: of an isotropic stress increment
    Elastic,
    /// The column g_contact: of the overlaps of the contacts
    Contact,
    /// None: taken as 0
    Zero,
    /// Each of total, elastic, contact and zero
    All,
}

/// One case to invert by: a model, its calibration, γ/Δ and prior.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) model: &'static dyn Model,
    pub(super) calibration: Arc<Calibration>,
    /// `None`: the one given, else that of the paper's models.
    pub(super) gamma: Option<StrainRatioSource>,
    /// Prior of the quantities in the file of the user; `None`: none.
    pub(super) prior: Option<Arc<Prior>>,
}

/// Every model, or those of these names, with every calibration and every γ/Δ set.
pub(super) fn cases(
    models: &[String],
    calibrations: &[String],
    gamma: Option<GammaChoice>,
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
    let gammas: &[Option<StrainRatioSource>] = match gamma {
        None => &[None],
        Some(GammaChoice::Given) => &[Some(Given)],
        Some(GammaChoice::Total) => &[Some(Total)],
        Some(GammaChoice::Elastic) => &[Some(Elastic)],
        Some(GammaChoice::Contact) => &[Some(Contact)],
        Some(GammaChoice::Zero) => &[Some(Zero)],
        Some(GammaChoice::All) => &[Some(Total), Some(Elastic), Some(Contact), Some(Zero)],
    };
    let mut cases = Vec::new();
    for model in models {
        let gammas = if model.uses_gamma() { gammas } else { &[None] };
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
    let known: Vec<&str> = grainlab_emt::models().iter().map(|m| m.name()).collect();
    Failure::usage(format!("no model {name:?}; there are: {}", known.join(", ")))
}
