//! The rows of a table, in pieces, distributed over several threads.

use super::columns::{BadRow, Columns, Row};
use super::lines::{Lines, Piece};
use super::splitter::Splitter;
use super::state::Defaults;
use grainlab_console::Failure;
use rayon::prelude::*;
use std::path::Path;

/// Rows that one thread takes at a time.
const SHARE: usize = 32;

/// The first line that is not a comment, and the stream of lines below it.
pub(crate) struct Rows {
    lines: Lines,
    pub(crate) columns: Columns,
    /// Lines read together with the header.
    first: Option<Piece>,
    /// Number of the header's line.
    header: u64,
    /// Number of lines below it so far that begin with `#`.
    comments: usize,
}

impl Rows {
    /// Opens a table; `-` is the standard input.
    pub(crate) fn open(path: &Path, by: &[String], defaults: Defaults) -> Result<Self, Failure> {
        let mut lines = Lines::open(path)?;
        loop {
            let Some(piece) = lines.piece()? else {
                return Err(Failure::usage(format!("{}: the table is empty", lines.name())));
            };
            let is_header =
                |line: &[u8]| !(line.starts_with(b"#") || line.iter().all(u8::is_ascii_whitespace));
            let header = piece.lines().map(|(n, l)| (n, without_mark(l))).find(|(_, l)| is_header(l));
            let Some((header, line)) = header else { continue };
            let columns = Columns::of_header(line, by, defaults)
                .map_err(|e| Failure::usage(format!("{}: {e}", lines.name())))?;
            return Ok(Self { lines, columns, first: Some(piece), header, comments: 0 });
        }
    }

    /// The results of `work` for the rows of the next piece, in order; `None` at the end.
    pub(crate) fn next<T: Send>(
        &mut self,
        work: impl Fn(u64, Result<Row, BadRow>) -> T + Sync,
    ) -> Result<Option<Vec<T>>, Failure> {
        let piece = match self.first.take() {
            Some(piece) => piece,
            None => match self.lines.piece()? {
                Some(piece) => piece,
                None => return Ok(None),
            },
        };
        let lines: Vec<(u64, &[u8])> = piece.lines().filter(|(number, _)| *number > self.header).collect();
        self.comments += lines.iter().filter(|(_, line)| line.starts_with(b"#")).count();
        let of_share = |splitter: &mut Splitter, share: &[(u64, &[u8])]| -> Vec<T> {
            let of_line =
                |(number, line): &(u64, &[u8])| Some(work(*number, self.columns.row(line, splitter)?));
            share.iter().filter_map(of_line).collect()
        };
        let worked: Vec<Vec<T>> = lines.par_chunks(SHARE).map_init(Splitter::new, of_share).collect();
        Ok(Some(worked.into_iter().flatten().collect()))
    }

    /// Text on the comment lines below the header, to follow a number of rows; empty without such lines.
    pub(super) fn left_out(&self) -> String {
        match self.comments {
            0 => String::new(),
            n => format!(", {} with # left out", grainlab_console::count(n, "line")),
        }
    }

    /// The name of the table in messages.
    pub(crate) fn name(&self) -> &str {
        self.lines.name()
    }
}

/// Some spreadsheets begin their files with a byte order mark.
fn without_mark(line: &[u8]) -> &[u8] {
    line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::invert::answer::Answer;
    use crate::commands::invert::way;

    #[test]
    fn comments_below_the_header_are_counted_and_those_above_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, "# made by hand\np_pa,g12_pa\n5e4,1e8\n#2,1e8\n\n5e4,1e8\n").unwrap();
        let mut rows = Rows::open(&path, &[], Defaults::default()).unwrap();
        let mut found = 0;
        while let Some(piece) = rows.next(|_, row| row.is_ok()).unwrap() {
            found += piece.len();
        }
        assert_eq!((found, rows.left_out().as_str()), (2, ", 1 line with # left out"));
    }

    #[test]
    fn a_mutated_table_gives_answers_or_faults_of_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let held_out = include_str!("../../../../../tests/golden/ensembles/held_out.csv");
        let head: Vec<&str> = held_out.lines().take(6).collect();
        let small = "sample,g12_pa,g13_pa,theta_pa,pressure_pa,phi,gamma_over_delta\nx,1.042e8,1.124e8,1.36e8,5e4,0.633,-0.06\n";
        let ways = way::ways(&[], &["default".to_owned()], None).unwrap();
        fuzzing::Target {
            name: "table",
            seeds: vec![head.join("\n").into_bytes(), small.as_bytes().to_vec()],
            words: &[",", "\"", "g12_pa", "c11_pa", "c33_pa", "phi", "pressure_pa", "k", "eps"],
            memory: (usize::MAX, 0),
            decode: &mut |bytes| {
                std::fs::write(&path, bytes).unwrap();
                let Ok(mut rows) = Rows::open(&path, &[], Defaults::default()) else { return };
                let answer = |number, row: Result<Row, BadRow>| match row {
                    Ok(row) => Answer::of(row.state, Some(number), &ways),
                    Err(bad) => Answer::of_bad_row(bad, number),
                };
                while let Ok(Some(answers)) = rows.next(answer) {
                    answers.iter().for_each(|a| _ = (a.exit(&ways), a.complaint(&ways), a.inferences(&ways)));
                }
            },
        }
        .run();
    }
}
