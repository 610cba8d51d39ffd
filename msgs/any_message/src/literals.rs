//! Values in message files: of constants and defaults, as rosidl reads them.

use crate::lines::outside_quotes;
use crate::types::{Element, FieldType, Length, Primitive};

pub(crate) fn check_default(text: &str, kind: &FieldType) -> Result<(), String> {
    let most = match kind.length {
        Length::One => return check(text, &kind.element),
        Length::Fixed(n) | Length::Any(Some(n)) => n as usize,
        Length::Any(None) => usize::MAX,
    };
    let inside = text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    let inside = inside
        .ok_or_else(|| format!("the default {text} of an array is not written in brackets, as in [1, 2]"))?;
    let values = split(inside);
    let is_fixed = matches!(kind.length, Length::Fixed(_));
    if values.len() > most || is_fixed && values.len() != most {
        let bound = if is_fixed { "has" } else { "has at most" };
        return Err(format!("the default {text} has {} values, and the array {bound} {most}", values.len()));
    }
    values.into_iter().try_for_each(|value| check(value, &kind.element))
}

pub(crate) fn check(text: &str, element: &Element) -> Result<(), String> {
    match element {
        Element::Primitive(primitive) => check_primitive(text, *primitive),
        Element::String(bound) | Element::WString(bound) => check_text(text, *bound),
        Element::Message(message) => Err(format!(
            "{text:?} after the name is not understood: a field of type {} has no default, and a line has one field",
            message.name
        )),
    }
}

fn check_primitive(text: &str, primitive: Primitive) -> Result<(), String> {
    let is = |least: i128, most: i128| integer(text).is_some_and(|n| (least..=most).contains(&n));
    let (valid, what) = match primitive {
        Primitive::Bool => (
            ["true", "false", "0", "1"].contains(&text.to_ascii_lowercase().as_str()),
            "true or false".to_owned(),
        ),
        Primitive::F32 | Primitive::F64 => (text.parse::<f64>().is_ok(), "a number".to_owned()),
        integer => {
            let (least, most) = range(integer);
            (is(least, most), format!("an integer from {least} to {most}"))
        }
    };
    match valid {
        true => Ok(()),
        false => Err(format!(
            "{text:?} after the name is not understood: a default or constant of this type is {what}"
        )),
    }
}

fn range(primitive: Primitive) -> (i128, i128) {
    let bits = 8 * primitive.size() as u32;
    match primitive {
        Primitive::I8 | Primitive::I16 | Primitive::I32 | Primitive::I64 => {
            (-(1 << (bits - 1)), (1 << (bits - 1)) - 1)
        }
        _ => (0, (1 << bits) - 1),
    }
}

/// A decimal number, or one with the prefix `0x`, `0o` or `0b`.
fn integer(text: &str) -> Option<i128> {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(digits) => (true, digits),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    if !digits.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let lower = digits.to_ascii_lowercase();
    let radix = |prefix: &str, radix| Some(i128::from_str_radix(lower.strip_prefix(prefix)?, radix).ok());
    let prefixed = radix("0x", 16).or_else(|| radix("0o", 8)).or_else(|| radix("0b", 2));
    let value = prefixed.unwrap_or_else(|| digits.parse().ok())?;
    Some(if negative { -value } else { value })
}

/// A text, with or without quotes; a quote inside its own kind has a backslash before it.
fn check_text(text: &str, bound: Option<u32>) -> Result<(), String> {
    let quoted =
        ['"', '\''].into_iter().find(|q| text.len() > 1 && text.starts_with(*q) && text.ends_with(*q));
    let inner = quoted.map_or(text, |_| &text[1..text.len() - 1]);
    let mut escaped = false;
    for c in inner.chars() {
        if Some(c) == quoted && !escaped {
            return Err(format!("the text {text} has a {c} inside: write \\{c}"));
        }
        escaped = c == '\\' && !escaped;
    }
    match bound.filter(|bound| inner.chars().count() > *bound as usize) {
        Some(bound) => Err(format!("the text {text} is longer than its bound of {bound}")),
        None => Ok(()),
    }
}

/// The parts between commas that are not within quotes.
fn split(inside: &str) -> Vec<&str> {
    if inside.trim().is_empty() {
        return Vec::new();
    }
    let (mut parts, mut from) = (Vec::new(), 0);
    for at in outside_quotes(inside, ',').0.into_iter().chain([inside.len()]) {
        parts.push(inside[from..at].trim());
        from = at + 1;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str, element: Element, length: Length) -> bool {
        check_default(text, &FieldType { element, length }).is_ok()
    }

    #[test]
    fn values_are_within_their_type() {
        let one = |text, primitive| of(text, Element::Primitive(primitive), Length::One);
        for text in ["0", "255", "0xff", "0b11", "+7"] {
            assert!(one(text, Primitive::U8), "{text}");
        }
        for text in ["256", "-1", "b c", "1.5", "0x", "", "1_0", "0x100"] {
            assert!(!one(text, Primitive::U8), "{text}");
        }
        assert!(one("-9223372036854775808", Primitive::I64) && !one("9223372036854775808", Primitive::I64));
        assert!(one("18446744073709551615", Primitive::U64) && !one("-129", Primitive::I8));
        assert!(one("True", Primitive::Bool) && one("0", Primitive::Bool) && !one("yes", Primitive::Bool));
        assert!(one("-1e-3", Primitive::F32) && one("nan", Primitive::F64) && !one("1,5", Primitive::F64));
    }

    #[test]
    fn arrays_and_texts_keep_their_lengths() {
        let numbers = |text, length| of(text, Element::Primitive(Primitive::I32), length);
        assert!(numbers("[1, -2,3]", Length::Fixed(3)) && !numbers("[1, 2]", Length::Fixed(3)));
        assert!(numbers("[]", Length::Any(Some(2))) && !numbers("[1,2,3]", Length::Any(Some(2))));
        assert!(!numbers("1, 2", Length::Any(None)) && !numbers("[1,]", Length::Any(None)));
        let text = |text, bound| of(text, Element::String(bound), Length::One);
        assert!(text("\"a # 'b' \\\" c\"", None) && !text("\"a\" b\"", None) && text("plain words", None));
        assert!(text("'abc'", Some(3)) && !text("'abcd'", Some(3)));
        let texts = |text| of(text, Element::String(None), Length::Any(Some(2)));
        assert!(texts("['a, b', \"c\"]") && !texts("['a', 'b', 'c']"));
    }
}
