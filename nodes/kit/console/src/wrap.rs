//! Text in lines of a terminal.

/// Columns of a terminal that every text fits into.
pub const COLUMNS: usize = 80;

/// The words of a text in lines of at most [`COLUMNS`], each with a newline: `first` precedes the first line, and as many spaces each
/// other one. A word that is longer has a line of its own.
pub fn wrapped(first: &str, text: &str) -> String {
    let indent = first.chars().count();
    let (mut lines, mut line, mut columns) = (String::new(), first.to_owned(), indent);
    let mut is_empty = true;
    for word in text.split_whitespace() {
        let width = word.chars().count();
        if !is_empty && columns + 1 + width > COLUMNS {
            lines += &line;
            lines.push('\n');
            (line, columns, is_empty) = (" ".repeat(indent), indent, true);
        }
        if !is_empty {
            line.push(' ');
            columns += 1;
        }
        line += word;
        (columns, is_empty) = (columns + width, false);
    }
    lines + line.trim_end() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_line_is_longer_than_a_terminal_but_one_long_word() {
        let text = wrapped("  note: ", &"a word and 123 ".repeat(20));
        assert!(text.lines().all(|l| l.chars().count() <= COLUMNS) && text.lines().count() == 5, "{text}");
        assert!(
            text.lines().skip(1).all(|l| l.starts_with("        ") && !l.starts_with("         ")),
            "{text}"
        );
        let long = "x".repeat(100);
        assert_eq!(wrapped("a ", &format!("b {long} c")), format!("a b\n  {long}\n  c\n"));
    }
}
