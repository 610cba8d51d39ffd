//! `grainlab verify`: this program compared with other codes and with the literature.

mod embedded;
mod suites;
mod table;

use grainlab_console::{Failure, Format, say};
use grainlab_node_kit::Exit;
use grainlab_verification::{Row, Verdict};
use suites::{SUITES, Suite};

const EXAMPLES: &str = "\
Every comparison is made by the engine, the contact law and the measurements of this program. Passed: within the tolerance.
Explained: outside it for a known difference, which the notes name; with it a computation of neither side gives their number, and
without it ours. Differs: outside it; ours is what our own law gives, and nothing reproduces theirs. Not comparable: this program
lacks what is needed. Exit 1 if a comparison failed; those that differ are listed below the table. JSON and CSV have each source in full, and JSON every point of a curve.

Examples:
  grainlab verify                       everything but the slow suites
  grainlab verify --only chung-ooi      one suite
  grainlab verify --slow --format csv   with packings prepared as published";

/// The comparisons to make.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
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

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
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
    use grainlab_verification::{Measure, Point};

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
