//! `cargo run --release -p grainlab_verify`: this laboratory compared with other codes and with the literature.
//!
//! - `suites`: the comparisons; `golden`: the packings that they need
//! - `table`: the comparisons as text and CSV

mod golden;
mod suites;
mod table;

use clap::Parser;
use grainlab_console::{Failure, Format, say};
use grainlab_msgs::Exit;
use grainlab_verify::{Row, Verdict};
use suites::{SUITES, Suite};

const EXAMPLES: &str = "\
Every comparison is made by the engine, the contact law and the measurements of this laboratory. Passed: within the tolerance.
Explained: outside it for a known difference, which the notes name; with it a computation of neither side gives their number, and
without it ours. Differs: outside it, for the reason in the notes; ours is what our own law gives and nothing reproduces theirs, or
their numbers scatter more than their errors. Not comparable: this laboratory lacks what is needed. Exit 1 if a comparison failed; those that differ are listed below the table. JSON and CSV have each source in full, and JSON every point of a curve.

Examples:
  cargo run --release -p grainlab_verify                             everything but the slow suites
  cargo run --release -p grainlab_verify -- --only chung-ooi         one suite
  cargo run --release -p grainlab_verify -- --slow --format csv      with packings prepared as published";

/// Compare with other codes and the literature: one table of numbers, tolerances and verdicts.
#[derive(Debug, Parser)]
#[command(after_help = EXAMPLES)]
struct Args {
    /// Only this suite; may be repeated
    #[arg(long, value_name = "SUITE", value_parser = SUITES.map(|s| s.name))]
    only: Vec<String>,
    /// The slow suites too: minutes
    #[arg(long)]
    slow: bool,
    /// Format of the comparisons
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

fn main() -> std::process::ExitCode {
    let exit = run(&Args::parse()).unwrap_or_else(|failure| {
        say!("grainlab: {failure}");
        failure.exit
    });
    exit.into()
}

fn run(args: &Args) -> Result<Exit, Failure> {
    let mut rows = Vec::new();
    for suite in SUITES.iter().filter(|s| args.selects(s)) {
        if suite.slow {
            say!("grainlab: {}: {}", suite.name, suite.about);
        }
        rows.extend((suite.rows)()?);
    }
    let judged: Vec<_> = rows.iter().map(table::Judged::new).collect();
    args.format.print(&judged, || table::csv(&rows), || table::text(&rows))?;
    Ok(exit(&rows))
}

impl Args {
    fn selects(&self, suite: &Suite) -> bool {
        if self.only.is_empty() {
            self.slow || !suite.slow
        } else {
            self.only.iter().any(|n| n == suite.name)
        }
    }
}

fn exit(rows: &[Row]) -> Exit {
    if rows.iter().any(|r| r.verdict() == Verdict::Failed) { Exit::Failure } else { Exit::Done }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_verify::{Measure, Point};

    /// The quick half of the table: outside truth about engine, contact law and measurements.
    #[test]
    fn every_quick_comparison_passes_or_differs_as_explained() {
        let args = Args { only: Vec::new(), slow: false, format: Format::Table };
        let rows: Vec<Row> =
            SUITES.iter().filter(|s| args.selects(s)).flat_map(|s| (s.rows)().unwrap()).collect();
        assert_eq!(exit(&rows), Exit::Done, "\n{}", table::text(&rows));
        for suite in SUITES.iter().filter(|s| !s.slow) {
            let passed = rows.iter().filter(|r| r.suite == suite.name && r.verdict() == Verdict::Passed);
            assert!(passed.count() > 0, "{} has no comparison that passes", suite.name);
        }
        for row in &rows {
            let differs = row.verdict() != Verdict::Passed;
            assert!(!(differs && row.note.is_empty()), "{} differs without a note", row.name);
            // A tolerance near the difference could be one that was set at the difference.
            let is_near = row.difference().is_some_and(|d| d > 0.5 * row.tolerance && d > 0.0);
            let has_source = !row.tolerance_from.is_empty();
            assert!(
                differs || !is_near || has_source,
                "{} does not say where its tolerance is from",
                row.name
            );
        }
    }

    #[test]
    fn the_exit_code_is_1_if_a_comparison_failed() {
        let row = |ours| {
            Row::new("suite", "name", "source", "m", Measure::Relative, 0.1, vec![Point::new(0.0, 1.0, ours)])
        };
        assert_eq!(exit(&[row(1.0), row(1.05)]), Exit::Done);
        assert_eq!(exit(&[row(1.0), row(1.5)]), Exit::Failure);
    }
}
