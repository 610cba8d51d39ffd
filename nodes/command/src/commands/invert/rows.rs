//! The rows of a table, in pieces, distributed over several threads.

use super::columns::{BadRow, Columns, Row};
use super::state::State;
use grainlab_console::{Failure, separated};
use grainlab_recordings::input;
use rayon::prelude::*;
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

/// Number of bytes read at once: some thousand rows of a few numbers.
const PIECE: usize = 1 << 18;

/// A longer line is taken as endless, bytes.
const ENDLESS: u64 = 64 << 20;

/// Rows that one thread takes at a time.
const SHARE: usize = 32;

type Line = (u64, Vec<u8>);

struct Lines {
    source: BufReader<Box<dyn Read>>,
    name: String,
    /// Number of the last line read, from 1.
    number: u64,
    separator: char,
}

impl Lines {
    /// Opens a file or a pipe; `-` is the standard input. A device is refused, because it may be endless.
    fn open(path: &Path) -> Result<Self, Failure> {
        if path.as_os_str() == "-" {
            return Ok(Self::new(Box::new(input::standard()), "standard input".to_owned()));
        }
        let name = path.display().to_string();
        let pipe = std::fs::metadata(path).is_ok_and(|m| m.file_type().is_fifo());
        let file = if pipe { File::open(path) } else { input::open(path).map(|(file, _)| file) };
        let file = file.map_err(|e| Failure::failed(format!("{name}: {e}")))?;
        Ok(Self::new(Box::new(file), name))
    }

    fn new(source: Box<dyn Read>, name: String) -> Self {
        Self { source: BufReader::with_capacity(PIECE, source), name, number: 0, separator: ',' }
    }

    /// The next line without its end; `None` at the end.
    fn line(&mut self) -> Result<Option<Vec<u8>>, Failure> {
        let mut line = Vec::new();
        let read = self.source.by_ref().take(ENDLESS).read_until(b'\n', &mut line);
        let read = read.map_err(|e| Failure::failed(format!("{}: {e}", self.name)))? as u64;
        self.number += 1;
        if line.pop_if(|b| *b == b'\n').is_some() {
            line.pop_if(|b| *b == b'\r');
        } else if read == ENDLESS {
            let Self { name, number, .. } = self;
            return Err(Failure::failed(format!(
                "{name}: line {number} has more than {ENDLESS} bytes: this is not a table"
            )));
        }
        Ok((read > 0).then_some(line))
    }

    /// A line with commas between its cells; one that is not UTF-8 as it is.
    fn with_commas(&self, line: Vec<u8>) -> Vec<u8> {
        match std::str::from_utf8(&line) {
            Ok(text) if ![',', ' '].contains(&self.separator) => {
                separated::with_commas(text, self.separator).into_owned().into_bytes()
            }
            _ => line,
        }
    }

    /// The available complete lines with their numbers, at least one; waits for it. `None` at the end.
    fn piece(&mut self) -> Result<Option<Vec<Line>>, Failure> {
        let mut lines = Vec::new();
        while let Some(line) = self.line()? {
            lines.push((self.number, self.with_commas(line)));
            if !self.source.buffer().contains(&b'\n') {
                break;
            }
        }
        Ok((!lines.is_empty()).then_some(lines))
    }
}

/// The first line that is not a comment, and the stream of lines below it.
pub(crate) struct Rows {
    lines: Lines,
    pub(crate) columns: Columns,
    /// Number of lines below it so far that begin with `#`.
    comments: usize,
}

impl Rows {
    /// Opens a table; `-` is the standard input.
    pub(crate) fn open(path: &Path, by: &[&[String]], defaults: State) -> Result<Self, Failure> {
        Self::below_header(Lines::open(path)?, by, defaults)
    }

    pub(super) fn of_text(text: Vec<u8>, defaults: State) -> Result<Self, Failure> {
        Self::below_header(Lines::new(Box::new(Cursor::new(text)), "table".to_owned()), &[], defaults)
    }

    fn below_header(mut lines: Lines, by: &[&[String]], defaults: State) -> Result<Self, Failure> {
        while let Some(line) = lines.line()? {
            // Some spreadsheets begin their files with a byte order mark.
            let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&line);
            if line.starts_with(b"#") || line.iter().all(u8::is_ascii_whitespace) {
                continue;
            }
            if let Some(what) = separated::no_text(line) {
                return Err(Failure::usage(format!("{}: {what}", lines.name)));
            }
            lines.separator = std::str::from_utf8(line).map_or(',', separated::separator);
            let line = lines.with_commas(line.to_vec());
            let columns = Columns::of_header(&line, by, defaults)
                .map_err(|e| Failure::usage(format!("{}: {e}", lines.name)))?;
            return Ok(Self { lines, columns, comments: 0 });
        }
        Err(Failure::usage(format!("{}: the table is empty", lines.name)))
    }

    /// The results of `work` for the rows of the next piece, in order; `None` at the end.
    pub(crate) fn next<T: Send>(
        &mut self,
        work: impl Fn(u64, Result<Row, BadRow>) -> T + Sync,
    ) -> Result<Option<Vec<T>>, Failure> {
        let Some(lines) = self.lines.piece()? else { return Ok(None) };
        self.comments += lines.iter().filter(|(_, line)| line.starts_with(b"#")).count();
        let of_line = |(number, line): &Line| Some(work(*number, self.columns.row(line)?));
        Ok(Some(lines.par_iter().with_min_len(SHARE).filter_map(of_line).collect()))
    }

    /// Text on the comment lines below the header, to follow a number of rows; empty without such lines.
    pub(super) fn left_out(&self) -> String {
        match self.comments {
            0 => String::new(),
            n => format!(", {} with # left out", grainlab_console::count(n, "line")),
        }
    }

    pub(crate) fn name(&self) -> &str {
        &self.lines.name
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::invert::answer::Answer;
    use crate::commands::invert::case;

    /// Returns at most `step` bytes at a time, like a pipe.
    struct Pipe {
        text: Vec<u8>,
        step: usize,
    }

    impl Read for Pipe {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            let count = self.step.min(buffer.len()).min(self.text.len());
            buffer[..count].copy_from_slice(&self.text[..count]);
            self.text.drain(..count);
            Ok(count)
        }
    }

    fn all(text: &[u8], step: usize) -> Vec<(u64, Vec<u8>)> {
        let mut lines = Lines::new(Box::new(Pipe { text: text.to_vec(), step }), "pipe".into());
        std::iter::from_fn(|| lines.piece().unwrap()).flatten().collect()
    }

    #[test]
    fn lines_do_not_depend_on_how_the_bytes_come() {
        let text = b"one\r\ntwo\n\nfour, and no end";
        let expected: Vec<(u64, Vec<u8>)> =
            (1..).zip([&b"one"[..], b"two", b"", b"four, and no end"].map(<[u8]>::to_vec)).collect();
        for step in 1..=text.len() + 1 {
            assert_eq!(all(text, step), expected, "{step} bytes at a time");
        }
    }

    #[test]
    fn a_source_that_never_ends_a_line_is_given_up() {
        let mut lines = Lines::new(Box::new(std::io::repeat(0)), "zeros".into());
        assert!(lines.piece().err().unwrap().to_string().contains("not a table"));
        assert!(Lines::open(Path::new("/dev/zero")).err().unwrap().to_string().contains("device"));
    }

    #[test]
    fn comments_below_the_header_are_counted_and_those_above_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, "# made by hand\np_pa,g12_pa\n5e4,1e8\n#2,1e8\n\n5e4,1e8\n").unwrap();
        let mut rows = Rows::open(&path, &[], State::default()).unwrap();
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
        let cases = case::cases(&[], &["default".to_owned()], None).unwrap();
        fuzzing::Target {
            name: "table",
            seeds: vec![head.join("\n").into_bytes(), small.as_bytes().to_vec()],
            words: &[",", "\"", "g12_pa", "c11_pa", "c33_pa", "phi", "pressure_pa", "k", "eps"],
            memory: (usize::MAX, 0),
            decode: &mut |bytes| {
                std::fs::write(&path, bytes).unwrap();
                let Ok(mut rows) = Rows::open(&path, &[], State::default()) else { return };
                let answer = |number, row: Result<Row, BadRow>| match row {
                    Ok(row) => Answer::of(row.state, Some(number), &cases),
                    Err(bad) => Answer::of_bad_row(bad, number),
                };
                while let Ok(Some(answers)) = rows.next(answer) {
                    answers
                        .iter()
                        .for_each(|a| _ = (a.exit(&cases), a.complaint(&cases), a.inferences(&cases)));
                }
            },
        }
        .run();
    }
}
