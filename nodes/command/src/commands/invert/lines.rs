//! The lines of a stream, in pieces of bounded size.

use grainlab_console::Failure;
use grainlab_recordings::input;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

/// Maximum number of bytes read at once: some thousand rows of a few numbers.
const PIECE: usize = 1 << 18;

/// Longest line of a table, bytes. Longer lines are cut after it, so that they cannot fill the memory.
pub(super) const LONGEST: usize = 1 << 20;

/// A longer line is taken as endless.
const ENDLESS: u64 = 64 << 20;

/// A stream of lines.
pub(super) struct Lines {
    source: Box<dyn Read>,
    name: String,
    /// Bytes of the incomplete line.
    rest: Vec<u8>,
    /// Its length, with the bytes that were cut.
    unended: u64,
    /// Number of that line, from 1.
    number: u64,
    ended: bool,
}

/// Complete lines.
pub(super) struct Piece {
    bytes: Vec<u8>,
    first: u64,
}

impl Lines {
    /// Of a file or a pipe; `-` is the standard input. A device is refused, because it may be endless.
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        if path.as_os_str() == "-" {
            return Ok(Self::new(Box::new(std::io::stdin()), "standard input".to_owned()));
        }
        let name = path.display().to_string();
        let failed = |e: std::io::Error| Failure::failed(format!("{name}: {e}"));
        let pipe = std::fs::metadata(path).is_ok_and(|m| m.file_type().is_fifo());
        let file = if pipe { File::open(path) } else { input::open(path).map(|(file, _)| file) };
        let file = file.map_err(failed)?;
        Ok(Self::new(Box::new(file), name))
    }

    pub(super) fn new(source: Box<dyn Read>, name: String) -> Self {
        Self { source, name, rest: Vec::new(), unended: 0, number: 1, ended: false }
    }

    /// Its name in messages.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// The available complete lines, at least one; waits for it. `None` at the end.
    pub(super) fn piece(&mut self) -> Result<Option<Piece>, Failure> {
        let mut taken = vec![0; PIECE];
        while !self.ended {
            let count = match self.source.read(&mut taken) {
                Err(e) if e.kind() == ErrorKind::Interrupted => continue,
                other => other.map_err(|e| Failure::failed(format!("{}: {e}", self.name)))?,
            };
            let new = &taken[..count];
            self.ended = count == 0;
            if let Some(end) = new.iter().rposition(|b| *b == b'\n') {
                let mut bytes = std::mem::replace(&mut self.rest, new[end + 1..].to_vec());
                bytes.extend_from_slice(&new[..end]);
                self.unended = 0;
                return Ok(Some(self.cut(bytes)));
            }
            self.unended += count as u64;
            if self.unended > ENDLESS {
                let problem =
                    format!("line {} has more than {ENDLESS} bytes: this is not a table", self.number);
                return Err(Failure::failed(format!("{}: {problem}", self.name)));
            }
            let room = (LONGEST + 1).saturating_sub(self.rest.len());
            self.rest.extend_from_slice(&new[..count.min(room)]);
        }
        let bytes = std::mem::take(&mut self.rest);
        Ok((!bytes.is_empty()).then(|| self.cut(bytes)))
    }

    fn cut(&mut self, bytes: Vec<u8>) -> Piece {
        let first = self.number;
        self.number += 1 + bytes.iter().filter(|b| **b == b'\n').count() as u64;
        Piece { bytes, first }
    }
}

impl Piece {
    /// Its lines with their numbers, without line ends.
    pub(super) fn lines(&self) -> impl Iterator<Item = (u64, &[u8])> {
        let lines = self.bytes.split(|b| *b == b'\n').map(|l| l.strip_suffix(b"\r").unwrap_or(l));
        (self.first..).zip(lines)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let mut found = Vec::new();
        while let Some(piece) = lines.piece().unwrap() {
            found.extend(piece.lines().map(|(n, l)| (n, l.to_vec())));
        }
        found
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
    fn a_line_without_end_is_cut_and_those_after_it_are_whole() {
        let mut text = vec![b'x'; 3 * LONGEST];
        text.extend_from_slice(b"\nnext\n");
        let found = all(&text, PIECE);
        assert!(found[0].1.len() > LONGEST && found[0].1.len() < LONGEST + 1 + PIECE, "{}", found[0].1.len());
        assert_eq!(found[1], (2, b"next".to_vec()));
    }

    #[test]
    fn a_source_that_never_ends_a_line_is_given_up() {
        let mut lines = Lines::new(Box::new(std::io::repeat(0)), "zeros".into());
        assert!(lines.piece().err().unwrap().to_string().contains("not a table"));
        assert!(Lines::open(Path::new("/dev/zero")).err().unwrap().to_string().contains("device"));
    }
}
