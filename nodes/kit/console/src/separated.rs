//! Lines of cells as spreadsheets and instruments write them.

use crate::{Failure, input};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read};
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

/// Maximum size of a table that is read as a whole, bytes.
const LARGEST: u64 = 1 << 28;

/// Remedy for text in another encoding.
pub const NOT_UTF8: &str = "it is not UTF-8 text: save it as UTF-8 (spreadsheets call it CSV UTF-8)";

/// Returns the bytes of a text.
///
/// # Errors
/// If it begins with the byte order mark of UTF-16.
pub fn utf8(bytes: &[u8]) -> Result<&[u8], String> {
    let is_utf16 = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
    if is_utf16 { Err(NOT_UTF8.replace("not UTF-8", "UTF-16")) } else { Ok(bytes) }
}

/// Separator of the cells of a header or a line of numbers.
pub fn separator(line: &str) -> char {
    let separates = |s: &char| line.contains(*s) && !(*s == '\t' && line.contains(",\t"));
    [';', '\t', ','].into_iter().find(separates).unwrap_or(' ')
}

/// A cell as a number is written in a program: where semicolons or tabs separate cells, commas are decimal points.
fn with_point(cell: &str, separator: char) -> Cow<'_, str> {
    let number = cell.replacen(',', ".", 1);
    let is_german = [';', '\t'].contains(&separator) && cell.contains(',') && number.parse::<f64>().is_ok();
    if is_german { Cow::Owned(number) } else { Cow::Borrowed(cell) }
}

/// The cells of a line without quotes.
pub fn cells(line: &str, separator: char) -> Vec<Cow<'_, str>> {
    let cell = |cell| with_point(str::trim(cell), separator);
    match separator {
        ' ' => line.split_whitespace().map(cell).collect(),
        _ => line.split(separator).map(cell).collect(),
    }
}

/// A line of a table with commas between its cells.
pub fn with_commas(line: &str, separator: char) -> Cow<'_, str> {
    if [',', ' '].contains(&separator) || line.starts_with('#') {
        return Cow::Borrowed(line);
    }
    let (mut quoted, mut found, mut cell) = (false, Vec::new(), String::new());
    for c in line.chars().chain([separator]) {
        quoted ^= c == '"';
        if c == separator && !quoted {
            let one = with_point(cell.trim(), separator);
            let is_text = one.contains(',') && !one.starts_with('"');
            found.push(if is_text { format!("\"{}\"", one.replace('"', "\"\"")) } else { one.into_owned() });
            cell.clear();
        } else {
            cell.push(c);
        }
    }
    Cow::Owned(found.join(","))
}

/// Returns the name of a file in messages, and its table with commas between the cells. `-` is the standard input. A pipe is
/// read like a file; a device is refused, because it may be endless.
pub fn read(path: &Path) -> Result<(String, String), Failure> {
    let is_input = path.as_os_str() == "-";
    let name = if is_input { "standard input".to_owned() } else { path.display().to_string() };
    let failed = |e: io::Error| Failure::failed(format!("{name}: {e}"));
    let is_pipe = || path.metadata().is_ok_and(|m| m.file_type().is_fifo());
    let source: Box<dyn Read> = match is_input {
        true => Box::new(input::standard()),
        false if is_pipe() => Box::new(File::open(path).map_err(failed)?),
        false => Box::new(input::open(path).map_err(failed)?.0),
    };
    let mut bytes = Vec::new();
    source.take(LARGEST + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > LARGEST {
        return Err(Failure::usage(format!(
            "{name}: it has more than {LARGEST} bytes, the maximum for such a table"
        )));
    }
    let text = table(&bytes).map_err(|fault| Failure::usage(format!("{name}: {fault}")))?;
    Ok((name, text))
}

/// Names a file that is no text by its first bytes, and what to do with it.
pub fn no_text(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [b'P', b'K', 3, 4, ..] => Some("this is an Excel workbook: save it as CSV"),
        [0x1f, 0x8b, ..] => Some("it is compressed by gzip: unpack it first, as by `gunzip -k FILE`"),
        _ => None,
    }
}

/// The text of a table with commas between its cells, line by line.
fn table(bytes: &[u8]) -> Result<String, String> {
    if let Some(what) = no_text(bytes) {
        return Err(what.to_owned());
    }
    let text = std::str::from_utf8(utf8(bytes)?).map_err(|e| {
        let line = 1 + bytes[..e.valid_up_to()].iter().filter(|b| **b == b'\n').count();
        format!("line {line}: {NOT_UTF8}")
    })?;
    let text = text.trim_start_matches('\u{feff}');
    let header = text.lines().find(|line| !line.starts_with('#') && !line.trim().is_empty());
    let separator = separator(header.unwrap_or_default());
    let mut found = String::with_capacity(text.len());
    for line in text.lines() {
        found += &with_commas(line, separator);
        found.push('\n');
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn semicolons_with_decimal_commas_and_tabs_become_commas_on_the_same_lines() {
        let german = "\u{feff}# Sand; fein\r\nsample;speed;x\r\n\r\nA, fein;321,8;\r\n\"B;c\";1,5e3;2\r\n";
        let expected = "# Sand; fein\nsample,speed,x\n\n\"A, fein\",321.8,\n\"B;c\",1.5e3,2\n";
        assert_eq!(table(german.as_bytes()).unwrap(), expected);
        assert_eq!(table(b"a\tb\n1,5\t2\n").unwrap(), "a,b\n1.5,2\n");
        assert_eq!(cells("0,5\t2", separator("0,5\t2")), ["0.5", "2"]);
        assert_eq!(cells("0.5,\t2", separator("0.5,\t2")), ["0.5", "2"]);
        assert_eq!(table(b"a,b\n\"x;y\",2\n").unwrap(), "a,b\n\"x;y\",2\n");
    }

    #[test]
    fn an_excel_workbook_and_a_compressed_file_are_named() {
        assert!(table(b"PK\x03\x04aaaa").unwrap_err().contains("Excel workbook: save it as CSV"));
        assert!(table(b"\x1f\x8b\x08aaaa").unwrap_err().contains("compressed by gzip: unpack it first"));
    }

    #[test]
    fn other_encodings_are_refused_with_their_line_and_a_remedy() {
        for (bytes, line) in
            [(&b"a,b\n1,H\xf6he\n"[..], "line 2"), (&b"\xff\xfea\0,\0b\0\n\0"[..], "it is UTF-16 text")]
        {
            let fault = table(bytes).unwrap_err();
            assert!(fault.contains(line) && fault.contains("save it as UTF-8"), "{fault}");
        }
    }
}
