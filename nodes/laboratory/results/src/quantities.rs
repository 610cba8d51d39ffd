//! Results as JSON and CSV, from the tables of quantities.

use grainlab_console::Cell;
use grainlab_core::notes::Note;
use grainlab_core::quantity::{Quantity, Shape, Value};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::collections::BTreeMap;

pub(crate) fn entries<R, M: SerializeMap>(
    map: &mut M,
    table: &[Quantity<R>],
    result: &R,
) -> Result<(), M::Error> {
    table
        .iter()
        .try_for_each(|q| map.serialize_entry(q.key, &Json { shape: q.shape, value: (q.value)(result) }))
}

/// Names of the columns of these quantities.
pub fn columns<'a, R: 'static>(
    quantities: impl IntoIterator<Item = &'a Quantity<R>>,
) -> impl Iterator<Item = String> {
    quantities.into_iter().flat_map(Quantity::columns)
}

/// The values of these columns, at full precision; unknown values are empty.
pub(crate) fn cells<'a, R: 'static>(
    quantities: impl IntoIterator<Item = &'a Quantity<R>>,
    result: &R,
) -> impl Iterator<Item = String> {
    typed_cells(quantities, result).map(|cell| cell.text())
}

/// The values of these columns.
pub fn typed_cells<'a, R: 'static>(
    quantities: impl IntoIterator<Item = &'a Quantity<R>>,
    result: &R,
) -> impl Iterator<Item = Cell> {
    quantities.into_iter().flat_map(|q| {
        let columns = q.columns().len();
        match (q.value)(result) {
            _ if columns == 0 => Vec::new(),
            Value::Unknown => vec![Cell::Unknown; columns],
            Value::Number(v) => vec![Cell::Number(v)],
            Value::Count(n) => vec![Cell::Count(n)],
            Value::Flag(flag) => vec![Cell::Flag(flag)],
            Value::Word(word) => vec![Cell::Text(word.to_owned())],
            Value::Text(text) => vec![Cell::Text(text)],
            Value::Numbers(numbers) => {
                numbers.into_iter().map(|v| v.map_or(Cell::Unknown, Cell::Number)).collect()
            }
            Value::Counts(counts) => counts.into_iter().map(|n| Cell::Count(n.into())).collect(),
        }
    })
}

/// A note in JSON: code, status, names, numbers by name, sentence.
pub(crate) struct NoteView<'a>(pub(crate) &'a Note);

impl Serialize for NoteView<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let note = self.0;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("code", note.code())?;
        map.serialize_entry("severity", note.severity().name())?;
        map.serialize_entry("subjects", note.subjects())?;
        map.serialize_entry("numbers", &note.named_values().collect::<BTreeMap<_, _>>())?;
        map.serialize_entry("text", &note.to_string())?;
        map.end()
    }
}

/// A value in JSON: null if it is unknown, rows of a stiffness as arrays.
struct Json {
    shape: Shape,
    value: Value,
}

impl Serialize for Json {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.value {
            Value::Unknown => serializer.serialize_none(),
            Value::Number(v) => v.serialize(serializer),
            Value::Count(n) => n.serialize(serializer),
            Value::Flag(flag) => flag.serialize(serializer),
            Value::Word(word) => word.serialize(serializer),
            Value::Text(text) => text.serialize(serializer),
            Value::Numbers(rows) if matches!(self.shape, Shape::Stiffness(_)) => {
                serializer.collect_seq(rows.chunks(6))
            }
            Value::Numbers(numbers) => numbers.serialize(serializer),
            Value::Counts(counts) => counts.serialize(serializer),
        }
    }
}

/// A table as text, for the help of a command: key, symbol, unit and meaning, one line each.
pub fn help<R: 'static>(table: &[Quantity<R>]) -> String {
    let line = |q: &Quantity<R>| {
        let unit = if matches!(q.unit, "" | "1") { String::new() } else { format!(", {}", q.unit) };
        format!("  {:<32} {}{unit}\n", q.key, q.meaning)
    };
    table.iter().map(line).collect()
}

#[cfg(test)]
fn markdown<R: 'static>(table: &[Quantity<R>]) -> String {
    let line = |q: &Quantity<R>| {
        let columns = q.columns();
        let columns = match (columns.first(), columns.last()) {
            (Some(one), Some(last)) if one == last => format!("`{one}`"),
            (Some(first), Some(last)) => format!("`{first}` … `{last}`"),
            _ => "–".to_owned(),
        };
        // A bar would end the cell.
        let meaning = q.meaning.replace('|', "\\|");
        format!("| `{}` | {} | {columns} | {} | {meaning} |\n", q.key, q.symbol, q.unit)
    };
    let head = "| key | symbol | columns of CSV | unit | meaning |\n|---|---|---|---|---|\n";
    head.to_owned() + &table.iter().map(line).collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::acoustic::ACOUSTIC;
    use crate::measured_packing::ORIGIN;
    use grainlab_core::results::QUANTITIES;

    /// Arrays, which one value per packing cannot hold.
    const WAVE_ARRAYS: &str = include_str!("wave_arrays.md");

    /// The reference in the repository equals that of the tables. With `GRAINLAB_BLESS=1` the test writes it.
    #[test]
    fn the_written_reference_is_that_of_the_tables() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../quantities.md");
        let text = format!(
            "# Quantities\n\nWhat `grainlab analyze`, `grainlab probe` and `grainlab launch` report: keys of JSON and columns\n\
             of CSV, as `grainlab invert --table` and `grainlab calibrate` read them. Values that are undefined or not known are\n\
             null in JSON and empty in CSV. The tests of the crate `grainlab_results` write this page from the tables in\n\
             `nodes/kernels/core/src/results/quantities.rs` and `nodes/laboratory/results/src/`.\n\n## Origin\n\n{}\n## Packing\n\n{}\n\
             ## Waves, by `grainlab probe`\n\nIn JSON under `acoustic`.\n\n{}\n{WAVE_ARRAYS}",
            markdown(ORIGIN),
            markdown(QUANTITIES),
            markdown(ACOUSTIC),
        );
        if std::env::var_os("GRAINLAB_BLESS").is_some() {
            std::fs::write(path, text).unwrap();
        } else {
            let bless = "GRAINLAB_BLESS=1 cargo test --release -p grainlab_results quantities";
            let is_current = std::fs::read_to_string(path).is_ok_and(|written| written == text);
            assert!(is_current, "{path} is out of date: {bless} writes it");
        }
    }
}
