//! Draws from the posterior of one model, into a file.

use super::state::State;
use super::way::Way;
use grainlab_console::{Failure, json, say};
use grainlab_emt::{Draws, EmtError, Posterior, PosteriorSettings};
use grainlab_node_kit::Exit;
use grainlab_results::posterior_draws;
use serde_json::{Map, Value, json};
use std::path::Path;

/// How many draws.
#[derive(Clone, Copy, Debug)]
pub(super) struct Number {
    pub(super) chains: usize,
    pub(super) per_chain: usize,
    pub(super) seed: u64,
}

/// Writes the draws of the only way as CSV or as JSON, by the end of the file's name.
pub(super) fn write(state: &State, ways: &[Way], number: Number, path: &Path) -> Result<(), Failure> {
    let name = path.display();
    let [way] = ways else {
        return Err(Failure::usage("--draws is for one model and one calibration: add --model relaxed"));
    };
    let end = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if !matches!(end, "csv" | "json") {
        return Err(Failure::usage(format!("{name}: draws are written as .csv or .json (for ArviZ)")));
    }
    let Number { chains, per_chain, seed } = number;
    let draws = drawn(state, way, chains * per_chain, seed).map_err(|e| {
        let exit = if e.is_input_error() { Exit::Usage } else { Exit::PhysicsInvalid };
        Failure::new(exit, format!("{}: {e}", way.model.name()))
    })?;
    let text = match end {
        "csv" => posterior_draws::csv(&draws, chains),
        _ => json(&posterior_draws::inference_data(&draws, chains, attributes(way, &draws, seed)))?,
    };
    grainlab_console::write_whole(path, text).map_err(|e| Failure::failed(format!("{name}: {e}")))?;
    say!(
        "grainlab: {name}: {} independent draws of model {}, {:.0} % of the proposals accepted",
        draws.draws.len(),
        way.model.name(),
        100.0 * draws.acceptance
    );
    Ok(())
}

fn drawn(state: &State, way: &Way, count: usize, seed: u64) -> Result<Draws, EmtError> {
    let prior = way.prior.as_deref().cloned().unwrap_or_default();
    let settings = PosteriorSettings { seed, ..PosteriorSettings::default() };
    let observation = state.observation(way)?;
    // What has no estimate has no posterior worth drawing from: it is far outside the packings of the calibration.
    way.model.infer(&observation, &way.calibration)?;
    Posterior::new(way.model, &observation, &way.calibration, &prior, settings)?.draws(count)
}

fn attributes(way: &Way, draws: &Draws, seed: u64) -> Map<String, Value> {
    let attributes = [
        ("inference_library", json!("grainlab")),
        ("inference_library_version", json!(env!("CARGO_PKG_VERSION"))),
        ("model", json!(way.model.name())),
        ("calibration", json!(way.calibration.name())),
        ("sampler", json!("rejection: independent draws")),
        ("acceptance", json!(draws.acceptance)),
        ("envelope_raised", json!(draws.raised)),
        ("seed", json!(seed)),
    ];
    attributes.map(|(key, value)| (key.to_owned(), value)).into_iter().collect()
}
