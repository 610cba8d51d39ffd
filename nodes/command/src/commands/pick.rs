//! `grainlab pick`: wave speeds from the records of an oscilloscope.
//!
//! - [`list`]: the table of the records; [`oscilloscope`]: the file of one
//! - `figure`: a record with what was picked in it

#[cfg(feature = "studio")]
mod figure;
mod list;
mod oscilloscope;

use grainlab_acoustics::record::{Pick, Picks, picks};
use grainlab_console::{CsvText, Failure, Format, Table, fixed, say, write_whole};
use grainlab_node_kit::Exit;
use list::Row;
use serde::Serialize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
The table has a row for each record, as CSV with a header:

  file                                       of an oscilloscope: CSV, by its path from the table; text above the numbers is skipped
  distance                                   between the tips of source and receiver, m; distance_sigma
  diameter                                   mean diameter of the grains, m: waves of some ten diameters are slower than long ones
  delay                                      travel time of the system, source and receiver face to face, s [0]; delay_sigma
  polarity                                   normal or reversed: how the receiver shows a wave when both are face to face [not known]
  time_column, source_column, receiver_column  numbers of the columns in the file [1, 2, 3]
  time_unit                                  s, ms or us [s]
  sample, mode, direction, angle_deg, pressure_pa, density, ...  are copied to the output: columns of `grainlab invert --speeds`

Every record is picked by its first break, its peak and its cross-correlation with the source. The same is done with computed records of a
path of known speed, with the source, loss, noise and crosstalk of the record, and drawn dispersion and near field: their mean error is
the bias that is taken off, their scatter the error. Recommended is the pick with the least error. The speed is that of long waves.

Examples:
  Speeds, and what was picked:
    grainlab pick records.csv --out speeds.csv --plot picked
  The microstructure from them:
    grainlab invert --speeds speeds.csv";

/// Records to pick.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Table of the records, CSV
    #[arg(value_name = "RECORDS.csv")]
    records: PathBuf,
    /// Write the speeds to this file, for `grainlab invert --speeds`
    #[arg(long, value_name = "SPEEDS.csv")]
    out: Option<PathBuf>,
    /// Draw each record with its picks, an SVG each, into this folder
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
    /// Seed of the computed records
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// One record and its picks, as JSON has them.
#[derive(Debug, Serialize)]
struct Found {
    file: String,
    line: u64,
    /// Reason why there is no speed.
    refused: Option<String>,
    picks: Vec<OnePick>,
    recommended: Option<&'static str>,
    frequency: Option<f64>,
    wavelengths: Option<f64>,
    signal_to_noise: Option<f64>,
    notes: Vec<String>,
}

/// A pick in SI units.
#[derive(Debug, Serialize)]
struct OnePick {
    method: &'static str,
    time: f64,
    time_sigma: f64,
    bias: f64,
    speed: f64,
    speed_sigma: f64,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let rows = list::read(&args.records)?;
    let mut all = Vec::new();
    for row in &rows {
        let record = oscilloscope::read(row)?;
        let picked = picks(&record, &row.passage, args.seed);
        if let (Some(folder), Ok(picked)) = (&args.plot, &picked) {
            drawn(folder, row, &record, picked)?;
        }
        all.push((row, picked.map_err(|e| e.to_string())));
    }
    let found: Vec<Found> = all.iter().map(|(row, picked)| Found::of(row, picked.as_ref())).collect();
    if let Some(path) = &args.out {
        write_whole(path, speeds(&all)).map_err(Failure::at(path))?;
        let count = all.iter().filter(|(_, picked)| picked.is_ok()).count();
        say!("grainlab: {} speeds are written to {}", count, path.display());
    }
    args.format.print(&found, || speeds(&all), || text(&all, &found))?;
    let refused = found.iter().filter(|f| f.refused.is_some()).count();
    if refused > 0 {
        say!("grainlab: {refused} of {} records have no speed", found.len());
        return Ok(Exit::PhysicsInvalid);
    }
    Ok(Exit::Done)
}

#[cfg(feature = "studio")]
use figure::drawn;

#[cfg(not(feature = "studio"))]
fn drawn(
    _: &std::path::Path,
    _: &Row,
    _: &grainlab_acoustics::record::Record,
    _: &Picks,
) -> Result<(), Failure> {
    Err(Failure::usage("--plot needs the studio: build with its feature"))
}

impl Found {
    fn of(row: &Row, picked: Result<&Picks, &String>) -> Self {
        let one = |p: &Pick| OnePick {
            method: p.method.word(),
            time: p.time,
            time_sigma: p.time_stddev,
            bias: p.bias,
            speed: p.speed,
            speed_sigma: p.speed_stddev,
        };
        let known = picked.ok();
        Self {
            file: row.file.clone(),
            line: row.line,
            refused: picked.err().cloned(),
            picks: known.map(|p| p.picks.iter().map(one).collect()).unwrap_or_default(),
            recommended: known.map(|p| p.picks[p.recommended].method.word()),
            frequency: known.map(|p| p.frequency),
            wavelengths: known.map(|p| p.wavelengths),
            signal_to_noise: known.map(|p| p.signal_to_noise),
            notes: known.map(notes).unwrap_or_default(),
        }
    }
}

/// Properties of a record that its reader should know.
fn notes(p: &Picks) -> Vec<String> {
    let mut notes: Vec<String> =
        p.missing.iter().map(|(method, why)| format!("no {}: {why}", method.word())).collect();
    if p.contradictory {
        notes.push("the picks contradict each other: their difference is in the error".into());
    }
    if p.wavelengths < 2.0 {
        notes.push(format!(
            "the path is {:.1} wavelengths long: the near field of the source reaches the receiver",
            p.wavelengths
        ));
    }
    if p.crosstalk.abs() > 0.05 {
        notes.push(format!("crosstalk of {:.0} % of the arrival was taken off", 100.0 * p.crosstalk.abs()));
    }
    let [alike, expected] = p.alike;
    if expected - alike > 0.1 {
        notes.push(format!(
            "the arrival does not have the shape of the source after this path (correlation {alike:.2}, expected {expected:.2}): transducers ring, or \
             waves overlap; part of a period is in the error"
        ));
    }
    if p.sign_doubt > 0.3 {
        notes.push(
            "a wave of the opposite sign fits almost as well: give the polarity for a smaller error".into(),
        );
    }
    if p.is_cut {
        notes.push("the amplifier cut the largest samples".into());
    }
    if !p.signal_to_noise.is_finite() {
        notes.push("there is no noise before the source starts, so the error has none".into());
    }
    if p.reversed {
        notes.push("the wave is reversed".into());
    }
    notes
}

/// The table that `grainlab invert --speeds` reads.
fn speeds(all: &[(&Row, Result<Picks, String>)]) -> String {
    let names: Vec<&str> =
        all.first().map(|(row, _)| row.copied.iter().map(|(n, _)| n.as_str()).collect()).unwrap_or_default();
    let mut csv = CsvText::default();
    names.iter().for_each(|name| csv.cell(name));
    csv.row(["frequency", "speed", "speed_sigma"]);
    for (row, picked) in all {
        let Ok(picked) = picked else { continue };
        let best = picked.picks[picked.recommended];
        row.copied.iter().for_each(|(_, value)| csv.cell(value));
        csv.number(Some(picked.frequency));
        csv.number(Some(best.speed));
        csv.number(Some(best.speed_stddev));
        csv.end();
    }
    csv.finish()
}

fn text(all: &[(&Row, Result<Picks, String>)], found: &[Found]) -> String {
    let mut table = Table::new(["record", "pick", "time/us", "+-", "bias", "m/s", "+-", "waves", "S/N"]);
    for (row, picked) in all {
        let Ok(picked) = picked else {
            table.row([&row.file, "refused", "-", "-", "-", "-", "-", "-", "-"]);
            continue;
        };
        for (k, p) in picked.picks.iter().enumerate() {
            let best = k == picked.recommended;
            let name = format!("{}{}", p.method.word(), if best { " *" } else { "" });
            let us = |t: f64| fixed(Some(1e6 * t), 2);
            let of_record = |v: f64| if k == 0 { fixed(Some(v), 1) } else { String::new() };
            table.row([
                if k == 0 { row.file.clone() } else { String::new() },
                name,
                us(p.time),
                us(p.time_stddev),
                us(p.bias),
                fixed(Some(p.speed), 1),
                fixed(Some(p.speed_stddev), 1),
                of_record(picked.wavelengths),
                of_record(picked.signal_to_noise),
            ]);
        }
    }
    let mut text = table.text() + "* recommended: the least error\n";
    for f in found {
        for note in f.refused.iter().chain(&f.notes) {
            text += &format!("{}: {note}\n", f.file);
        }
    }
    text
}
