//! The table of the records.

use crate::commands::invert::{SPEED_COLUMNS, checked_header, not_a_number, speed_row};
use grainlab_acoustics::record::Passage;
use grainlab_console::{Failure, separated};
use grainlab_core::Vec3;
use serde::Deserialize;
use std::path::{Path, PathBuf};

const OWN: [&str; 13] = [
    "file",
    "distance",
    "distance_sigma",
    "delay",
    "delay_sigma",
    "lowpass",
    "highpass",
    "filter_order",
    "polarity",
    "time_column",
    "source_column",
    "receiver_column",
    "time_unit",
];

/// Columns of `grainlab invert --speeds` that the picks fill in; the others are copied.
const PICKED: [&str; 4] = ["frequency", "speed", "speed_sigma", "speed_shared_sigma"];

/// The cells of a row that are not only copied.
#[derive(Deserialize)]
struct Cells {
    file: String,
    distance: f64,
    distance_sigma: Option<f64>,
    diameter: f64,
    delay: Option<f64>,
    delay_sigma: Option<f64>,
    lowpass: Option<f64>,
    highpass: Option<f64>,
    filter_order: Option<u32>,
    polarity: Option<String>,
    mode: Option<String>,
    time_column: Option<usize>,
    source_column: Option<usize>,
    receiver_column: Option<usize>,
    time_unit: Option<String>,
}

#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) line: u64,
    /// Path of its file as the table has it.
    pub(super) file: String,
    /// Name in messages: that of its file, with line, mode and direction if other rows have the same file.
    pub(super) name: String,
    /// Mode and direction as the table has them, if it has.
    pub(super) wave: Vec<String>,
    pub(super) has_delay: bool,
    pub(super) path: PathBuf,
    pub(super) passage: Passage,
    /// Direction and polarization, where they are given.
    pub(super) way: Option<(Vec3, Vec3)>,
    /// Numbers of the columns of time, source and receiver, from 0.
    pub(super) columns: [usize; 3],
    /// Unit of the times, s.
    pub(super) unit: f64,
    /// Cells that are copied, with their names.
    pub(super) copied: Vec<(String, String)>,
}

pub(super) fn read(path: &Path) -> Result<Vec<Row>, Failure> {
    let (name, text) = separated::read(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parsed(&text, folder).map_err(|fault| Failure::usage(format!("{name}: {fault}")))
}

fn parsed(text: &str, folder: &Path) -> Result<Vec<Row>, String> {
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| e.to_string())?.clone();
    let copied: Vec<&str> = SPEED_COLUMNS.into_iter().filter(|name| !PICKED.contains(name)).collect();
    checked_header(&header, &[&OWN[..], &copied].concat(), &["file", "distance", "diameter"])?;
    let mut rows: Vec<Row> = Vec::new();
    let has_delay = header.iter().any(|name| name == "delay");
    for record in reader.records() {
        let record = record.map_err(|e| e.to_string())?;
        let line = record.position().map_or(0, csv::Position::line);
        let cells = record.deserialize(Some(&header)).map_err(|e| not_a_number(&e, &header, &record));
        let at = |fault| format!("line {line}: {fault}");
        let mut row = cells.and_then(|c| row(line, c, folder)).map_err(at)?;
        if row.passage.longitudinal.is_some() {
            row.way = speed_row(&header, &record).map_err(at)?.way;
        }
        let given = |name: &str| header.iter().zip(&record).find(|(n, _)| *n == name).map(|(_, cell)| cell);
        if given("delay").is_some_and(str::is_empty) {
            return Err(at(
                "column delay is empty: give the travel time with source and receiver face to face, s, or 0 if there is none".to_owned(),
            ));
        }
        row.has_delay = has_delay;
        let of_wave = [given("mode"), given("direction").or(given("angle_deg"))];
        row.wave = of_wave.into_iter().flatten().filter(|cell| !cell.is_empty()).map(str::to_owned).collect();
        let all = header.iter().zip(&record).filter(|(name, _)| copied.contains(name));
        row.copied = all.map(|(name, cell)| (name.to_owned(), cell.to_owned())).collect();
        rows.push(row);
    }
    if rows.is_empty() {
        return Err("there is no record below the header".to_owned());
    }
    let files: Vec<String> = rows.iter().map(|row| row.file.clone()).collect();
    for row in &mut rows {
        if files.iter().filter(|file| **file == row.file).count() > 1 {
            let wave = row.wave.iter().map(|word| format!(" {word}")).collect::<String>();
            row.name = format!("{} (line {}{wave})", row.name, row.line);
        }
    }
    Ok(rows)
}

/// The value of a word, which may be in capital letters.
fn word<T: Copy>(name: &str, cell: Option<&String>, words: &[(&str, T)]) -> Result<Option<T>, String> {
    let Some(cell) = cell else { return Ok(None) };
    let found = words.iter().find(|(word, _)| cell.eq_ignore_ascii_case(word)).map(|(_, value)| Some(*value));
    let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
    found.ok_or_else(|| format!("{name} is {cell:?}; it must be one of {}, or empty", known.join(", ")))
}

fn row(line: u64, cells: Cells, folder: &Path) -> Result<Row, String> {
    let modes = [("p", true), ("s", false), ("sv", false), ("sh", false)];
    let numbers = [(cells.time_column, 1), (cells.source_column, 2), (cells.receiver_column, 3)];
    let columns = numbers.map(|(given, default)| given.unwrap_or(default));
    if columns.contains(&0) {
        return Err("time_column, source_column and receiver_column count from 1".to_owned());
    }
    if cells.diameter > 0.2 || cells.distance < 5.0 * cells.diameter {
        let (distance, diameter) = (cells.distance, cells.diameter);
        return Err(format!(
            "distance is {distance} and diameter {diameter}: m, and 5 diameters or more, are expected"
        ));
    }
    Ok(Row {
        line,
        name: Path::new(&cells.file).file_name().unwrap_or_default().to_string_lossy().into_owned(),
        wave: Vec::new(),
        has_delay: false,
        path: folder.join(&cells.file),
        passage: Passage {
            distance: cells.distance,
            distance_stddev: cells.distance_sigma.unwrap_or(0.0),
            delay: cells.delay.unwrap_or(0.0),
            delay_stddev: cells.delay_sigma.unwrap_or(0.0),
            lowpass: cells.lowpass,
            highpass: cells.highpass,
            filter_order: cells.filter_order.unwrap_or(1),
            reversed: word("polarity", cells.polarity.as_ref(), &[("normal", false), ("reversed", true)])?,
            diameter: cells.diameter,
            longitudinal: word("mode", cells.mode.as_ref(), &modes)?,
        },
        way: None,
        columns: columns.map(|c| c - 1),
        unit: word("time_unit", cells.time_unit.as_ref(), &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6)])?
            .unwrap_or(1.0),
        file: cells.file,
        copied: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_that_is_empty_is_refused_and_one_without_column_is_known_to_be_missing() {
        let rows = |text: &str| parsed(text, Path::new(""));
        let fault = rows("file,distance,diameter,delay\na.csv,0.1,1e-4,0\nb.csv,0.1,1e-4,\n").unwrap_err();
        assert!(fault.contains("line 3: column delay is empty"), "{fault}");
        assert!(!rows("file,distance,diameter\na.csv,0.1,1e-4\n").unwrap()[0].has_delay);
        assert!(rows("file,distance,diameter,delay\na.csv,0.1,1e-4,0\n").unwrap()[0].has_delay);
    }

    #[test]
    fn records_of_one_file_are_named_by_line_mode_and_direction() {
        let text = "file,distance,diameter,mode,direction\nx/a.csv,0.1,1e-4,p,along\nx/a.csv,0.1,1e-4,sh,across\nb.csv,0.1,1e-4,p,along\n";
        let names: Vec<String> =
            parsed(text, Path::new("")).unwrap().into_iter().map(|row| row.name).collect();
        assert_eq!(names, ["a.csv (line 2 p along)", "a.csv (line 3 sh across)", "b.csv"]);
    }
}
