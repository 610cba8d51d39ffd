//! Suggestions for an unknown word.

/// Longer words are not compared, because the cost of a distance is the product of both lengths.
const LONGEST: usize = 64;

/// The known word nearest to `word`, and not the same, if it differs by one or two letters or has the same beginning.
pub(crate) fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    if word.len() > LONGEST {
        return None;
    }
    let known = known.filter(|k| k.len() <= LONGEST && *k != word);
    let distance = |k: &str| strsim::damerau_levenshtein(word, k);
    let near = |k: &&str| distance(k) <= (k.chars().count() / 3).max(1) || is_start(word, k);
    known.filter(near).min_by_key(|k| distance(k)).map(str::to_owned)
}

fn is_start(word: &str, known: &str) -> bool {
    word.len().min(known.len()) >= 3 && (known.starts_with(word) || word.starts_with(known))
}

pub(crate) fn hint(meant: &str) -> String {
    format!(" (did you mean {meant}?)")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_recognised_and_another_word_is_not() {
        let of = |word| nearest(word, ["friction", "damping", "drag", "count"].into_iter());
        assert_eq!(of("friktion").as_deref(), Some("friction"));
        assert_eq!(of("cuont").as_deref(), Some("count"));
        assert_eq!(of("fric").as_deref(), Some("friction"));
        assert_eq!(of("colour"), None);
        assert_eq!(of("friction"), None);
    }
}
