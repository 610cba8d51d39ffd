//! The table of the records.

use crate::commands::invert::SPEED_COLUMNS;
use grainlab_acoustics::record::Passage;
use grainlab_console::Failure;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Columns of a record.
const OWN: [&str; 10] = [
    "file",
    "distance",
    "distance_sigma",
    "delay",
    "delay_sigma",
    "polarity",
    "time_column",
    "source_column",
    "receiver_column",
    "time_unit",
];

/// Columns of `grainlab invert --speeds` that the picks fill in; the others are copied.
const PICKED: [&str; 3] = ["frequency", "speed", "speed_sigma"];

fn is_copied(name: &str) -> bool {
    SPEED_COLUMNS.contains(&name) && !PICKED.contains(&name)
}

/// One row of the table.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) line: u64,
    /// Path of its file as the table has it.
    pub(super) file: String,
    pub(super) path: PathBuf,
    pub(super) passage: Passage,
    /// Numbers of the columns of time, source and receiver, from 0.
    pub(super) columns: [usize; 3],
    /// Unit of the times, s.
    pub(super) unit: f64,
    /// Cells that are copied, with their names.
    pub(super) copied: Vec<(String, String)>,
}

/// The rows of a table.
pub(super) fn read(path: &Path) -> Result<Vec<Row>, Failure> {
    let text = std::fs::read_to_string(path).map_err(Failure::at(path))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parsed(&text, folder).map_err(|fault| Failure::usage(format!("{}: {fault}", path.display())))
}

fn parsed(text: &str, folder: &Path) -> Result<Vec<Row>, String> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
    let header: Vec<String> =
        reader.headers().map_err(|e| e.to_string())?.iter().map(str::to_lowercase).collect();
    for (k, name) in header.iter().enumerate() {
        if !OWN.contains(&name.as_str()) && !is_copied(name) {
            let known = SPEED_COLUMNS.iter().filter(|name| is_copied(name)).chain(&OWN);
            let known: Vec<&str> = known.copied().collect();
            return Err(format!("column {name:?} is not known; columns are {}", known.join(", ")));
        }
        if header[..k].contains(name) {
            return Err(format!("column {name:?} is there twice"));
        }
    }
    if let Some(missing) = ["file", "distance", "diameter"].iter().find(|n| !header.iter().any(|h| h == *n)) {
        return Err(format!("there is no column {missing:?}"));
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| e.to_string())?;
        let line = record.position().map_or(0, csv::Position::line);
        let cells: BTreeMap<&str, &str> =
            header.iter().map(String::as_str).zip(&record).filter(|(_, c)| !c.is_empty()).collect();
        rows.push(row(line, &header, &cells, folder).map_err(|fault| format!("line {line}: {fault}"))?);
    }
    if rows.is_empty() {
        return Err("there is no record below the header".to_owned());
    }
    Ok(rows)
}

fn row(line: u64, header: &[String], cells: &BTreeMap<&str, &str>, folder: &Path) -> Result<Row, String> {
    let number = |name: &str| match cells.get(name) {
        None => Ok(None),
        Some(cell) => cell.parse().map(Some).map_err(|_| format!("{name} is {cell:?}; it must be a number")),
    };
    let needed = |name: &str| number(name)?.ok_or_else(|| format!("{name} is missing"));
    let column = |name: &str, default: usize| match cells.get(name) {
        None => Ok(default - 1),
        Some(cell) => {
            let found = cell.parse::<usize>().ok().filter(|n| *n > 0).map(|n| n - 1);
            found.ok_or_else(|| format!("{name} is {cell:?}; it must be a number of a column, from 1"))
        }
    };
    let reversed = match cells.get("polarity").copied() {
        None => None,
        Some("normal") => Some(false),
        Some("reversed") => Some(true),
        Some(other) => return Err(format!("polarity is {other:?}; it must be normal or reversed, or empty")),
    };
    let longitudinal = match cells.get("mode").map(|mode| mode.to_lowercase()).as_deref() {
        None => None,
        Some("p") => Some(true),
        Some("s" | "sv" | "sh") => Some(false),
        Some(other) => return Err(format!("mode is {other:?}; it must be p, s, sv or sh, or empty")),
    };
    let unit = match cells.get("time_unit").copied().unwrap_or("s") {
        "s" => 1.0,
        "ms" => 1e-3,
        "us" => 1e-6,
        other => return Err(format!("time_unit is {other:?}; it must be s, ms or us")),
    };
    let file = cells.get("file").ok_or("file is missing")?.to_string();
    let copied = header.iter().filter(|name| is_copied(name));
    Ok(Row {
        line,
        path: folder.join(&file),
        file,
        passage: Passage {
            distance: needed("distance")?,
            distance_stddev: number("distance_sigma")?.unwrap_or(0.0),
            delay: number("delay")?.unwrap_or(0.0),
            delay_stddev: number("delay_sigma")?.unwrap_or(0.0),
            reversed,
            diameter: needed("diameter")?,
            longitudinal,
        },
        columns: [column("time_column", 1)?, column("source_column", 2)?, column("receiver_column", 3)?],
        unit,
        copied: copied
            .map(|name| (name.clone(), cells.get(name.as_str()).unwrap_or(&"").to_string()))
            .collect(),
    })
}
