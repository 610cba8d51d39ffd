//! Tables as CSV files.

use grainlab_parquet::{Cell, Column};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

/// A CSV file with a header, written row by row.
pub(crate) struct CsvTable(csv::Writer<BufWriter<File>>);

impl CsvTable {
    pub(crate) fn create(path: &Path, columns: &[Column]) -> io::Result<Self> {
        let mut writer = csv::Writer::from_writer(BufWriter::with_capacity(1 << 18, File::create_new(path)?));
        writer.write_record(columns.iter().map(|c| &c.name))?;
        Ok(Self(writer))
    }

    /// Numbers have all digits; those that are not finite are `NaN`, `inf` and `-inf`; what is missing is empty.
    pub(crate) fn row(&mut self, cells: &[Cell]) -> io::Result<()> {
        for cell in cells {
            match cell {
                Cell::Missing => self.0.write_field("")?,
                Cell::Bool(v) => self.0.write_field(if *v { "true" } else { "false" })?,
                Cell::Signed(v) => self.0.write_field(v.to_string())?,
                Cell::Unsigned(v) => self.0.write_field(v.to_string())?,
                // Debug has an exponent where digits would be many.
                Cell::Single(v) => self.0.write_field(format!("{v:?}"))?,
                Cell::Double(v) => self.0.write_field(format!("{v:?}"))?,
                Cell::Text(v) => self.0.write_field(v)?,
            }
        }
        Ok(self.0.write_record(None::<&[u8]>)?)
    }

    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.0.flush()
    }
}
