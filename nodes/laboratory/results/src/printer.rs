//! Results that form one table, one JSON array or one CSV.

use grainlab_console::{Failure, Format, Table, json_element};
use serde::Serialize;
use std::marker::PhantomData;

/// A result that can be printed in every format.
pub trait Printed: Serialize + Sized {
    /// Text for people.
    fn text(&self) -> String;

    /// Results as a table, one per row, at full precision.
    fn table(results: &[Self]) -> Table;

    /// Warnings for a reader of a table, each with its packing. CSV has no place for them: they go to stderr.
    fn warnings(&self) -> Vec<String>;
}

/// Prints results one after the other.
pub struct Printer<R> {
    format: Format,
    /// Columns of CSV; empty for all.
    columns: Vec<String>,
    printed: usize,
    of: PhantomData<fn(&R)>,
}

impl<R: Printed> Printer<R> {
    /// `columns` of CSV; empty for all. An unknown column is refused before the measurements.
    pub fn new(format: Format, columns: Vec<String>) -> Result<Self, Failure> {
        if !columns.is_empty() && format != Format::Csv {
            return Err(Failure::usage("--columns is for --format csv"));
        }
        let printer = Self { format, columns, printed: 0, of: PhantomData };
        printer.csv(&[])?;
        Ok(printer)
    }

    /// Number of results printed.
    pub fn printed(&self) -> usize {
        self.printed
    }

    /// The text of the next result.
    pub fn next(&mut self, result: &R) -> Result<String, Failure> {
        let first = self.printed == 0;
        self.printed += 1;
        Ok(match self.format {
            Format::Table => result.text(),
            Format::Csv => {
                result.warnings().iter().for_each(|warning| grainlab_console::say!("grainlab: {warning}"));
                let text = self.csv(std::slice::from_ref(result))?;
                match text.split_once('\n') {
                    Some((_, row)) if !first => row.to_owned(),
                    _ => text,
                }
            }
            Format::Json => (if first { "[" } else { "," }).to_owned() + &json_element(result)?,
        })
    }

    /// The text after the last result.
    pub fn end(&self) -> Result<String, Failure> {
        Ok(match (self.format, self.printed) {
            (Format::Json, 0) => "[]\n".to_owned(),
            (Format::Json, _) => "\n]\n".to_owned(),
            (Format::Csv, 0) => self.csv(&[])?,
            _ => String::new(),
        })
    }

    fn csv(&self, results: &[R]) -> Result<String, Failure> {
        let table = R::table(results);
        if self.columns.is_empty() {
            return Ok(table.csv());
        }
        let unknown = |name: String| {
            // Columns that begin alike, of hundreds.
            let stem = name.split('_').next().unwrap_or_default();
            let near: Vec<&str> =
                table.header().iter().map(String::as_str).filter(|h| h.starts_with(stem)).collect();
            let near =
                if near.is_empty() { String::new() } else { format!("; there are: {}", near.join(", ")) };
            Failure::usage(format!("--columns: there is no column {name:?}{near}. --format csv has all"))
        };
        Ok(table.select(&self.columns).map_err(unknown)?.csv())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured_packing::{MeasuredPacking, tests};

    fn measured(step: u64) -> MeasuredPacking {
        let packing = grainlab_core::Packing { step, ..tests::lattice(false) };
        MeasuredPacking { source: "a, \"b\"".into(), ..tests::measured(&packing) }
    }

    #[test]
    fn results_printed_one_by_one_are_the_text_of_all() {
        for count in 0..4 {
            let packings: Vec<MeasuredPacking> = (0..count).map(measured).collect();
            let text = |format| {
                let mut printer = Printer::new(format, Vec::new()).unwrap();
                let parts: String = packings.iter().map(|p| printer.next(p).unwrap()).collect();
                parts + &printer.end().unwrap()
            };
            assert_eq!(text(Format::Json), grainlab_console::json(&packings).unwrap());
            assert_eq!(text(Format::Csv), MeasuredPacking::table(&packings).csv());
        }
    }
}
