//! Lines of cells as spreadsheets and instruments write them.

use grainlab_console::Failure;
use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

/// Remedy for text in another encoding.
pub(crate) const NOT_UTF8: &str = "it is not UTF-8 text: save it as UTF-8 (spreadsheets call it CSV UTF-8)";

/// Separator of the cells of a header or a line of numbers.
pub(crate) fn separator(line: &str) -> char {
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
pub(crate) fn cells(line: &str, separator: char) -> Vec<Cow<'_, str>> {
    let cell = |cell| with_point(str::trim(cell), separator);
    match separator {
        ' ' => line.split_whitespace().map(cell).collect(),
        _ => line.split(separator).map(cell).collect(),
    }
}

/// A line of a table with commas between its cells.
pub(crate) fn with_commas(line: &str, separator: char) -> Cow<'_, str> {
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

/// The name of a file in messages, and its table with commas between the cells; `-` is the standard input.
pub(crate) fn read(path: &Path) -> Result<(String, String), Failure> {
    let is_input = path.as_os_str() == "-";
    let name = if is_input { "standard input".to_owned() } else { path.display().to_string() };
    let mut bytes = Vec::new();
    let read = if is_input {
        std::io::stdin().read_to_end(&mut bytes).map(|_| ())
    } else {
        std::fs::read(path).map(|found| bytes = found)
    };
    read.map_err(|e| Failure::failed(format!("{name}: {e}")))?;
    let text = table(&bytes).map_err(|fault| Failure::usage(format!("{name}: {fault}")))?;
    Ok((name, text))
}

/// The text of a table with commas between its cells, line by line.
fn table(bytes: &[u8]) -> Result<String, String> {
    if bytes.starts_with(b"PK\x03\x04") {
        return Err("this is an Excel workbook: save it as CSV".to_owned());
    }
    let text = std::str::from_utf8(bytes).map_err(|e| {
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
    fn an_excel_workbook_is_named() {
        assert!(table(b"PK\x03\x04aaaa").unwrap_err().contains("Excel workbook: save it as CSV"));
    }

    #[test]
    fn other_encodings_are_refused_with_their_line_and_a_remedy() {
        for (bytes, line) in [(&b"a,b\n1,H\xf6he\n"[..], "line 2"), (&b"\xff\xfea\0,\0b\0\n\0"[..], "line 1")]
        {
            let fault = table(bytes).unwrap_err();
            assert!(fault.contains(line) && fault.contains("save it as UTF-8"), "{fault}");
        }
    }
}
