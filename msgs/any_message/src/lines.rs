//! One line of a message file.

use crate::names::{check_constant, check_field};

/// A field or a constant, before its type is looked up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Declaration<'a> {
    pub(crate) type_text: &'a str,
    pub(crate) name: &'a str,
    pub(crate) constant: Option<&'a str>,
    pub(crate) default: Option<&'a str>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TypeText<'a> {
    pub(crate) base: &'a str,
    /// Bound of a string.
    pub(crate) bound: Option<u32>,
    /// `[]`, `[3]` or `[<=3]`.
    pub(crate) array: Option<ArrayText>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArrayText {
    Fixed(u32),
    Any(Option<u32>),
}

/// The declaration in a line; `None` for an empty line or a comment.
pub(crate) fn declaration(line: &str) -> Result<Option<Declaration<'_>>, String> {
    let line = without_comment(line).trim();
    if line.is_empty() {
        return Ok(None);
    }
    let (type_text, rest) = line
        .split_once(char::is_whitespace)
        .ok_or_else(|| format!("{line:?} is not a field: write a type and a name, as in float64 x"))?;
    let rest = rest.trim_start();
    let end = rest.find(|c: char| c.is_whitespace() || c == '=').unwrap_or(rest.len());
    let (name, rest) = rest.split_at(end);
    let rest = rest.trim();
    let (constant, default) = match rest.strip_prefix('=') {
        Some(value) => (Some(value.trim()), None),
        None if rest.is_empty() => (None, None),
        None => (None, Some(rest)),
    };
    if constant.is_some() { check_constant(name) } else { check_field(name) }?;
    Ok(Some(Declaration { type_text, name, constant, default }))
}

/// Places of a character that are not within quotes, and whether a quote is open at the end.
pub(crate) fn outside_quotes(text: &str, wanted: char) -> (Vec<usize>, bool) {
    let (mut places, mut quote, mut escaped) = (Vec::new(), None, false);
    for (at, c) in text.char_indices() {
        match (c, quote) {
            _ if escaped => escaped = false,
            ('\\', Some(_)) => escaped = true,
            (c, None) if c == wanted => places.push(at),
            ('"' | '\'', None) => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            _ => {}
        }
    }
    (places, quote.is_some())
}

/// The line before a `#` that is not within quotes.
fn without_comment(line: &str) -> &str {
    match outside_quotes(line, '#') {
        (places, _) if !places.is_empty() => &line[..places[0]],
        // A single quote that is never closed is an apostrophe.
        (_, true) => line.split('#').next().unwrap_or(line),
        _ => line,
    }
}

/// The parts of `string<=10[<=3]` and the like.
pub(crate) fn type_text(text: &str) -> Result<TypeText<'_>, String> {
    let number = |digits: &str| {
        let length =
            digits.parse::<u32>().ok().filter(|n| *n > 0 && digits.bytes().all(|b| b.is_ascii_digit()));
        length.ok_or_else(|| format!("{digits:?} in {text} is not a length: write a whole number, 1 or more"))
    };
    let (inner, array) = match text.split_once('[') {
        None => (text, None),
        Some((inner, rest)) => {
            let inside = rest.strip_suffix(']').ok_or_else(|| {
                format!(
                    "{text} does not end with the bracket of an array: write [], [3] or [<=3], without spaces"
                )
            })?;
            let array = match (inside, inside.strip_prefix("<=")) {
                ("", _) => ArrayText::Any(None),
                (_, Some(bound)) => ArrayText::Any(Some(number(bound)?)),
                (fixed, None) => ArrayText::Fixed(number(fixed)?),
            };
            (inner, Some(array))
        }
    };
    let (base, bound) = match inner.split_once("<=") {
        None => (inner, None),
        Some((base, bound)) => (base, Some(number(bound)?)),
    };
    if bound.is_some() && !matches!(base, "string" | "wstring") {
        return Err(format!("{text}: only strings and arrays have a bound, as in string<=10 or uint8[<=10]"));
    }
    Ok(TypeText { base, bound, array })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(line: &str) -> (&str, &str, Option<&str>, Option<&str>) {
        let d = declaration(line).unwrap().unwrap();
        (d.type_text, d.name, d.constant, d.default)
    }

    #[test]
    fn comments_defaults_and_constants_are_told_apart() {
        assert_eq!(declaration("   # a comment").unwrap(), None);
        assert_eq!(parts("float64 x# m"), ("float64", "x", None, None));
        assert_eq!(parts("uint8  MAX = 3 # three"), ("uint8", "MAX", Some("3"), None));
        assert_eq!(parts("string s \"a # b = c\"  # d"), ("string", "s", None, Some("\"a # b = c\"")));
        assert_eq!(parts("string S='it\\'s # 1' # c"), ("string", "S", Some("'it\\'s # 1'"), None));
        assert_eq!(parts("string S=it's # c"), ("string", "S", Some("it's"), None));
        assert_eq!(parts("string s \"a=b\""), ("string", "s", None, Some("\"a=b\"")));
        assert_eq!(parts("int32[] a [1, 2]"), ("int32[]", "a", None, Some("[1, 2]")));
        assert!(declaration("float64").is_err() && declaration("float64 a-b").is_err());
    }

    #[test]
    fn lengths_and_bounds_are_read_and_wrong_ones_are_errors() {
        let of = |text| type_text(text).map(|t| (t.base, t.bound, t.array));
        assert_eq!(of("string<=10[<=3]"), Ok(("string", Some(10), Some(ArrayText::Any(Some(3))))));
        assert_eq!(of("a_msgs/B[6]"), Ok(("a_msgs/B", None, Some(ArrayText::Fixed(6)))));
        assert_eq!(of("byte[]"), Ok(("byte", None, Some(ArrayText::Any(None)))));
        for wrong in [
            "int8[",
            "int8[-1]",
            "int8[0]",
            "int8[+1]",
            "int8[99999999999]",
            "int8<=3",
            "string<=x",
            "int8[]x",
            "int8[1,2",
        ] {
            assert!(type_text(wrong).is_err(), "{wrong}");
        }
    }
}
