//! Draws from the posterior of one model, into a file.

use super::case::Case;
use super::state::State;
use grainlab_console::{Failure, json, say};
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{Draws, EmtError, Inversion, PosteriorSettings};
use grainlab_node_kit::Exit;
use grainlab_results::posterior_draws;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Ratio of the scatter of the draws to that of the estimate, or its inverse, from which the two are said to differ.
const UNLIKE: f64 = 1.15;

#[derive(Clone, Copy, Debug)]
pub(super) struct Number {
    pub(super) chains: usize,
    pub(super) per_chain: usize,
    pub(super) seed: u64,
}

/// Writes the draws of the only case as CSV or as JSON, by the end of the file's name.
pub(super) fn write(state: &State, cases: &[Case], number: Number, path: &Path) -> Result<(), Failure> {
    let name = path.display();
    let [case] = cases else {
        return Err(Failure::usage("--draws is for one model and one calibration: add --model relaxed"));
    };
    let end = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if !matches!(end, "csv" | "json") {
        return Err(Failure::usage(format!("{name}: draws are written as .csv or .json (for ArviZ)")));
    }
    let Number { chains, per_chain, seed } = number;
    let (draws, estimate) = drawn(state, case, chains * per_chain, seed).map_err(|e| {
        let exit = if e.is_input_error() { Exit::Usage } else { Exit::PhysicsInvalid };
        Failure::new(exit, format!("{}: {e}", case.model.name()))
    })?;
    let text = match end {
        "csv" => posterior_draws::csv(&draws, chains),
        _ => json(&posterior_draws::inference_data(&draws, chains, attributes(case, &draws, seed)))?,
    };
    grainlab_console::write_whole(path, text)?;
    say!(
        "grainlab: {name}: {} independent draws of model {}, {:.0} % of the proposals accepted",
        draws.draws.len(),
        case.model.name(),
        100.0 * draws.acceptance
    );
    unlike(&draws, &estimate, case.prior.is_some()).for_each(|line| say!("grainlab: {line}"));
    Ok(())
}

pub(super) fn unlike(draws: &Draws, estimate: &Inversion, has_prior: bool) -> impl Iterator<Item = String> {
    draws.quantities.iter().filter_map(move |quantity| unlike_of(draws, estimate, *quantity, has_prior))
}

fn unlike_of(
    draws: &Draws,
    estimate: &Inversion,
    quantity: InferredQuantity,
    has_prior: bool,
) -> Option<String> {
    let stated = estimate.stddev(quantity)?;
    let values: Vec<f64> = draws.draws.iter().filter_map(|draw| draw.structure.get(quantity)).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let scatter = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
    let which = if has_prior {
        "with this prior, rely on the draws"
    } else {
        "on packings that taught nothing the stated 95 % intervals hold"
    };
    (!(1.0 / UNLIKE..UNLIKE).contains(&(scatter / stated))).then(|| {
        format!(
            "the draws of {} scatter by {scatter:.4}, and the estimate states {stated:.4}: the posterior is not normal; {which}",
            quantity.name()
        )
    })
}

pub(super) fn drawn(
    state: &State,
    case: &Case,
    count: usize,
    seed: u64,
) -> Result<(Draws, Inversion), EmtError> {
    let settings = PosteriorSettings { seed, ..PosteriorSettings::default() };
    // A state without an estimate has no posterior worth drawing from: it is far outside the packings of the calibration.
    let estimate = case.model.infer(&state.observation(case)?, &case.calibration)?;
    // With a prior of its own, a draw has it, too.
    Ok((state.posterior(case, settings)?.draws(count)?, state.infer(case).unwrap_or(estimate)))
}

fn attributes(case: &Case, draws: &Draws, seed: u64) -> Map<String, Value> {
    let attributes = [
        ("inference_library", json!("grainlab")),
        ("inference_library_version", json!(env!("CARGO_PKG_VERSION"))),
        ("model", json!(case.model.name())),
        ("calibration", json!(case.calibration.name())),
        ("sampler", json!("rejection: independent draws")),
        ("acceptance", json!(draws.acceptance)),
        ("envelope_raised", json!(draws.raised)),
        ("seed", json!(seed)),
    ];
    attributes.map(|(key, value)| (key.to_owned(), value)).into_iter().collect()
}
