//! `grainlab_bench lockstep`: duration of one exchange.

mod round;

use grainlab_console::{Failure, Format, Table, exact, fixed};
use grainlab_node_kit::Exit;
use round::Role;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

const EXAMPLES: &str = "\
One process sends a `stress`, another answers with a `strain_rate`, and a recorder writes both to MCAP. Each round is
followed by one without the recorder (`alone`), so that both run under the same load. The duration depends on the placement
of the processes: waking a process on another processor takes longer than on the same one. `taskset -c 0` runs all on one
processor.

Examples:
  taskset -c 0 cargo run --release -p grainlab_bench -- lockstep
  cargo run --release -p grainlab_bench -- lockstep --rounds 5 --format json";

/// The rounds to measure.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Rounds of each of the two kinds
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100))]
    rounds: u32,
    /// Exchanges per round
    #[arg(long, value_name = "N", default_value_t = 5000, value_parser = clap::value_parser!(u64).range(10..=1_000_000))]
    exchanges: u64,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// One process of the measurement
    #[arg(long, value_enum, hide = true)]
    role: Option<Role>,
    /// Folder of the recorder among them
    #[arg(long, hide = true)]
    output: Option<PathBuf>,
}

/// Median and 99th percentile of the duration of an exchange.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Microseconds {
    p50: f64,
    p99: f64,
}

/// One round of the two kinds.
#[derive(Debug, Serialize)]
struct Timing {
    /// Number of the round; `null` for all rounds together.
    value: Option<u32>,
    /// Duration of the exchanges of the row over the bus of grainlab.
    seconds: f64,
    exchanges: usize,
    microseconds: Microseconds,
    /// Over the bus of grainlab, without a recorder.
    alone_microseconds: Microseconds,
    /// Messages of the row that the recorder lost.
    lost: u64,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    if let Some(role) = args.role {
        return round::role(role, args.exchanges, args.output.clone());
    }
    let (mut ours, mut alone, mut lost) = (Vec::new(), Vec::new(), 0);
    let mut rows = Vec::new();
    for number in 1..=args.rounds {
        grainlab_console::say!("grainlab: round {number} of {}", args.rounds);
        let recorded = round::recorded(args.exchanges)?;
        let unrecorded = round::unrecorded(args.exchanges)?;
        rows.push(row(Some(number), [&recorded.micros, &unrecorded], recorded.lost));
        ours.extend(recorded.micros);
        alone.extend(unrecorded);
        lost += recorded.lost;
    }
    rows.push(row(None, [&ours, &alone], lost));
    let report = BTreeMap::from([("rows", &rows)]);
    args.format.print(&report, || table(&rows, exact).csv(), || table(&rows, |v| fixed(v, 1)).text())?;
    Ok(if lost > 0 { Exit::DataLoss } else { Exit::Done })
}

fn row(value: Option<u32>, [ours, alone]: [&[f64]; 2], lost: u64) -> Timing {
    Timing {
        value,
        seconds: ours.iter().sum::<f64>() * 1e-6,
        exchanges: ours.len(),
        microseconds: percentiles(ours),
        alone_microseconds: percentiles(alone),
        lost,
    }
}

/// Nearest ranks; NaN without a measurement, printed as missing.
fn percentiles(micros: &[f64]) -> Microseconds {
    let mut sorted = micros.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = |share: f64| {
        let n = (share * sorted.len() as f64).ceil() as usize;
        sorted.get(n.saturating_sub(1)).copied().unwrap_or(f64::NAN)
    };
    Microseconds { p50: rank(0.5), p99: rank(0.99) }
}

fn table(rows: &[Timing], number: impl Fn(Option<f64>) -> String) -> Table {
    let mut t =
        Table::new(["round", "exchanges", "p50_us", "p99_us", "alone_p50_us", "alone_p99_us", "lost"]);
    for r in rows {
        let kinds = [r.microseconds, r.alone_microseconds];
        let mut cells =
            vec![r.value.map_or_else(|| "all".to_owned(), |n| n.to_string()), r.exchanges.to_string()];
        cells.extend(kinds.iter().flat_map(|kind| [kind.p50, kind.p99]).map(|v| number(Some(v))));
        cells.push(r.lost.to_string());
        t.row(cells);
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_nearest_ranks() {
        let micros: Vec<f64> = (1..=200).rev().map(f64::from).collect();
        assert_eq!(percentiles(&micros), Microseconds { p50: 100.0, p99: 198.0 });
        assert!(percentiles(&[]).p50.is_nan());
    }
}
