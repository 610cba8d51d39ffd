//! Launch files: the YAML form of ROS 2 launch, as much of it as starts our nodes.

use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};

/// The launch files built in; the first is run without another.
pub(crate) const BUILT_IN: [(&str, &str); 2] = [
    ("demo", include_str!("../../../launch/demo.launch.yaml")),
    ("acoustic", include_str!("../../../launch/acoustic.launch.yaml")),
];

/// Why a launch file cannot be run here.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(crate) enum PlanError {
    /// Not YAML, or not this subset of ROS 2 launch.
    #[error("not a launch file that can be run here: {0}")]
    Format(String),
    /// A command that is not one of our nodes.
    #[error(
        "executable `{cmd}`: only `grainlab run NODE ...` is supported; use ros2 launch for anything else"
    )]
    Command { cmd: String },
    /// A substitution other than `$(var NAME)`.
    #[error("`{text}`: only $(var NAME) is supported of the substitutions of ROS 2 launch")]
    Substitution { text: String },
    /// A variable that no `arg` declares.
    #[error("`{text}`: no arg declares the variable {name:?}; declared are: {known}")]
    Undeclared { text: String, name: String, known: String },
    /// A value for an argument that is not declared.
    #[error("the launch file declares no arg {name:?}; declared are: {known}")]
    NoSuchArgument { name: String, known: String },
    /// An argument without default and value.
    #[error("arg {0:?} has no default and no value was given")]
    NoValue(String),
    /// A value of `output` or `respawn` that is not supported.
    #[error("executable {name}: {key}: {value:?} is not supported; use {allowed}")]
    Value { name: String, key: &'static str, value: String, allowed: &'static str },
    /// A name that could not be the name of a log.
    #[error("executable name {0:?}: use lower case letters, digits, _ and - (it names a file)")]
    Name(String),
    /// Two processes would write one log.
    #[error("two executables are called {0:?}: give one of them another name")]
    Twice(String),
    /// A node that no laboratory works without, or with two of.
    #[error("the launch file starts {count} of {node}; there must be one")]
    Count { node: &'static str, count: usize },
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    launch: Vec<Entry>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Entry {
    Arg(Argument),
    Executable(Executable),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Argument {
    name: String,
    default: Option<String>,
    #[serde(rename = "description")]
    _description: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Executable {
    cmd: String,
    name: Option<String>,
    output: Option<String>,
    respawn: Option<String>,
}

/// One node to start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NodePlan {
    /// Name of the process: its log is called so.
    pub(crate) name: String,
    /// Which node.
    pub(crate) node: String,
    /// Arguments of `grainlab`: `run`, the node, its ROS arguments.
    pub(crate) arguments: Vec<String>,
    /// Started again when it ends by itself.
    pub(crate) respawn: bool,
}

impl NodePlan {
    /// A simulator in a domain that nobody else can be in has no rivals to look for, unless it is told to.
    pub(crate) fn do_not_look_around(&mut self) {
        if self.node == "dem_simulator" {
            // Behind `run NODE`: a value of the launch file comes later and wins.
            let given = ["--ros-args", "-p", "look_around:=0.0"].map(str::to_owned);
            self.arguments.splice(2..2, given);
        }
    }
}

/// A launch file that was read, with what its arguments default to.
#[derive(Debug)]
pub(crate) struct LaunchFile {
    arguments: Vec<(String, Option<String>)>,
    executables: Vec<Executable>,
}

impl LaunchFile {
    /// Reads a launch file.
    pub(crate) fn parse(text: &str) -> Result<Self, PlanError> {
        let file: File = serde_saphyr::from_str(text).map_err(|e| PlanError::Format(e.to_string()))?;
        let (mut arguments, mut executables) = (Vec::new(), Vec::new());
        for entry in file.launch {
            match entry {
                Entry::Arg(a) => arguments.push((a.name, a.default)),
                Entry::Executable(e) => executables.push(e),
            }
        }
        Ok(Self { arguments, executables })
    }

    /// The default of an argument without the quotes that keep an empty string a word; `None` if it has none.
    pub(crate) fn default_of(&self, name: &str) -> Option<&str> {
        let (_, default) = self.arguments.iter().find(|(n, _)| n == name)?;
        default.as_deref().map(|d| d.trim_matches('\''))
    }

    /// The nodes to start, in order, with these values for arguments.
    pub(crate) fn nodes(&self, values: &BTreeMap<&str, String>) -> Result<Vec<NodePlan>, PlanError> {
        let known = || self.arguments.iter().map(|(n, _)| n.as_str()).collect::<Vec<_>>().join(", ");
        if let Some(name) = values.keys().find(|k| self.arguments.iter().all(|(n, _)| n != *k)) {
            return Err(PlanError::NoSuchArgument { name: (*name).to_owned(), known: known() });
        }
        let mut variables = BTreeMap::new();
        for (name, default) in &self.arguments {
            let value = values.get(name.as_str()).cloned().or_else(|| default.clone());
            variables.insert(name.as_str(), value.ok_or_else(|| PlanError::NoValue(name.clone()))?);
        }
        let nodes: Vec<NodePlan> =
            self.executables.iter().map(|e| e.plan(&variables)).collect::<Result<_, _>>()?;
        let mut names = BTreeSet::new();
        if let Some(plan) = nodes.iter().find(|n| !names.insert(n.name.as_str())) {
            return Err(PlanError::Twice(plan.name.clone()));
        }
        for node in ["recorder", "dem_simulator"] {
            let count = nodes.iter().filter(|n| n.node == node).count();
            if count != 1 {
                return Err(PlanError::Count { node, count });
            }
        }
        Ok(nodes)
    }
}

impl Executable {
    fn plan(&self, variables: &BTreeMap<&str, String>) -> Result<NodePlan, PlanError> {
        let words = words(&self.cmd, variables)?;
        let [program, run, node, ..] = words.as_slice() else {
            return Err(PlanError::Command { cmd: self.cmd.clone() });
        };
        if program != "grainlab" || run != "run" {
            return Err(PlanError::Command { cmd: self.cmd.clone() });
        }
        let name = self.name.clone().unwrap_or_else(|| node.clone());
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
        if name.is_empty() || !name.chars().all(plain) {
            return Err(PlanError::Name(name));
        }
        let refuse = |key, value: &str, allowed| PlanError::Value {
            name: name.clone(),
            key,
            value: value.into(),
            allowed,
        };
        if let Some(output) = self.output.as_deref().filter(|o| !["screen", "log", "both"].contains(o)) {
            return Err(refuse("output", output, "screen, log or both"));
        }
        let respawn = match self.respawn.as_deref() {
            None => false,
            Some("true" | "True") => true,
            Some("false" | "False") => false,
            Some(other) => return Err(refuse("respawn", other, "true or false")),
        };
        Ok(NodePlan { node: node.clone(), arguments: words[1..].to_vec(), respawn, name })
    }
}

/// Words of a command line: split at blanks outside quotes, then variables put in. A value is never split.
fn words(cmd: &str, variables: &BTreeMap<&str, String>) -> Result<Vec<String>, PlanError> {
    let mut words = Vec::new();
    let mut word = String::new();
    let mut rest = cmd.chars().peekable();
    let (mut quote, mut depth) = (None, 0usize);
    while let Some(c) = rest.next() {
        match c {
            '\'' | '"' if depth == 0 && quote.is_none() => quote = Some(c),
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
                if !word.is_empty() {
                    words.push(std::mem::take(&mut word));
                }
            }
            c => word.push(c),
        }
    }
    if !word.is_empty() {
        words.push(word);
    }
    words.into_iter().map(|w| substitute(&w, variables)).collect()
}

fn substitute(word: &str, variables: &BTreeMap<&str, String>) -> Result<String, PlanError> {
    let mut out = String::new();
    let mut rest = word;
    while let Some((before, after)) = rest.split_once("$(") {
        let text = || word.to_owned();
        let (inside, behind) =
            after.split_once(')').ok_or_else(|| PlanError::Substitution { text: text() })?;
        let name =
            inside.strip_prefix("var ").ok_or_else(|| PlanError::Substitution { text: text() })?.trim();
        let value = variables.get(name).ok_or_else(|| PlanError::Undeclared {
            text: text(),
            name: name.to_owned(),
            known: variables.keys().copied().collect::<Vec<_>>().join(", "),
        })?;
        out += before;
        out += value;
        rest = behind;
    }
    Ok(out + rest)
}

#[cfg(test)]
mod tests;
