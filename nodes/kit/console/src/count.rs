//! Counts with their noun.

use std::fmt;

/// A number of things, as in `1 packing` and `2 packings`. `noun` is the singular of a noun whose plural ends in s.
pub fn count(number: impl fmt::Display + PartialEq + From<bool>, noun: &str) -> String {
    let plural = if number == From::from(true) { "" } else { "s" };
    format!("{number} {noun}{plural}")
}

/// A list of parts, as in `a, b and c`.
pub fn and(parts: &[impl AsRef<str>]) -> String {
    let parts: Vec<&str> = parts.iter().map(AsRef::as_ref).collect();
    match parts.as_slice() {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_one_thing_is_singular() {
        let texts = [0_usize, 1, 2].map(|n| count(n, "packing"));
        assert_eq!(texts, ["0 packings", "1 packing", "2 packings"]);
    }
}
