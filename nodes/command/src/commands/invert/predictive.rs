//! The observed moduli against what each model predicts with its posterior.

use super::case::Case;
use super::state::State;
use grainlab_console::{Table, fixed, three_digits};
use grainlab_emt::{Check, EmtError, Inversion, PosteriorSettings};
use rayon::prelude::*;
use serde::Serialize;

#[derive(Debug, Serialize)]
pub(super) struct Predictive {
    model: &'static str,
    calibration: String,
    /// Probability of a chi-square as large as the observed one, under the posterior of all moduli.
    chi_square: f64,
    /// True if the observation is unlike the predictions of the model.
    unlikely: bool,
    moduli: Vec<OfModulus>,
}

#[derive(Debug, Serialize)]
struct OfModulus {
    modulus: &'static str,
    observed_pa: f64,
    /// Two-sided, under the posterior of all moduli.
    predictive: f64,
    /// Two-sided, under the posterior of the other moduli.
    left_out: Option<f64>,
}

/// Predictions of the models that state a likelihood. Improbable moduli are part of the status of the answer.
pub(super) fn of_ways(
    state: &State,
    outcomes: &mut [Result<Inversion, EmtError>],
    cases: &[Case],
) -> Vec<Predictive> {
    let of_case = |(case, outcome): (&Case, &mut Result<Inversion, EmtError>)| {
        let check = state.posterior(case, PosteriorSettings::default()).ok()?.check();
        if let Ok(estimate) = outcome {
            check.apply(estimate);
        }
        Some(view(case, &check))
    };
    cases.par_iter().zip(outcomes).filter_map(of_case).collect()
}

fn view(case: &Case, check: &Check) -> Predictive {
    let one = |m: &grainlab_emt::ModulusCheck| OfModulus {
        modulus: m.modulus.name(),
        observed_pa: m.observed,
        predictive: m.predictive,
        left_out: m.left_out,
    };
    Predictive {
        model: case.model.name(),
        calibration: case.calibration.name().to_owned(),
        chi_square: check.chi_square,
        unlikely: check.is_unlikely(),
        moduli: check.moduli.iter().map(one).collect(),
    }
}

pub(super) fn people(all: &[Predictive]) -> String {
    if all.is_empty() {
        return String::new();
    }
    let mut t = Table::new(["model", "modulus", "observed/MPa", "p predicted", "p left out"]);
    let mut notes = String::new();
    for p in all {
        for m in &p.moduli {
            let numbers = [
                three_digits(Some(m.observed_pa / 1e6), 2),
                probability(Some(m.predictive)),
                probability(m.left_out),
            ];
            t.row([p.model, m.modulus].map(str::to_owned).into_iter().chain(numbers));
        }
        let text = format!("{}: chi-square of all moduli: p = {}", p.model, probability(Some(p.chi_square)));
        notes += &format!("  {text}\n");
    }
    notes += "  p: probability of a modulus as extreme as the observed one, with the posterior of all moduli, and of the others\n";
    format!("\n{}{notes}", t.text())
}

fn probability(p: Option<f64>) -> String {
    match p {
        Some(p) if p < 1e-3 => format!("{p:.0e}"),
        p => fixed(p, 3),
    }
}
