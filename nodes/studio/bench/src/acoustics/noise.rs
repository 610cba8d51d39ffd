//! Microstructure inferred from noisy speeds and from the moduli of the analyzer, both by the inversion of
//! the node.

use super::args::Args;
use crate::packing::load_all;
use grainlab_acoustics::{Measurement, with_speed_noise};
use grainlab_console::{Failure, Table, exact, fixed};
use grainlab_core::Packing;
use grainlab_core::results::InferredQuantity;
use grainlab_core::results::PackingReport;
use grainlab_msgs::boundary::{MicrostructureReading, packing_report_message};
use grainlab_msgs::msg::Microstructure;
use grainlab_node_kit::Exit;
use grainlab_page::plot::{Bar, Bars};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// The model of the inversion: it needs no γ/Δ and includes the scatter between packings.
const MODEL: &str = "relaxed";

/// Half the width of a 95 % interval, standard deviations.
const INTERVAL: f64 = 1.96;

/// One level of noise, or the analyzer's moduli.
#[derive(Debug, Serialize)]
struct Row {
    /// Relative standard deviation of every speed; null for the analyzer's moduli.
    noise: Option<f64>,
    packings: usize,
    inferred: usize,
    /// By the name of the quantity.
    #[serde(flatten)]
    scores: BTreeMap<&'static str, Score>,
}

/// Inferred minus counted.
#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Score {
    rms: Option<f64>,
    bias: Option<f64>,
    /// Fraction within the 95 % interval.
    covered: Option<f64>,
}

/// Inferred minus counted values, also in units of their standard deviations, in the order of [`InferredQuantity::ALL`].
type Errors = [Option<(f64, f64)>; InferredQuantity::COUNT];

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let packings = load_all(&args.packing)?;
    let measured: Vec<_> =
        packings.iter().map(|packing| one(packing, args)).collect::<Result<Vec<_>, Failure>>()?;
    let rows: Vec<Row> = (0..=args.noise.len())
        .map(|level| {
            let errors: Vec<Errors> = measured.iter().flat_map(|m| m[level].clone()).collect();
            row(level.checked_sub(1).map(|k| args.noise[k]), packings.len(), &errors)
        })
        .collect();
    args.format.print(
        &rows,
        || table(&rows, exact).csv(),
        || table(&rows, |v| fixed(v, 4)).text() + "\n" + &bars(&rows).text(),
    )?;
    Ok(Exit::Done)
}

/// For one packing: the errors from the moduli of the analyzer, then those of every draw of every level.
fn one(packing: &Packing, args: &Args) -> Result<Vec<Vec<Errors>>, Failure> {
    let invalid = |e: &dyn std::fmt::Display| Failure::new(Exit::PhysicsInvalid, e.to_string());
    let settings = grainlab_acoustics::Settings { survey: args.survey.into(), ..Default::default() };
    let measurement = grainlab_acoustics::measure(packing, &settings).map_err(|e| invalid(&e))?;
    let truth =
        grainlab_micromechanics::analyze(packing, &Default::default()).map_err(|e| invalid(&e))?.report;
    let header = Default::default();
    let report = packing_report_message(Default::default(), &truth).map_err(|e| invalid(&e))?;
    let inversion = inversion();
    let by_moduli = grainlab_emt_inversion::microstructure_of_report(&report, &inversion);
    let by_moduli = by_moduli.ok_or_else(|| invalid(&"the packing has no stiffness"))?;
    let mut errors = vec![vec![compared(&answered(by_moduli)?, &truth)]];
    for noise in &args.noise {
        let draws = if *noise > 0.0 { args.draws } else { 1 };
        let draw = |seed: u32| {
            // Each packing has different draws.
            let seed = packing.step.wrapping_mul(u64::from(args.draws) + 1).wrapping_add(seed.into());
            let waves = with_speed_noise(&measurement.waves, *noise, seed);
            let noisy = Measurement { waves, ..measurement.clone() };
            let sent =
                grainlab_acoustic_probe::messages(&header, packing, &noisy).map_err(|e| invalid(&e))?;
            let found = grainlab_emt_inversion::microstructure_of_speeds(&sent.wave_speeds, &inversion);
            Ok(compared(&answered(found)?, &truth))
        };
        errors.push((1..=draws).into_par_iter().map(draw).collect::<Result<_, Failure>>()?);
    }
    Ok(errors)
}

fn answered(answer: grainlab_emt_inversion::Answer) -> Result<Microstructure, Failure> {
    answer.refused.map_or(Ok(answer.message), |e| Err(Failure::new(Exit::PhysicsInvalid, e.to_string())))
}

fn inversion() -> grainlab_emt_inversion::Settings {
    let models = Vec::from_iter(grainlab_emt::model(MODEL));
    grainlab_emt_inversion::Settings { models, ..Default::default() }
}

fn compared(found: &Microstructure, truth: &PackingReport) -> Errors {
    let reading = MicrostructureReading::try_from(found).ok();
    let inferred = reading.and_then(|r| r.estimates.into_iter().next());
    let of = |quantity: InferredQuantity| {
        let inferred = inferred.as_ref()?;
        let error = inferred.values[quantity]? - truth.counted(quantity)?;
        Some((error, error / inferred.sigma[quantity]?))
    };
    InferredQuantity::ALL.map(of)
}

fn row(noise: Option<f64>, packings: usize, errors: &[Errors]) -> Row {
    let score = |quantity: InferredQuantity| {
        let known: Vec<(f64, f64)> = errors.iter().filter_map(|e| e[quantity as usize]).collect();
        let mean = |of: fn(&(f64, f64)) -> f64| {
            (!known.is_empty()).then(|| known.iter().map(of).sum::<f64>() / known.len() as f64)
        };
        let score = Score {
            rms: mean(|e| e.0 * e.0).map(f64::sqrt),
            bias: mean(|e| e.0),
            covered: mean(|e| f64::from(u8::from(e.1.abs() <= INTERVAL))),
        };
        (quantity.name(), score)
    };
    let inferred = errors.iter().filter(|e| e.iter().any(Option::is_some)).count();
    Row { noise, packings, inferred, scores: InferredQuantity::countable().map(score).collect() }
}

/// The error of ε by level of noise.
fn bars(rows: &[Row]) -> Bars {
    let bar = |r: &Row| {
        let rms = r.scores[InferredQuantity::Eps.name()].rms?;
        let name = r.noise.map_or_else(|| "moduli".to_owned(), |n| format!("noise {n}"));
        Some(Bar { name, value: rms, text: format!("{rms:.4}"), ..Bar::default() })
    };
    let title = "rms error of eps".to_owned();
    Bars { title, from_zero: true, bars: rows.iter().filter_map(bar).collect(), ..Bars::default() }
}

fn table(rows: &[Row], number: impl Fn(Option<f64>) -> String) -> Table {
    let of = |q: InferredQuantity| [format!("{} rms", q.text()), "bias".to_owned(), "in 95 %".to_owned()];
    let head = ["speed noise", "packings", "inferred"].map(str::to_owned);
    let mut t = Table::new(head.into_iter().chain(InferredQuantity::countable().flat_map(of)));
    for r in rows {
        let head = [
            r.noise.map_or_else(|| "moduli".to_owned(), |n| n.to_string()),
            r.packings.to_string(),
            r.inferred.to_string(),
        ];
        let score = |q: InferredQuantity| {
            let s = &r.scores[q.name()];
            [number(s.rms), number(s.bias), number(s.covered)]
        };
        t.row(head.into_iter().chain(InferredQuantity::countable().flat_map(score)));
    }
    t
}
