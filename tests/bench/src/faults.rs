//! `grainlab_bench faults`: the laboratory under seeded faults.
//!
//! All processes of a run in one thread, on the bus in memory: messages are lost, repeated, delayed and out
//! of order, processes crash, are stopped and are restarted, strangers forge every message, clocks jump. Each
//! run must end with the bytes of the undisturbed run, or with an error. A run depends only on its seed, so
//! that a failure can be repeated.
//!
//! The laboratory and its faults are those of `grainlab_buskit`.

use grainlab_buskit::{Done, Outcome, Plan, run_with};
use grainlab_console::{Failure, Format, Table};
use grainlab_node_kit::Exit;
use grainlab_scene::Scene;
use serde::Serialize;
use std::panic::{AssertUnwindSafe, catch_unwind};

const EXAMPLES: &str = "\
Examples:
  cargo run --release -p grainlab_bench -- faults --seeds 1000
  cargo run --release -p grainlab_bench -- faults --seed 4711 --seeds 1 --explain

Exit 1 if a run had different results without an error, or did not end.";

/// Number and seeds of runs.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Number of runs
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    seeds: u64,
    /// Seed of the first run; the next ones count up
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Print the events of each run
    #[arg(long)]
    explain: bool,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// A run that violates the rule.
#[derive(Debug, Serialize)]
struct Fault {
    seed: u64,
    what: String,
}

/// Results of all runs.
#[derive(Debug, Default, Serialize)]
struct Report {
    runs: u64,
    same: u64,
    errors: u64,
    #[serde(flatten)]
    faults: Done,
    failures: Vec<Fault>,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let scene = Scene::parse(include_str!("../../buskit/src/faults.toml")).map_err(Failure::failed)?;
    let expected = match run_with(&scene, &Plan::quiet(), &mut Done::default(), args.explain) {
        Outcome::Finished(record) => record.sorted(),
        outcome => return Err(Failure::failed(format!("the undisturbed run failed: {outcome:?}"))),
    };
    let mut report = Report::default();
    for seed in (args.seed..).take(usize::try_from(args.seeds).unwrap_or(usize::MAX)) {
        let plan = Plan::of(seed);
        if args.explain {
            grainlab_console::say!("seed {seed}: {plan:#?}");
        }
        let faults = &mut report.faults;
        let run = catch_unwind(AssertUnwindSafe(|| run_with(&scene, &plan, faults, args.explain)));
        report.runs += 1;
        let mut fail = |what: String| {
            grainlab_console::say!("grainlab: seed {seed}: {what}");
            report.failures.push(Fault { seed, what });
        };
        match run {
            Err(_) => fail("a node panicked".to_owned()),
            Ok(Outcome::Finished(record)) => match expected.difference(&record.sorted()) {
                None => report.same += 1,
                Some(topic) => fail(format!("other results on {topic}, and no error")),
            },
            Ok(Outcome::Failed(error)) => {
                report.errors += 1;
                if args.explain {
                    grainlab_console::say!("seed {seed}: {error}");
                }
            }
            Ok(Outcome::Stuck(what)) => fail(format!("the run does not end: {what}")),
        }
    }
    args.format.print(&report, || table(&report).csv(), || table(&report).text())?;
    Ok(if report.failures.is_empty() { Exit::Done } else { Exit::Failure })
}

fn table(report: &Report) -> Table {
    let mut t = Table::new(["runs", "same", "errors", "failures", "crashes", "stops", "jumps", "forged"]);
    let (r, f) = (report, &report.faults);
    let counts = [r.runs, r.same, r.errors, r.failures.len() as u64, f.crashes, f.stops, f.jumps, f.forged];
    t.row(counts.map(|n| n.to_string()));
    t
}
