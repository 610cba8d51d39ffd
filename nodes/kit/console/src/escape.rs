//! Text that a terminal prints and does not obey.
//!
//! A name from another process, a file or the network may hold escape sequences, which would change colours, move the cursor or
//! hide a line, and characters that reverse the direction of writing.

use std::borrow::Cow;

/// Returns `text` with every character escaped that a terminal obeys, except the ends of lines and tabs.
pub fn escape_controls(text: &str) -> Cow<'_, str> {
    escape(text, |c| is_obeyed(c) && !matches!(c, '\n' | '\t'))
}

/// Returns `name` as one line: ends of lines and tabs are escaped, as [`escape_controls`] escapes the rest.
pub fn escape_name(name: &str) -> Cow<'_, str> {
    escape(name, is_obeyed)
}

fn escape(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if is_escaped(c) { escaped.extend(c.escape_default()) } else { escaped.push(c) }
    }
    Cow::Owned(escaped)
}

/// True for control characters (Unicode category Cc), separators of lines, and the marks that change the direction of writing.
fn is_obeyed(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_character_that_a_terminal_obeys_is_left_and_all_others_stay() {
        let text = "<img>\u{1b}[31m red \u{9b}31m\u{7f}\r\u{202e}\n\tε ± 0.1 “ok” 日本";
        let escaped = "<img>\\u{1b}[31m red \\u{9b}31m\\u{7f}\\r\\u{202e}\n\tε ± 0.1 “ok” 日本";
        assert_eq!(escape_controls(text), escaped);
        assert_eq!(escape_name("a\nb\tc"), "a\\nb\\tc");
        assert!(matches!(escape_controls("z 4.7\n"), Cow::Borrowed(_)));
    }
}
