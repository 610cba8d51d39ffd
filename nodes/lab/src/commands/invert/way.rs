//! The ways in which each state is inverted: a model, and the γ/Δ that it is fed with.

use crate::failure::Failure;
use emt::{GammaSource, Model};

/// Which γ/Δ feeds the models that use one.
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
    /// None: 0
    Zero,
    /// Each of total, elastic, contact and zero, one after the other
    All,
}

/// One way to an estimate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub(super) model: &'static dyn Model,
    /// `None` takes what is given, else what the paper's models take of what is measured.
    pub(super) gamma: Option<GammaSource>,
}

/// Every model, or the one of this name, with every γ/Δ asked for.
pub(super) fn ways(model: Option<&str>, gamma: Option<GammaChoice>) -> Result<Vec<Way>, Failure> {
    let models = match model {
        None => emt::models().to_vec(),
        Some(name) => vec![emt::model(name).ok_or_else(|| no_model(name))?],
    };
    let gammas: &[Option<GammaSource>] = match gamma {
        None => &[None],
        Some(GammaChoice::Given) => &[Some(GammaSource::Given)],
        Some(GammaChoice::Total) => &[Some(GammaSource::Total)],
        Some(GammaChoice::Elastic) => &[Some(GammaSource::Elastic)],
        Some(GammaChoice::Contact) => &[Some(GammaSource::Contact)],
        Some(GammaChoice::Zero) => &[Some(GammaSource::Zero)],
        Some(GammaChoice::All) => &[
            Some(GammaSource::Total),
            Some(GammaSource::Elastic),
            Some(GammaSource::Contact),
            Some(GammaSource::Zero),
        ],
    };
    let of = |model: &'static dyn Model| {
        let gammas = if model.uses_gamma() { gammas } else { &[None] };
        gammas.iter().map(move |gamma| Way { model, gamma: *gamma })
    };
    Ok(models.into_iter().flat_map(of).collect())
}

fn no_model(name: &str) -> Failure {
    let known: Vec<&str> = emt::models().iter().map(|m| m.name()).collect();
    Failure::usage(format!("no model {name:?}; there are: {}", known.join(", ")))
}
