//! Simulation-based calibration of the posterior: ranks of known structures among draws.

use super::case::Case;
use super::state::State;
use grainlab_console::{Failure, Format, Table, fixed, say};
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{EmtError, RankHistogram, SimulatedRanks, SimulationSettings, simulated_ranks};
use grainlab_node_kit::Exit;
use rayon::prelude::*;
use serde::Serialize;

/// Ranks of one quantity.
#[derive(Debug, Serialize)]
struct Ranked {
    model: &'static str,
    calibration: String,
    quantity: &'static str,
    simulations: u64,
    chi_square: f64,
    /// Probability of a larger chi-square for uniform ranks.
    p: f64,
    /// Number of ranks in each bin.
    ranks: Vec<u64>,
}

/// Simulates, infers and prints.
pub(super) fn run(
    state: &State,
    cases: &[Case],
    simulations: u32,
    seed: u64,
    format: Format,
) -> Result<Exit, Failure> {
    let [case] = cases else {
        return Err(Failure::usage("--rank-test is for one model and one calibration: add --model relaxed"));
    };
    if !case.model.states_likelihood() {
        return Err(Failure::usage(format!(
            "--rank-test: model {} states the error of its estimate, which changes with the structure, and no likelihood: ranks \
             among its draws are not uniform; use --model relaxed",
            case.model.name()
        )));
    }
    let conditions = state.observation(case).map_err(Failure::usage)?.conditions;
    let settings = SimulationSettings {
        conditions,
        grains: None,
        relative_error: state.relative_error.unwrap_or(0.0),
        moduli: [true; grainlab_emt::MODULI],
        seed,
    };
    let prior = case.own_prior();
    let of = |index| simulated_ranks(case.model, &case.calibration, &prior, &settings, index);
    let all: Vec<Result<SimulatedRanks, EmtError>> =
        (0..u64::from(simulations)).into_par_iter().map(of).collect();
    let mut histograms: Vec<(InferredQuantity, RankHistogram)> = Vec::new();
    for (quantity, share) in all.iter().flatten().flat_map(|ranks| &ranks.shares) {
        let known = histograms.iter().position(|(q, _)| q == quantity).unwrap_or_else(|| {
            histograms.push((*quantity, SimulatedRanks::histogram()));
            histograms.len() - 1
        });
        histograms[known].1.add(*share);
    }
    let faults = all.iter().filter_map(|r| r.as_ref().err());
    if let Some(first) = faults.clone().next() {
        if histograms.is_empty() {
            return Err(Failure::new(Exit::PhysicsInvalid, first));
        }
        say!("grainlab: {} of {simulations} simulations left out; the first: {first}", faults.count());
    }
    let ranked: Vec<Ranked> = histograms
        .iter()
        .map(|(quantity, histogram)| {
            let (chi_square, p) = histogram.uniformity();
            Ranked {
                model: case.model.name(),
                calibration: case.calibration.name().to_owned(),
                quantity: quantity.name(),
                simulations: histogram.counts().iter().sum(),
                chi_square,
                p,
                ranks: histogram.counts().to_vec(),
            }
        })
        .collect();
    let note = "  p: probability of ranks as uneven as these where the posterior is right\n";
    format.print(&ranked, || table(&ranked).csv(), || table(&ranked).text() + note)?;
    Ok(Exit::Done)
}

fn table(ranked: &[Ranked]) -> Table {
    let mut t = Table::new(["model", "quantity", "simulations", "chi-square", "p", "ranks"]);
    for r in ranked {
        let ranks: Vec<String> = r.ranks.iter().map(u64::to_string).collect();
        let numbers =
            [r.simulations.to_string(), fixed(Some(r.chi_square), 1), fixed(Some(r.p), 3), ranks.join(" ")];
        t.row([r.model, r.quantity].map(str::to_owned).into_iter().chain(numbers));
    }
    t
}
