//! Results to stdout: as a table, as JSON, as CSV.

use crate::escape::escape_controls;
use crate::failure::Failure;
use clap::ValueEnum;
use serde::Serialize;
use std::fmt::Write as _;
use std::io::{BufWriter, ErrorKind, IsTerminal, StdoutLock, Write as _};

/// The output format of a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A text table.
    #[default]
    Table,
    /// For programs; the keys are stable, undefined values are null.
    Json,
    /// For spreadsheets; one header line, units in the names, undefined values are empty.
    Csv,
}

impl Format {
    /// Prints a result: `value` as JSON, or its CSV, or its text.
    ///
    /// # Errors
    /// If `value` cannot be JSON, or stdout cannot be written.
    pub fn print<T: Serialize + ?Sized>(
        self,
        value: &T,
        csv: impl FnOnce() -> String,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        print(&match self {
            Self::Json => json(value)?,
            Self::Csv => csv(),
            Self::Table => text(),
        })
    }
}

/// `eprintln!` that ignores a closed stderr: `2>&1 | head` must not end a run. The line comes above a live line.
#[macro_export]
macro_rules! say {
    ($($text:tt)*) => {
        $crate::say_line(format!($($text)*))
    };
}

/// Prints a line on stderr, as [`say!`] does. Escape sequences in the line are shown, not obeyed: it may quote a text from outside.
pub fn say_line(line: String) {
    crate::terminal::write_above_live_line(&(escape_controls(&line).into_owned() + "\n"));
}

/// Writes `text` to stdout. A closed pipe (`| head`) is not an error. A terminal gets it by [`escape_controls`], a file as it is.
pub fn print(text: &str) -> Result<(), Failure> {
    print_more(text).map(|_| ())
}

/// Prints like [`print()`], for a command without an end; false once the reader of standard output has closed it.
pub fn print_more(text: &str) -> Result<bool, Failure> {
    let mut out = Output::open();
    Ok(out.print(text)? && out.flush()?)
}

/// Standard output for many texts: buffered, and escaped as [`print()`] escapes it.
#[derive(Debug)]
pub struct Output {
    out: BufWriter<StdoutLock<'static>>,
    is_terminal: bool,
}

impl Output {
    /// Locks standard output.
    pub fn open() -> Self {
        let out = std::io::stdout().lock();
        Self { is_terminal: out.is_terminal(), out: BufWriter::with_capacity(1 << 16, out) }
    }

    /// Prints `text`; false once the reader of standard output has closed it.
    ///
    /// # Errors
    /// If standard output cannot be written.
    pub fn print(&mut self, text: &str) -> Result<bool, Failure> {
        let text = if self.is_terminal { escape_controls(text) } else { text.into() };
        is_open(self.out.write_all(text.as_bytes()))
    }

    /// Writes what is buffered; false once the reader of standard output has closed it.
    ///
    /// # Errors
    /// If standard output cannot be written.
    pub fn flush(&mut self) -> Result<bool, Failure> {
        is_open(self.out.flush())
    }
}

/// Returns false for a closed pipe (`| head`), which is not an error.
fn is_open(written: std::io::Result<()>) -> Result<bool, Failure> {
    match written {
        Ok(()) => Ok(true),
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(e) => Err(Failure::failed(format!("stdout: {e}"))),
    }
}

/// Indented JSON with a newline at its end. Numbers that are not finite become null.
pub fn json<T: Serialize + ?Sized>(value: &T) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Failure::failed(format!("JSON: {e}")))?;
    Ok(text + "\n")
}

/// A value as an element of a list in indented JSON: on lines of its own, without a comma.
///
/// # Errors
/// As [`json`].
pub fn json_element<T: Serialize + ?Sized>(value: &T) -> Result<String, Failure> {
    Ok(format!("\n{}", json(value)?.trim_end()).replace('\n', "\n  "))
}

/// Rows of cells under a header; the first column is text and aligned left, the others are aligned right.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<Vec<String>>,
}

/// Width up to which the cells of a column are aligned: one very long name would otherwise fill every line with blanks.
const WIDEST_ALIGNED: usize = 1000;

impl Table {
    /// An empty table with these column names.
    pub fn new<S: Into<String>>(header: impl IntoIterator<Item = S>) -> Self {
        Self { rows: vec![header.into_iter().map(Into::into).collect()] }
    }

    /// Adds a row.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// Selects these columns, in this order; an unknown one is returned as the error.
    pub fn select(&self, columns: &[String]) -> Result<Self, String> {
        let header = self.rows.first().map_or(&[][..], Vec::as_slice);
        let at = |name: &String| header.iter().position(|h| h == name).ok_or_else(|| name.clone());
        let chosen = columns.iter().map(at).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { rows: self.rows.iter().map(|r| chosen.iter().map(|c| r[*c].clone()).collect()).collect() })
    }

    /// Names of the columns.
    pub fn header(&self) -> &[String] {
        self.rows.first().map_or(&[], Vec::as_slice)
    }

    /// The rows below them.
    pub fn rows(&self) -> &[Vec<String>] {
        self.rows.get(1..).unwrap_or_default()
    }

    /// Removes the columns in which no row has a value: every cell is a `-`.
    #[must_use]
    pub fn without_empty_columns(mut self) -> Self {
        let (header, rows) = self.rows.split_at(1);
        let has_value = |c: usize| rows.iter().filter_map(|r| r.get(c)).any(|cell| cell != "-");
        let kept: Vec<bool> = (0..header[0].len()).map(|c| rows.is_empty() || has_value(c)).collect();
        for row in &mut self.rows {
            let mut kept = kept.iter();
            row.retain(|_| *kept.next().unwrap_or(&true));
        }
        self
    }

    /// Returns aligned columns, two spaces apart. A cell of more than 1,000 characters widens no column.
    pub fn text(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |c: usize| {
            let cells = self.rows.iter().filter_map(|r| r.get(c)).map(|s| s.chars().count());
            cells.filter(|length| *length <= WIDEST_ALIGNED).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = String::new();
            for (c, cell) in row.iter().enumerate() {
                let w = widths[c];
                let gap = if c == 0 { "" } else { "  " };
                line += &if c == 0 { format!("{gap}{cell:<w$}") } else { format!("{gap}{cell:>w$}") };
            }
            text += line.trim_end();
            text.push('\n');
        }
        text
    }

    /// Comma-separated, quoted where necessary (RFC 4180, but with bare newlines).
    pub fn csv(&self) -> String {
        let mut text = CsvText::default();
        self.rows.iter().for_each(|row| text.row(row));
        text.finish()
    }
}

/// Lines of CSV, one after the other.
#[derive(Debug)]
pub struct CsvText {
    lines: csv::Writer<Vec<u8>>,
    digits: String,
}

impl Default for CsvText {
    fn default() -> Self {
        // The default buffer of 8 KiB costs more than a line.
        let writer = csv::WriterBuilder::new().flexible(true).buffer_capacity(512).from_writer(Vec::new());
        Self { lines: writer, digits: String::new() }
    }
}

impl CsvText {
    /// Adds a cell to the line that is not ended.
    pub fn cell(&mut self, text: &str) {
        // Writing to a vector cannot fail.
        let _ = self.lines.write_field(text);
    }

    /// Adds a number at full precision to the line that is not ended; `None` is an empty cell.
    pub fn number(&mut self, value: Option<f64>) {
        self.digits.clear();
        if let Some(v) = value.filter(|v| v.is_finite()) {
            // Writing to a string cannot fail.
            let _ = write!(self.digits, "{v}");
        }
        let _ = self.lines.write_field(&self.digits);
    }

    /// Ends the line of these cells.
    pub fn end(&mut self) {
        self.row(None::<&str>);
    }

    /// Adds a line.
    pub fn row<C: AsRef<[u8]>>(&mut self, cells: impl IntoIterator<Item = C>) {
        // Writing to a vector cannot fail.
        let _ = self.lines.write_record(cells);
    }

    /// The lines so far.
    pub fn finish(self) -> String {
        let bytes = self.lines.into_inner().unwrap_or_default();
        String::from_utf8(bytes).unwrap_or_default()
    }
}

/// A number at full precision for CSV; `None` is an empty text.
pub fn exact(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map_or_else(String::new, |v| v.to_string())
}

/// A number with `digits` decimal places; `None` is `-`.
pub fn fixed(value: Option<f64>, digits: usize) -> String {
    value.filter(|v| v.is_finite()).map_or_else(|| "-".to_owned(), |v| format!("{v:.digits$}"))
}

/// Least number of significant digits of [`three_digits`].
const SIGNIFICANT: usize = 3;

/// Most decimal places of [`three_digits`]; smaller numbers have a power of ten.
const MOST_DECIMALS: usize = 6;

/// Formats a number with `decimals` places, or with more where these would show fewer than three significant digits, as 0.0112;
/// numbers below 1e-4 have a power of ten, as 1.12e-5. `None` is `-`.
pub fn three_digits(value: Option<f64>, decimals: usize) -> String {
    let Some(value) = value.filter(|v| v.is_finite()) else { return "-".to_owned() };
    match decimals_of(value, decimals) {
        needed if needed > decimals.max(MOST_DECIMALS) => format!("{value:.*e}", SIGNIFICANT - 1),
        needed => format!("{value:.needed$}"),
    }
}

/// Returns the number of decimal places that show three significant digits of `value`, or `least` if it is larger.
pub fn decimals_of(value: f64, least: usize) -> usize {
    let before = value.abs().log10().floor();
    // False for 0, whose logarithm is not finite.
    let needed = if before.is_finite() { SIGNIFICANT as f64 - 1.0 - before } else { 0.0 };
    least.max(needed.max(0.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_numbers_keep_three_digits_and_others_their_decimals() {
        for (value, expected) in [
            (112.4, "112.40"),
            (1.5, "1.50"),
            (0.0, "0.00"),
            (0.998, "0.998"),
            (0.011_24, "0.0112"),
            (-0.011_24, "-0.0112"),
            (1.124e-4, "0.000112"),
            (1.124e-5, "1.12e-5"),
        ] {
            assert_eq!(three_digits(Some(value), 2), expected);
        }
        assert_eq!(
            (three_digits(None, 2), three_digits(Some(f64::NAN), 2)),
            ("-".to_owned(), "-".to_owned())
        );
        assert_eq!(three_digits(Some(112.4), 1), "112.4");
    }

    #[test]
    fn cells_with_commas_and_quotes_survive_csv() {
        let mut t = Table::new(["a", "b"]);
        t.row(["x,y", "say \"no\""]);
        assert_eq!(t.csv(), "a,b\n\"x,y\",\"say \"\"no\"\"\"\n");
    }

    #[test]
    fn columns_come_in_the_order_asked_for_and_an_unknown_one_is_named() {
        let mut t = Table::new(["a", "b", "c"]);
        t.row(["1", "2", "3"]);
        let of = |names: &[&str]| t.select(&names.iter().map(ToString::to_string).collect::<Vec<_>>());
        assert_eq!(of(&["c", "a"]).unwrap().csv(), "c,a\n3,1\n");
        assert_eq!(of(&["c", "d"]).unwrap_err(), "d");
    }

    #[test]
    fn a_name_of_any_length_is_printed_and_does_not_widen_the_other_rows() {
        let mut t = Table::new(["name", "n"]);
        t.row(["x".repeat(70_000), "1".to_owned()]);
        t.row(["a longer one".to_owned(), "2".to_owned()]);
        let text = t.text();
        assert!(text.starts_with("name          n\nxxx") && text.ends_with("x  1\na longer one  2\n"));
    }

    #[test]
    fn a_column_is_left_out_only_if_no_row_has_a_value_there() {
        let mut t = Table::new(["a", "b", "c"]);
        t.row(["x", "-", "-"]);
        t.row(["y", "1", "-"]);
        assert_eq!(t.without_empty_columns().text(), "a  b\nx  -\ny  1\n");
        assert_eq!(
            Table::new(["a", "b"]).without_empty_columns().text(),
            "a  b\n",
            "without rows no column is left out"
        );
    }

    #[test]
    fn undefined_numbers_are_never_printed_as_nan() {
        assert_eq!((exact(Some(f64::NAN)), fixed(Some(f64::INFINITY), 3)), (String::new(), "-".to_owned()));
        assert_eq!(json(&[f64::NAN, 1.5]).unwrap(), "[\n  null,\n  1.5\n]\n");
    }

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let mut t = Table::new(["name", "k"]);
        t.row(["a longer name", "5.13"]);
        assert_eq!(t.text(), "name              k\na longer name  5.13\n");
    }
}
