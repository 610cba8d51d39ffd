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
use serde_json::{Value, json};
use std::path::PathBuf;

const EXAMPLES: &str = "\
The table has a row for each record, as CSV with a header:

  file                                       of an oscilloscope: CSV, by its path from the table; text above the numbers is skipped
  distance                                   between the tips of source and receiver, m; distance_sigma
  diameter                                   mean diameter of the grains, m; the path has 5 diameters or more
  delay                                      travel time of the system, source and receiver face to face, s [0 without the column]; delay_sigma
  lowpass, highpass, filter_order            of the receiver's electronics: Hz of -3 dB, and number of poles (Butterworth) [none, none, 1]
  polarity                                   normal or reversed: how the receiver shows a wave when both are face to face [not known]
  time_column, source_column, receiver_column  numbers of the columns in the file [1, 2, 3]
  time_unit                                  s, ms or us [s]
  sample, mode, direction, angle_deg, pressure_pa, density, ...  are copied to the output: columns of `grainlab invert --speeds`.
                                             Of mode p the first wave that stands out of the noise is picked, of s, sv and sh the first strong one
                                             that is not P, and without a mode the first strong one

Every record is picked by its first break, its peak and its cross-correlation with the source. The same is done with computed records of a
path of known speed, with the source, loss, noise and crosstalk of the record, and drawn dispersion and near field: their mean error is
the bias, their scatter the error. Printed are the time of long waves, which is the one that was read less the bias (us), the standard deviations (+-),
the speed of long waves with all its errors, the path over the wavelength (waves) and the arrival over the noise (S/N). Recommended is the pick with the least error.
In the output, speed_shared_sigma is the error that the rows of one mode and direction share: of distance and delay, and half of the variance of
the time, which is ringing, dispersion and near field; speed_sigma is the rest, as picks that contradict each other; _notes has the remarks on the record.

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
    #[arg(long, short, alias = "output", value_name = "SPEEDS.csv")]
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

/// Speed of the slowest wave in a record, over that of the pick, above which the record may end before S arrives.
const SOON: f64 = 0.5;

type Found = (Row, Result<Picks, String>);

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let mut all: Vec<Found> = Vec::new();
    let mut unread = 0;
    for row in list::read(&args.records)? {
        let record = oscilloscope::read(&row);
        unread += usize::from(record.is_err());
        let picked = record.and_then(|record| {
            let picked = picks(&record, &row.passage, args.seed).map_err(|e| e.to_string())?;
            Ok((record, picked))
        });
        if let (Some(folder), Ok((record, picked))) = (&args.plot, &picked) {
            drawn(folder, &row, record, picked)?;
        }
        all.push((row, picked.map(|(_, picked)| picked)));
    }
    let refused = all.iter().filter(|(_, picked)| picked.is_err()).count();
    if let Some(path) = &args.out {
        write_whole(path, speeds(&all))?;
        say!("grainlab: {} speeds are written to {}", all.len() - refused, path.display());
    }
    let values: Vec<Value> = all.iter().map(value).collect();
    args.format.print(&values, || speeds(&all), || text(&all))?;
    if args.format == Format::Csv {
        remarks(&all).iter().for_each(|remark| say!("grainlab: {remark}"));
    }
    if unread > 0 {
        let count = all.len();
        let fault = format!("{unread} of {count} records could not be read, {refused} have no speed");
        return Err(Failure::usage(fault));
    }
    if refused > 0 {
        say!("grainlab: {refused} of {} records have no speed", all.len());
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

/// A record in JSON, in SI units.
fn value((row, picked): &Found) -> Value {
    let one = |p: &Pick| {
        json!({"method": p.method.word(), "time": p.time, "time_sigma": p.time_stddev, "bias": p.bias, "speed": p.speed,
        "speed_sigma": p.speed_own_stddev(), "speed_shared_sigma": p.speed_common_stddev})
    };
    match picked {
        Err(reason) => {
            json!({"file": row.file, "line": row.line, "refused": reason, "picks": [], "notes": []})
        }
        Ok(p) => json!({
            "file": row.file,
            "line": row.line,
            "direction": row.way.map(|(direction, _)| direction.as_slice().to_vec()),
            "polarization": row.way.map(|(_, polarization)| polarization.as_slice().to_vec()),
            "refused": null,
            "picks": p.picks.iter().map(one).collect::<Vec<_>>(),
            "recommended": p.picks[p.recommended].method.word(),
            "frequency": p.frequency,
            "wavelengths": p.wavelengths,
            "signal_to_noise": p.signal_to_noise,
            "notes": notes(row, p),
        }),
    }
}

fn notes(row: &Row, p: &Picks) -> Vec<String> {
    let mut notes: Vec<String> =
        p.missing.iter().map(|(method, why)| format!("no {}: {why}", method.word())).collect();
    let [alike, expected] = p.alike;
    let cases = [
        (
            row.passage.longitudinal.is_none(),
            "mode is not given: the wave may be P or S, and weak waves before it were passed over",
        ),
        (p.contradictory, "the picks contradict each other: their difference is in the error"),
        (
            p.wavelengths < 2.0,
            "the path is shorter than 2 wavelengths: the near field of the source reaches the receiver",
        ),
        (p.crosstalk.abs() > 1.0, "crosstalk larger than the arrival was taken off"),
        ((0.05..=1.0).contains(&p.crosstalk.abs()), "crosstalk was taken off"),
        (
            expected - alike > 0.1,
            "the arrival does not have the shape of the source (transducers ring, or waves overlap): part of a period is in the error, which \
             similar records share",
        ),
        (p.sign_doubt > 0.3, "the opposite sign fits almost as well: give the polarity for a smaller error"),
        (p.is_cut, "the amplifier cut the largest samples"),
        (
            p.slowest > p.picks[p.recommended].speed,
            "the record ends inside the arrival: a part of what is missing is in the error; record longer",
        ),
        (
            !p.signal_to_noise.is_finite(),
            "there is no noise where both signals are quiet, so the error has none",
        ),
        (p.reversed, "the wave is reversed"),
        (!row.has_delay, "the delay of the electronics was taken as 0"),
    ];
    notes.extend(cases.into_iter().filter(|(holds, _)| *holds).map(|(_, note)| note.to_owned()));
    let best = p.picks[p.recommended].speed;
    match p.other_speed {
        Some(other) if row.passage.longitudinal == Some(true) => notes.push(format!(
            "a weaker wave, which may be noise, precedes the first clear one ({best:.1} m/s) at {other:.1} m/s: the error covers both"
        )),
        Some(other) => {
            let is_later = other > best;
            let [first, later] = if is_later { [other, best] } else { [best, other] };
            let taken = if is_later { "later was taken, and the first may be P" } else { "first was taken" };
            notes.push(format!(
                "a strong wave ({later:.1} m/s) follows the first strong one ({first:.1} m/s): the {taken}; the error covers both"
            ));
        }
        None => {}
    }
    if row.passage.longitudinal != Some(true) && p.slowest > SOON * best {
        notes.push(format!(
            "the record ends soon after the pick: a larger wave, slower than {:.1} m/s, would not be seen in it",
            p.slowest
        ));
    }
    notes
}

/// The table that `grainlab invert --speeds` reads.
fn speeds(all: &[Found]) -> String {
    let names: Vec<&str> =
        all.first().map(|(row, _)| row.copied.iter().map(|(n, _)| n.as_str()).collect()).unwrap_or_default();
    let mut csv = CsvText::default();
    names.iter().for_each(|name| csv.cell(name));
    csv.row(["frequency", "speed", "speed_sigma", "speed_shared_sigma", "_notes"]);
    for (row, picked) in all {
        let Ok(picked) = picked else { continue };
        let best = picked.picks[picked.recommended];
        row.copied.iter().for_each(|(_, value)| csv.cell(value));
        let [own, shared] = [best.speed_own_stddev(), best.speed_common_stddev];
        [picked.frequency, best.speed, own, shared].iter().for_each(|value| csv.number(Some(*value)));
        csv.cell(&notes(row, picked).join("; "));
        csv.end();
    }
    csv.finish()
}

fn text(all: &[Found]) -> String {
    let mut table = Table::new(["record", "pick", "time/us", "+-", "bias", "m/s", "+-", "waves", "S/N"]);
    for (row, picked) in all {
        let file = &row.name;
        let Ok(picked) = picked else {
            table.row([file, "refused", "-", "-", "-", "-", "-", "-", "-"]);
            continue;
        };
        for (k, p) in picked.picks.iter().enumerate() {
            let star = if k == picked.recommended { " *" } else { "" };
            let us = |t: f64| fixed(Some(1e6 * t), 2);
            let of_record = |text: String| if k == 0 { text } else { String::new() };
            table.row([
                of_record(file.clone()),
                p.method.word().to_owned() + star,
                us(p.time),
                us(p.time_stddev),
                us(p.bias),
                fixed(Some(p.speed), 1),
                fixed(Some(p.speed_stddev), 1),
                of_record(fixed(Some(picked.wavelengths), 1)),
                of_record(fixed(Some(picked.signal_to_noise), 1)),
            ]);
        }
    }
    let star =
        if all.iter().any(|(_, picked)| picked.is_ok()) { "* recommended: the least error\n" } else { "" };
    let remarks: String = remarks(all).iter().map(|remark| format!("{remark}\n")).collect();
    table.text() + star + &remarks
}

/// Reasons and notes, each with the records that it is about.
fn remarks(all: &[Found]) -> Vec<String> {
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    for (row, picked) in all {
        for note in picked.as_ref().map_or_else(|reason| vec![reason.clone()], |p| notes(row, p)) {
            match found.iter_mut().find(|(text, _)| *text == note) {
                Some((_, rows)) => rows.push(row.name.clone()),
                None => found.push((note, vec![row.name.clone()])),
            }
        }
    }
    let named = |rows: Vec<String>| match rows.len() {
        n if n > 1 && n == all.len() => "all records".to_owned(),
        _ => rows.join(", "),
    };
    found.into_iter().map(|(note, rows)| format!("{note}: {}", named(rows))).collect()
}
