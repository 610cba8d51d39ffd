//! `grainlab_bench overview`: time against error of every method, in one table and one figure.

use crate::acoustics::{self, Method};
use crate::engine::{self, Runs, VariedSetting};
use crate::output::Output;
use crate::packing::load;
use crate::row::Row;
use crate::{inversion, stiffness};
use clap::ValueEnum;
use grainlab_console::{Failure, say};
use grainlab_node_kit::Exit;

const EXAMPLES: &str = "\
Times are CPU times, medians of the repetitions. Every error is a pure number; what it is an error of, and against which
reference, is part of its row, and errors of different quantities are not comparable. The packings and the held-out states
are those of this program: nothing is read from files.

Settings of the engine are varied alone. The error of one is the mean over the seeds of its difference, in k, eps, phi, G12
and Theta, from runs with every setting at its most accurate value, G12 and Theta relative to them; JSON and CSV have each
(error_k and so on). Packings diverge from any perturbation: an error is resolved if zero lies outside its 95 % interval.

Examples:
  The table and the figure, with the same rows as CSV and JSON (some four minutes on two cores):
    cargo run --release -p grainlab_bench -- overview --out overview
  Every setting of the engine alone, with more seeds:
    cargo run --release -p grainlab_bench -- overview --only engine --settings all --seeds 8 --out engine
  A first impression, in less than a minute:
    cargo run --release -p grainlab_bench -- overview --quick";

/// Amount to measure.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Parts to measure [default: all]
    #[arg(long, value_enum, value_name = "PART", value_delimiter = ',')]
    only: Vec<Part>,
    /// Settings of the engine to vary, or all
    #[arg(long, value_name = "SETTING", value_delimiter = ',', default_value = "strain_rate,control_period,grains", value_parser = setting)]
    settings: Vec<Option<VariedSetting>>,
    /// Seeds per setting of the engine, counted up from 1 [default: 5, or 3 with --quick]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    seeds: Option<u32>,
    /// Fewer values and repetitions, only the first setting of the engine, and less accurate runs to compare with
    #[arg(long)]
    quick: bool,
    /// Number of parallel runs of the engine; each is timed by the CPU time of its own thread
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: u32,
    #[command(flatten)]
    output: Output,
}

/// A part of the laboratory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Models of the inversion, on held-out states.
    Inversion,
    /// Elastic constants of 2,000 grains.
    Stiffness,
    /// The engine: energy created by its time step, and packings that its settings lead to.
    Engine,
    /// Wave speeds of 500 grains.
    Waves,
}

/// `None` for all of them.
fn setting(text: &str) -> Result<Option<VariedSetting>, String> {
    if text == "all" {
        return Ok(None);
    }
    let names = || VariedSetting::value_variants().iter().map(|s| s.name()).collect::<Vec<_>>().join(", ");
    VariedSetting::from_str(text, false).map(Some).map_err(|_| format!("one of all, {}", names()))
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    args.output.ready()?;
    let mut rows = Vec::new();
    for part in Part::value_variants() {
        if !args.only.is_empty() && !args.only.contains(part) {
            continue;
        }
        say!("grainlab: {}", format!("{part:?}").to_lowercase());
        rows.extend(match part {
            Part::Inversion => inversion::rows(if args.quick { 5 } else { 15 })?,
            Part::Stiffness => network(args.quick)?,
            Part::Engine => of_engine(args)?,
            Part::Waves => waves(args.quick)?,
        });
    }
    args.output.finish("overview", rows)
}

fn network(quick: bool) -> Result<Vec<Row>, Failure> {
    let methods = stiffness::Methods {
        tolerances: vec![1e-2, 1e-4, 1e-6, 1e-8, 1e-12],
        amplitudes: if quick { Vec::new() } else { vec![1e-5, 1e-7] },
        frictionless: false,
        repetitions: if quick { 3 } else { 7 },
    };
    stiffness::rows(&load(None)?, "", &methods)
}

fn of_engine(args: &Args) -> Result<Vec<Row>, Failure> {
    let mut settings: Vec<VariedSetting> = match args.settings.iter().copied().collect::<Option<Vec<_>>>() {
        Some(given) => given,
        None => VariedSetting::value_variants().to_vec(),
    };
    settings.truncate(if args.quick { 1 } else { settings.len() });
    let (shares, of_energy, of_packings) =
        if args.quick { (&[0.4, 0.8][..], 2, 3) } else { (&[0.2, 0.4, 0.8, 1.0][..], 5, 5) };
    let threads = args.threads as usize;
    let mut rows = engine::energy(shares, &Runs { seeds: of_energy, threads })?;
    let runs = Runs { seeds: args.seeds.unwrap_or(of_packings), threads };
    rows.extend(engine::packings(&settings, args.quick, &runs)?);
    Ok(rows)
}

/// Speeds of a packing that is prepared first: one whose contacts have all forces and do not slide. A burst through more
/// grains takes minutes.
fn waves(quick: bool) -> Result<Vec<Row>, Failure> {
    let packing = [engine::prepared(500)?];
    let most = if quick { 1 } else { Method::value_variants().len() };
    let plan = acoustics::Plan {
        method: Method::value_variants()[..most].to_vec(),
        tolerances: vec![1e-2, 1e-4, 1e-6],
        repetitions: 3,
        ..acoustics::Plan::default()
    };
    acoustics::rows(&packing, &plan)
}
