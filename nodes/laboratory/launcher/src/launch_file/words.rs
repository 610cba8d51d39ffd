//! Command lines split into words, and substitutions.

use crate::plan::PlanError;

/// Words of a command line, split at spaces outside quotes; `None` if a quote is not closed.
pub(super) fn words(cmd: &str) -> Option<Vec<String>> {
    let mut words = Vec::new();
    // Two quotes with nothing between them are an empty word.
    let (mut word, mut quoted) = (String::new(), false);
    let mut rest = cmd.chars().peekable();
    let (mut quote, mut depth) = (None, 0usize);
    while let Some(c) = rest.next() {
        match c {
            '\'' | '"' if depth == 0 && quote.is_none() => (quote, quoted) = (Some(c), true),
            c if quote == Some(c) => quote = None,
            '$' if rest.peek() == Some(&'(') => {
                depth += 1;
                word.push(c);
            }
            ')' if depth > 0 => {
                depth -= 1;
                word.push(c);
            }
            c if c.is_whitespace() && quote.is_none() && depth == 0 => {
                if !word.is_empty() || std::mem::take(&mut quoted) {
                    words.push(std::mem::take(&mut word));
                }
                quoted = false;
            }
            c => word.push(c),
        }
    }
    if !word.is_empty() || quoted {
        words.push(word);
    }
    quote.is_none().then_some(words)
}

/// Substitutes the values of variables. A value is never split.
pub(super) fn substitute(
    word: &str,
    value: impl Fn(&str) -> Option<String>,
    known: impl Fn() -> String,
) -> Result<String, PlanError> {
    let mut out = String::new();
    let mut rest = word;
    while let Some((before, after)) = rest.split_once("$(") {
        let closed = after.split_once(')').and_then(|(inside, rest)| Some((inside.split_once(' ')?, rest)));
        let found = match closed {
            Some((("var", name), behind)) => {
                let name = name.trim();
                let undeclared = || {
                    let known = known();
                    PlanError(format!(
                        "`{word}`: no arg declares the variable {name:?}; declared are: {known}"
                    ))
                };
                Some((value(name).ok_or_else(undeclared)?, behind))
            }
            Some((("env", name), behind)) => {
                let (name, default) =
                    name.trim().split_once(' ').map_or((name.trim(), None), |(n, d)| (n, Some(d)));
                let found = std::env::var(name)
                    .ok()
                    .or_else(|| default.map(|d| d.trim_matches(['\'', '"']).to_owned()));
                let unset = || {
                    PlanError(format!(
                        "`{word}`: the environment has no variable {name}, and there is no default"
                    ))
                };
                Some((found.ok_or_else(unset)?, behind))
            }
            _ => None,
        };
        let (found, behind) = found.ok_or_else(|| {
            PlanError(format!("`{word}`: of the substitutions of ROS 2 launch $(var NAME), $(env NAME DEFAULT) and $(dirname) are supported"))
        })?;
        out += before;
        out += &found;
        rest = behind;
    }
    Ok(out + rest)
}
