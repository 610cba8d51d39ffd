//! `grainlab bench stiffness`: what all 21 elastic constants of a packing cost, and how wrong they are.

use super::cpu_time::thread_seconds;
use super::numbers::{median, rounded};
use super::packing::{copies, load, repeated};
use crate::failure::Failure;
use crate::output::{Format, Table, exact, json, print, say};
use dem::{Engine, Setting, TimeStep};
use grains::{Mat3, Packing, Stiffness};
use micro::{Network, Probe, stiffness};
use node_kit::Exit;
use serde::Serialize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
All times are CPU seconds of one thread, network included, medians over the repetitions; errors are the largest of the 36
entries over C11, against the frozen network solved to 1e-13. Without --packing it is one of 2,000 grains made by LAMMPS.
Copies of a packing converge more easily than a packing of that size; their rows say so.

Examples:
  A packing of one's own, and the probe beside the network:
    grainlab bench stiffness --packing recordings/runs/s2-1-1 --amplitudes 1e-6,1e-7
  How the cost grows:
    grainlab bench stiffness --grains 2000,16000 --tolerances 1e-8 --format json";

/// Residual of the solve that others are measured by: the smallest that a solve is asked for.
const CONVERGED: f64 = 1e-13;

/// What to measure, and how.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Packing to measure: CSV with its sidecar, LAMMPS data or dump, or a recording; also as .gz
    #[arg(long, value_name = "FILE")]
    packing: Option<PathBuf>,
    /// Sizes: cubes of the packing's own number of grains
    #[arg(long, value_name = "N", value_delimiter = ',')]
    grains: Vec<u64>,
    /// Relative residuals at which the solve of the frozen network stops
    #[arg(long, value_name = "REL", value_delimiter = ',', default_value = "1e-2,1e-4,1e-6,1e-8,1e-10,1e-12", value_parser = tolerance)]
    tolerances: Vec<f64>,
    /// Strains of explicit probes, which take far longer; their stiffness is that of the forces, sliding included
    #[arg(long, value_name = "STRAIN", value_delimiter = ',', value_parser = amplitude)]
    amplitudes: Vec<f64>,
    /// Repetitions of every case but the probes
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repetitions: u32,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

fn tolerance(text: &str) -> Result<f64, String> {
    between(text, CONVERGED, 1e-2)
}

fn amplitude(text: &str) -> Result<f64, String> {
    between(text, 1e-12, 1e-2)
}

fn between(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let value = text.parse().ok().filter(|v| (least..=most).contains(v));
    value.ok_or_else(|| format!("a number from {least:e} to {most:e}"))
}

/// One method on one packing.
#[derive(Debug, Serialize)]
struct Row {
    grains: usize,
    /// Whether the packing was repeated to come to this size.
    replicated: bool,
    coordination: f64,
    method: &'static str,
    /// Relative residual of a solve, strain of a probe.
    setting: Option<f64>,
    /// CPU time.
    seconds: f64,
    /// Of the solve, or solver steps of the probe.
    iterations: Option<u32>,
    /// Largest entry of the difference over C11.
    error: f64,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let packing = load(args.packing.as_deref())?;
    let sizes = if args.grains.is_empty() { vec![1] } else { copies(packing.grains(), &args.grains)? };
    let mut rows = Vec::new();
    for copies in sizes {
        let packing = if copies == 1 { packing.clone() } else { replicated(&packing, copies)? };
        say!("grainlab: {} grains, {} contacts", packing.grains(), packing.contacts.len());
        rows.extend(measured(&packing, copies > 1, args)?);
    }
    print(&match args.format {
        Format::Json => json(&rows)?,
        Format::Csv => table(&rows, exact).csv(),
        Format::Table => table(&rows, rounded).text(),
    })?;
    Ok(Exit::Done)
}

fn measured(packing: &Packing, replicated: bool, args: &Args) -> Result<Vec<Row>, Failure> {
    let converged = solved(packing, CONVERGED)?.0;
    let coordination = 2.0 * packing.contacts.len() as f64 / packing.grains() as f64;
    let row = |method, setting, seconds, iterations, found: &Stiffness| Row {
        grains: packing.grains(),
        replicated,
        coordination,
        method,
        setting,
        seconds,
        iterations,
        error: (found.0 - converged.0).amax() / converged.0[(0, 0)],
    };
    let (seconds, affine) = timed(args.repetitions, || Ok(Stiffness(network(packing)?.stiffness(None).0)))?;
    let mut rows = vec![row("affine", None, seconds, None, &affine)];
    for tolerance in &args.tolerances {
        let (seconds, (found, iterations)) = timed(args.repetitions, || solved(packing, *tolerance))?;
        rows.push(row("network", Some(*tolerance), seconds, Some(iterations), &found));
    }
    for amplitude in &args.amplitudes {
        let settings = Probe { amplitude: *amplitude, ..Probe::default() };
        let probe = || micro::probe(packing, &settings).map_err(invalid);
        let (seconds, found) = timed(1, probe)?;
        let steps = found.rest_steps + found.columns.iter().map(|c| c.steps).sum::<u32>();
        rows.push(row("probe", Some(*amplitude), seconds, Some(steps), &found.stiffness));
    }
    Ok(rows)
}

/// Median CPU time of doing it so often, s, and what came of it.
fn timed<T>(repetitions: u32, work: impl Fn() -> Result<T, Failure>) -> Result<(f64, T), Failure> {
    let mut times = Vec::new();
    loop {
        let begin = thread_seconds()?;
        let result = work()?;
        times.push(thread_seconds()? - begin);
        if times.len() as u32 >= repetitions {
            return Ok((median(times), result));
        }
    }
}

fn network(packing: &Packing) -> Result<Network, Failure> {
    Network::new(packing, true).map_err(invalid)
}

/// The relaxed stiffness, Pa, and iterations.
fn solved(packing: &Packing, tolerance: f64) -> Result<(Stiffness, u32), Failure> {
    let most = micro::Settings::default().max_iterations;
    let found = stiffness::moduli(&network(packing)?, tolerance, most).map_err(invalid)?;
    let moduli = found.map_err(|none| Failure::new(Exit::PhysicsInvalid, none))?;
    Ok((moduli.stiffness, moduli.iterations))
}

/// Copies of the packing along each axis. Contacts are those of the overlaps.
fn replicated(packing: &Packing, copies: u32) -> Result<Packing, Failure> {
    let (cell, centres) =
        repeated(packing, copies).ok_or_else(|| Failure::failed("the repeated cell is none"))?;
    let largest = packing.radii.iter().copied().fold(0.0, f64::max);
    let setting = Setting {
        friction: packing.friction,
        damping: 0.0,
        drag: 0.0,
        spin_drag: 0.0,
        tangential: scene::Tangential::Rescaled,
        time_step: TimeStep::Fixed(1e-9),
        skin: 0.01 * largest,
        speed_cap: None,
    };
    let radii = packing.radii.repeat((copies as usize).pow(3));
    let mut engine = Engine::new(cell, packing.material, radii, &centres, setting);
    engine.sort();
    engine.prepare().map_err(invalid)?;
    Ok(engine.packing(Mat3::identity()))
}

fn invalid(error: impl std::error::Error + Send + Sync + 'static) -> Failure {
    Failure::new(Exit::PhysicsInvalid, error)
}

fn table(rows: &[Row], number: impl Fn(Option<f64>) -> String) -> Table {
    let mut t = Table::new([
        "grains",
        "replicated",
        "coordination",
        "method",
        "setting",
        "seconds",
        "iterations",
        "error",
    ]);
    for r in rows {
        t.row(vec![
            r.grains.to_string(),
            if r.replicated { "yes" } else { "no" }.to_owned(),
            number(Some(r.coordination)),
            r.method.to_owned(),
            r.setting.map_or_else(|| "-".to_owned(), |s| format!("{s:e}")),
            number(Some(r.seconds)),
            r.iterations.map_or_else(|| "-".to_owned(), |n| n.to_string()),
            format!("{:.1e}", r.error),
        ]);
    }
    t
}
