//! The evidence of models: their marginal likelihoods of the same moduli.

use super::case::Case;
use super::state::State;
use grainlab_console::{Failure, Table, fixed};
use grainlab_emt::{EmtError, Evidence, Modulus, PosteriorSettings};
use serde::Serialize;

/// Number of points of the integration: an error of some 1e-3 in the logarithm.
pub(super) const POINTS: usize = 65_536;

/// Relative difference of observed moduli that is rounding.
const ROUNDING: f64 = 1e-12;

/// Prior odds of a model: `NAME=WEIGHT`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Odds {
    model: String,
    weight: f64,
}

impl std::str::FromStr for Odds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (model, weight) = text.split_once('=').ok_or("it must be NAME=WEIGHT, such as relaxed=2")?;
        let weight = weight.parse::<f64>().ok().filter(|w| *w > 0.0 && w.is_finite());
        let weight = weight.ok_or("the weight must be a number above 0")?;
        Ok(Self { model: model.to_owned(), weight })
    }
}

#[derive(Debug, Serialize)]
pub(super) struct OfModel {
    model: &'static str,
    calibration: String,
    /// The moduli that the evidence is of; models with other moduli are not comparable.
    moduli: Vec<&'static str>,
    /// ln of the marginal likelihood, for densities of moduli in MPa.
    ln_evidence: Option<f64>,
    /// Standard error of the integration.
    stderr: Option<f64>,
    prior_odds: f64,
    /// Posterior probability among the models with the same moduli; null if there is no other one.
    probability: Option<f64>,
    /// Why there is no evidence.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
}

type Found = (Vec<(Modulus, f64)>, Evidence);

pub(super) fn of_ways(
    state: &State,
    cases: &[Case],
    odds: &[Odds],
    seed: u64,
) -> Result<Vec<OfModel>, Failure> {
    if let Some(unknown) = odds.iter().find(|o| cases.iter().all(|case| case.model.name() != o.model)) {
        return Err(Failure::usage(format!("--prior-odds: no model {:?} is used", unknown.model)));
    }
    let found: Vec<Result<Found, EmtError>> = cases.iter().map(|case| of_case(state, case, seed)).collect();
    let weight = |case: &Case| odds.iter().find(|o| o.model == case.model.name()).map_or(1.0, |o| o.weight);
    let one = |(case, outcome): (&Case, &Result<Found, EmtError>)| {
        let (data, evidence) = outcome.as_ref().map_or((&[][..], None), |(d, e)| (d.as_slice(), Some(e)));
        // Each calibration of a model counts as a model of its own.
        let same = cases.iter().zip(&found).filter_map(|(w, o)| {
            let (d, e) = o.as_ref().ok()?;
            are_same(d, data).then_some((weight(w), e.ln))
        });
        let same: Vec<(f64, f64)> = same.collect();
        let probability = evidence
            .filter(|_| same.len() > 1)
            .map(|e| 1.0 / same.iter().map(|(w, ln)| w / weight(case) * (ln - e.ln).exp()).sum::<f64>());
        OfModel {
            model: case.model.name(),
            calibration: case.calibration.name().to_owned(),
            moduli: data.iter().map(|(m, _)| m.name()).collect(),
            ln_evidence: evidence.map(|e| e.ln),
            stderr: evidence.map(|e| e.stderr),
            prior_odds: weight(case),
            probability,
            reason: outcome.as_ref().err().map(ToString::to_string),
        }
    };
    Ok(cases.iter().zip(&found).map(one).collect())
}

fn are_same(a: &[(Modulus, f64)], b: &[(Modulus, f64)]) -> bool {
    let is_same =
        |((m, v), (n, w)): (&(Modulus, f64), &(Modulus, f64))| m == n && (v - w).abs() <= ROUNDING * v.abs();
    a.len() == b.len() && a.iter().zip(b).all(is_same)
}

fn of_case(state: &State, case: &Case, seed: u64) -> Result<Found, EmtError> {
    let posterior = state.posterior(case, PosteriorSettings { points: POINTS, seed })?;
    Ok((posterior.observed(), posterior.evidence()?))
}

pub(super) fn people(models: &[OfModel]) -> String {
    let mut t =
        Table::new(["model", "calibration", "evidence of", "ln evidence", "+-", "prior odds", "probability"]);
    let mut notes = String::new();
    for m in models {
        if let Some(reason) = &m.reason {
            notes += &format!("  no evidence of {}: {reason}\n", m.model);
            continue;
        }
        let labels = [m.model.to_owned(), m.calibration.clone(), m.moduli.join(" ")];
        let numbers =
            [fixed(m.ln_evidence, 3), fixed(m.stderr, 4), m.prior_odds.to_string(), fixed(m.probability, 4)];
        t.row(labels.into_iter().chain(numbers));
    }
    let sets: std::collections::BTreeSet<_> =
        models.iter().filter(|m| m.reason.is_none()).map(|m| &m.moduli).collect();
    if sets.len() > 1 {
        notes += "  evidences of different moduli are not comparable: give only the moduli that all of the models use\n";
    }
    let table = if sets.is_empty() { String::new() } else { t.text() };
    format!(
        "\n{table}{notes}  of densities of moduli in MPa, with the priors of --print-prior for each model\n"
    )
}
