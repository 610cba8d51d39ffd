//! Command lines split into words, and substitutions.

use crate::plan::PlanError;
use std::collections::BTreeMap;

/// What to do with a launch file that has more than is supported here.
pub(super) const ADVICE: &str = "`ros2 launch` runs such a file, with `grainlab run NODE` as executable";

/// Actions and keys of ROS 2 launch that are refused here.
pub(super) const OF_ROS2: &[&str] = &[
    "append_env",
    "choice",
    "composable_node",
    "cwd",
    "emulate_tty",
    "env",
    "launch-prefix",
    "load_composable_node",
    "log",
    "node_container",
    "reset",
    "respawn_delay",
    "respawn_max_retries",
    "ros_args",
    "scoped",
    "set_parameter",
    "set_remap",
    "shell",
    "shutdown",
    "sigkill_timeout",
    "sigterm_timeout",
    "timer",
    "unset",
    "unset_env",
];

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

/// Maximum length of a value and of a text with its values, bytes. A `let` that repeats its own value doubles it each time.
pub(super) const LONGEST: usize = 4096;

/// Substitutes the values of variables. A value is never split.
pub(super) fn substitute(
    word: &str,
    variables: &BTreeMap<String, String>,
    form: impl Fn(&str) -> String,
) -> Result<String, PlanError> {
    let mut out = String::new();
    let mut rest = word;
    while let Some((before, after)) = rest.split_once("$(") {
        let closed = after.split_once(')');
        let found = closed.and_then(|(inside, behind)| Some((inside.strip_prefix("var ")?.trim(), behind)));
        let (name, behind) = found.ok_or_else(|| {
            PlanError(format!(
                "`{word}`: of the substitutions of ROS 2 launch $(var NAME) and $(dirname) are supported. {ADVICE}"
            ))
        })?;
        let value = variables.get(name).ok_or_else(|| {
            let known = variables.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
            PlanError(format!("`{word}`: no arg declares the variable {name:?}; declared are: {known}"))
        })?;
        out += before;
        out += &form(value);
        if out.len() > LONGEST {
            let start: String = word.chars().take(60).collect();
            return Err(PlanError(format!(
                "`{start}`: with its values it has more than {LONGEST} bytes: shorten the variables that it repeats"
            )));
        }
        rest = behind;
    }
    Ok(out + rest)
}
