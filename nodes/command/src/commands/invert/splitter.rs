//! The cells of a line.

use csv_core::{ReadRecordResult, Terminator};

/// Splits lines into cells. A cell in quotes may contain commas and doubled quotes, but no line break, so
/// that an invalid cell affects only its line. Space around a cell is ignored.
pub(crate) struct Splitter {
    reader: csv_core::Reader,
    text: Vec<u8>,
    ends: Vec<usize>,
}

/// The cells of a line.
pub(super) struct Cells<'a> {
    text: &'a str,
    ends: &'a [usize],
}

impl Splitter {
    pub(crate) fn new() -> Self {
        let reader = csv_core::ReaderBuilder::new().terminator(Terminator::Any(b'\n')).build();
        Self { reader, text: Vec::new(), ends: Vec::new() }
    }

    pub(super) fn cells(&mut self, line: &[u8]) -> Result<Cells<'_>, &'static str> {
        // One more place than needed, so that a full buffer is distinct from an empty one.
        self.text.resize(self.text.len().max(line.len() + 1), 0);
        let most = 2 + line.iter().filter(|b| **b == b',').count();
        self.ends.resize(self.ends.len().max(most), 0);
        self.reader.reset();
        let (_, _, written, ended) = self.reader.read_record(line, &mut self.text, &mut self.ends);
        let (result, _, more, last) =
            self.reader.read_record(b"\n", &mut self.text[written..], &mut self.ends[ended..]);
        if result != ReadRecordResult::Record {
            return Err("a quote is not closed on its line");
        }
        let text = std::str::from_utf8(&self.text[..written + more]).map_err(|_| "it is not UTF-8 text")?;
        Ok(Cells { text, ends: &self.ends[..ended + last] })
    }
}

impl<'a> Cells<'a> {
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(super) fn get(&self, column: usize) -> &'a str {
        let start = column.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.text[start..self.ends[column]].trim()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &'a str> + '_ {
        (0..self.len()).map(|column| self.get(column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_cells_hold_commas_and_quotes() {
        let mut splitter = Splitter::new();
        for (line, expected) in [
            ("a, b ,", &["a", "b", ""][..]),
            ("\"x, y\",1", &["x, y", "1"]),
            ("1,\"say \"\"no\"\"\",3", &["1", "say \"no\"", "3"]),
            ("\"\",", &["", ""]),
            ("1,a\"b,2", &["1", "a\"b", "2"]),
        ] {
            let cells = splitter.cells(line.as_bytes()).unwrap();
            assert_eq!(cells.iter().collect::<Vec<_>>(), expected, "{line}");
        }
        for line in ["\"a,b", "1,\"a\"\""] {
            assert!(splitter.cells(line.as_bytes()).is_err(), "{line}");
        }
        assert_eq!(splitter.cells(b"1,2").unwrap().len(), 2, "nothing is left of what was refused");
    }
}
