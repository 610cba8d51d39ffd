//! A table of typed columns, as CSV.

mod means;

use grainlab_console::{Cell, CsvText};

/// Rows with named columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dataset {
    names: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

impl Dataset {
    /// An empty table with these columns.
    pub fn new(names: impl IntoIterator<Item = String>) -> Self {
        Self { names: names.into_iter().collect(), rows: Vec::new() }
    }

    /// Adds a row; missing cells at its end are unknown.
    pub fn row(&mut self, cells: impl IntoIterator<Item = Cell>) {
        let mut row: Vec<Cell> = cells.into_iter().collect();
        row.resize(self.names.len(), Cell::Unknown);
        self.rows.push(row);
    }

    /// Adds columns, with their cells row by row; cells beyond the columns are left out.
    pub fn extend(&mut self, names: Vec<String>, cells: impl IntoIterator<Item = Vec<Cell>>) {
        self.names.extend(names);
        for (row, more) in self.rows.iter_mut().zip(cells) {
            row.extend(more);
            row.resize(self.names.len(), Cell::Unknown);
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Comma-separated, with a header.
    pub fn csv(&self) -> String {
        let mut text = CsvText::default();
        text.row(&self.names);
        self.rows.iter().for_each(|row| text.row(row.iter().map(Cell::text)));
        text.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_unknown_is_empty_and_short_rows_are_filled() {
        let mut t = Dataset::new(["a", "b", "c"].map(str::to_owned));
        t.row([Cell::Text("x,y".into()), Cell::Number(0.1), Cell::Flag(true)]);
        t.row([Cell::Unknown, Cell::Number(f64::NAN)]);
        assert_eq!(t.csv(), "a,b,c\n\"x,y\",0.1,true\n,,\n");
    }
}
