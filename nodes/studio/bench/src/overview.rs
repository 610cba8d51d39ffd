//! `grainlab bench overview`: time against error of every method, in one table and one figure.

mod engine;
mod inversion;
mod network;
mod plot;
mod report;
mod row;
mod waves;

use super::folder;
use grainlab_console::{Failure, Format, json, say};
use grainlab_node_kit::Exit;
use grainlab_page::plot::Theme;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Times are CPU times of all threads, medians of the repetitions. Every error is a pure number; what it is an error of, and
against which reference, is part of its row, and errors of different quantities are not comparable. The packings and the
held-out states are those of this program: nothing is read from files.

Examples:
  The table and the figure, with the same rows as CSV and JSON (some four minutes on two cores):
    grainlab bench overview --out overview
  Only what no other setting of its family beats in both time and error:
    grainlab bench overview --front
  A first impression, in less than a minute:
    grainlab bench overview --quick";

/// How much to measure.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Fewer settings, seeds and repetitions
    #[arg(long)]
    quick: bool,
    /// Print only the rows that no other row with an error of the same quantity beats in both time and error
    #[arg(long)]
    front: bool,
    /// Number of parallel runs of the engine; each is timed by the CPU time of its own thread
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: u32,
    /// Folder for overview.csv, overview.json and overview.svg, which have every row
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    folder::ready(args.out.as_deref())?;
    let mut rows = Vec::new();
    say!("grainlab: inversion");
    rows.extend(inversion::rows(args.quick)?);
    say!("grainlab: stiffness");
    rows.extend(network::rows(args.quick)?);
    say!("grainlab: engine");
    rows.extend(engine::rows(args.quick, args.threads as usize)?);
    say!("grainlab: waves");
    rows.extend(waves::rows(args.quick)?);
    let mut report = report::report(rows);
    if let Some(folder) = &args.out {
        folder::write(folder, "overview.json", &json(&report)?)?;
        folder::write(folder, "overview.csv", &report::csv(&report))?;
        folder::write(folder, "overview.svg", &plot::figure(&report).svg(Theme::System))?;
    }
    if args.front {
        report.rows.retain(|row| row.on_front);
    }
    args.format.print(&report, || report::csv(&report), || report::text(&report))?;
    Ok(Exit::Done)
}
