//! The cells of one line of CSV.

use std::borrow::Cow;

/// Splits at commas. A cell in quotes may hold commas and doubled quotes, but no line break, so that one bad cell cannot
/// swallow the lines after it. Space around a cell is no part of it.
pub(super) fn cells(line: &str) -> Result<Vec<Cow<'_, str>>, String> {
    if !line.contains('"') {
        return Ok(line.split(',').map(|cell| Cow::Borrowed(cell.trim())).collect());
    }
    let mut cells = Vec::new();
    let mut rest = line;
    loop {
        let start = rest.trim_start();
        let Some(quoted) = start.strip_prefix('"') else {
            match rest.split_once(',') {
                Some((cell, after)) => {
                    cells.push(Cow::Borrowed(cell.trim()));
                    rest = after;
                    continue;
                }
                None => {
                    cells.push(Cow::Borrowed(rest.trim()));
                    return Ok(cells);
                }
            }
        };
        let (cell, after) = unquote(quoted)?;
        cells.push(Cow::Owned(cell));
        match after.trim_start() {
            "" => return Ok(cells),
            after => rest = after.strip_prefix(',').ok_or("there is text behind a closing quote")?,
        }
    }
}

/// The cell that `text` is the inside of, and what comes behind its closing quote.
fn unquote(mut text: &str) -> Result<(String, &str), String> {
    let mut cell = String::new();
    loop {
        let (inside, after) = text.split_once('"').ok_or("a quote is not closed on its line")?;
        cell += inside;
        match after.strip_prefix('"') {
            Some(further) => {
                cell.push('"');
                text = further;
            }
            None => return Ok((cell, after)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_cells_hold_commas_and_quotes() {
        for (line, expected) in [
            ("a, b ,", &["a", "b", ""][..]),
            ("", &[""]),
            (r#""x, y",1"#, &["x, y", "1"]),
            (r#"1, "say ""no""" ,3"#, &["1", "say \"no\"", "3"]),
            (r#""","#, &["", ""]),
            (r#"1,a"b,2"#, &["1", "a\"b", "2"]),
        ] {
            assert_eq!(cells(line).unwrap(), expected, "{line}");
        }
    }

    #[test]
    fn quotes_that_do_not_close_are_refused() {
        for line in [r#""a,b"#, r#"1,"a"""#, r#""a"b,c"#] {
            assert!(cells(line).is_err(), "{line}");
        }
    }
}
