//! Launch files: the part of the YAML form of ROS 2 launch that starts processes: grainlab nodes and other
//! programs.

use crate::nodes::{NodeKind, Viewer};
use grainlab_node_kit::{Names, Parameters};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};

/// The built-in launch files; the first one is the default.
pub const BUILT_IN: [(&str, &str); 2] = [
    ("demo", include_str!("../../../launch/demo.launch.yaml")),
    ("acoustic", include_str!("../../../launch/acoustic.launch.yaml")),
];

/// Why a launch file is refused: the place, and what to write instead.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PlanError(pub(crate) String);

impl PlanError {
    /// The fault of one executable.
    pub(crate) fn of(name: &str, reason: impl std::fmt::Display) -> Self {
        Self(format!("executable {name}: {reason}"))
    }

    /// The number of these nodes is not the allowed one.
    pub(crate) fn count(node: NodeKind, count: usize) -> Self {
        Self(format!("the launch file starts {count} of {node}; there must be {}", node.per_run().1))
    }
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
    on_exit: Option<String>,
}

/// The arguments that the launcher sets: name, default under ROS 2, parameter of a node.
const OF_LAUNCHER: [(&str, &str, &str); 3] =
    [("scene", "demo", "scene"), ("seed", "-1", "seed"), ("out", "''", "output")];

/// Topics that are recorded where only packings and results are.
const RESULTS: &str = "topics:=[packing,packing_report,moduli,wave_speeds,microstructure,run_state,energy,diagnostics,tf_static]";

/// Maximum number of processes of a run. A member number is one byte: 0 means none, and 255 is the launcher.
const PLACES: usize = 254;

/// One process to start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodePlan {
    /// Name of the process and of its log.
    pub name: String,
    /// The node of grainlab; `None` for a third-party program.
    pub node: Option<NodeKind>,
    /// The program; for a grainlab node, any `grainlab` means this binary.
    pub program: String,
    /// Arguments; for a node: `run`, the node, its ROS arguments.
    pub arguments: Vec<String>,
    /// True if it is restarted when it ends by itself.
    pub respawn: bool,
}

impl NodePlan {
    /// True if it is this node of grainlab.
    pub fn is(&self, node: NodeKind) -> bool {
        self.node == Some(node)
    }

    /// Refuses parameters that its node does not have, or whose values it does not take, before anything is started.
    ///
    /// # Errors
    /// If there is such a parameter; the text names the process, the parameter and its valid values.
    pub fn check_parameters(&self) -> Result<(), PlanError> {
        self.parsed().map(drop)
    }

    /// The node with the names of its topics and the values of its parameters; `None` for a third-party program.
    pub(crate) fn parsed(&self) -> Result<Option<(NodeKind, Names, Parameters)>, PlanError> {
        let Some(node) = self.node else { return Ok(None) };
        // After `run NODE`.
        let parsed = node.parse(&self.arguments[2..]);
        let (names, parameters) = parsed.map_err(|reason| PlanError::of(&self.name, reason))?;
        Ok(Some((node, names, parameters)))
    }

    /// Sets the parameters of a simulator whose run is supervised. It does not look for duplicates, unless the launch file
    /// sets it. It does not end by itself: the launcher ends it after the results, and a restarted reader needs its packing.
    pub fn supervised(&mut self) {
        if self.is(NodeKind::DemSimulator) {
            // The last value of a parameter takes precedence: this one is before those of the launch file, after `run NODE`.
            let given = ["--ros-args", "-p", "look_around:=0.0"].map(str::to_owned);
            self.arguments.splice(2..2, given);
            self.insist(&["exit_when_finished:=false"]);
        }
    }

    /// Sets parameters of the node; they take precedence over those of the launch file.
    fn insist(&mut self, parameters: &[&str]) {
        for given in parameters {
            self.arguments.extend(["--ros-args", "-p", given].map(str::to_owned));
        }
    }

    /// Records packings and results alone: no other node waits for a recorder of the lockstep.
    pub fn record_results(&mut self) {
        match self.node {
            Some(NodeKind::Recorder) => self.insist(&[RESULTS]),
            Some(NodeKind::DemSimulator) => self.insist(&["wait_for:=[packing]"]),
            Some(NodeKind::ServoController) => self.insist(&["min_readers:=1"]),
            _ => {}
        }
    }

    /// Makes ready for one process with the servo: the answer is there at once, and nothing is gained by a speculative step.
    pub fn composed(&mut self) {
        if self.is(NodeKind::DemSimulator) {
            self.insist(&["ahead:=false"]);
        }
    }
}

/// A parsed launch file, with the defaults of its arguments.
#[derive(Debug)]
pub struct LaunchFile {
    text: String,
    arguments: Vec<(String, Option<String>)>,
    executables: Vec<Executable>,
}

impl LaunchFile {
    /// Reads a launch file.
    pub fn parse(text: &str) -> Result<Self, PlanError> {
        let format = |e| PlanError(format!("not a launch file that can be run here: {e}"));
        let file: File = serde_saphyr::from_str(text).map_err(format)?;
        let (mut arguments, mut executables) = (Vec::new(), Vec::new());
        for entry in file.launch {
            match entry {
                Entry::Arg(a) => arguments.push((a.name, a.default)),
                Entry::Executable(e) => executables.push(e),
            }
        }
        Ok(Self { text: text.to_owned(), arguments, executables })
    }

    /// Text of the file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The default of an argument, without the quotes of an empty string; `None` if it has no default.
    pub fn default_of(&self, name: &str) -> Option<&str> {
        let (_, default) = self.arguments.iter().find(|(n, _)| n == name)?;
        default.as_deref().map(|d| d.trim_matches('\''))
    }

    /// The nodes to start, in order, with these values for arguments.
    ///
    /// # Errors
    /// If the file starts a node that is neither of the laboratory nor among `viewers`, or is no file of a run.
    pub fn nodes(
        &self,
        values: &BTreeMap<&str, String>,
        viewers: &'static [Viewer],
    ) -> Result<Vec<NodePlan>, PlanError> {
        let known = || self.arguments.iter().map(|(n, _)| n.as_str()).collect::<Vec<_>>().join(", ");
        if let Some(name) = values.keys().find(|k| self.arguments.iter().all(|(n, _)| n != *k)) {
            if let Some((name, default, parameter)) = OF_LAUNCHER.into_iter().find(|(n, ..)| n == name) {
                return Err(PlanError(format!(
                    "the launch file does not declare the arg {name:?}, which grainlab launch sets in each run, as scene, seed and \
                     out. Add to it:\n- arg: {{name: {name}, default: \"{default}\"}}\nand hand it on, as in \
                     `-p {parameter}:=$(var {name})`"
                )));
            }
            let declared = format!("the launch file declares no arg {name:?}; declared are: {}", known());
            return Err(PlanError(declared));
        }
        let mut variables = BTreeMap::new();
        for (name, default) in &self.arguments {
            let value = values.get(name.as_str()).cloned().or_else(|| default.clone());
            let none = || PlanError(format!("arg {name:?} has no default and no value was given"));
            variables.insert(name.as_str(), value.ok_or_else(none)?);
        }
        let nodes: Vec<NodePlan> =
            self.executables.iter().map(|e| e.plan(&variables, viewers)).collect::<Result<_, _>>()?;
        let mut names = BTreeSet::new();
        if let Some(plan) = nodes.iter().find(|n| !names.insert(n.name.as_str())) {
            let name = &plan.name;
            return Err(PlanError(format!(
                "two executables are called {name:?}: give one of them another name"
            )));
        }
        if nodes.len() > PLACES {
            let count = nodes.len();
            return Err(PlanError(format!(
                "the launch file starts {count} processes; a run has at most {PLACES}"
            )));
        }
        for node in NodeKind::all(viewers) {
            let count = nodes.iter().filter(|n| n.is(node)).count();
            if !node.per_run().0.contains(&count) {
                return Err(PlanError::count(node, count));
            }
        }
        Ok(nodes)
    }
}

impl Executable {
    fn plan(
        &self,
        variables: &BTreeMap<&str, String>,
        viewers: &'static [Viewer],
    ) -> Result<NodePlan, PlanError> {
        let command = || {
            PlanError(format!(
                "executable `{}`: write `grainlab run NODE ...`, or a program with its arguments",
                self.cmd
            ))
        };
        let words = words(&self.cmd).ok_or_else(command)?;
        let named = match words.as_slice() {
            [program, run, node, ..] if program == "grainlab" && run == "run" => Some(node.as_str()),
            [program, ..] if program != "grainlab" && !program.is_empty() => None,
            _ => return Err(command()),
        };
        let value = |name: &str| {
            let value = variables.get(name)?;
            // Parameters of nodes are YAML, in which a path is quoted; a third-party program gets the plain path.
            let plain =
                || serde_json::from_str(value).unwrap_or_else(|_| value.trim_matches('\'').to_owned());
            Some(if named.is_some() { value.clone() } else { plain() })
        };
        let known = || variables.keys().copied().collect::<Vec<_>>().join(", ");
        let words: Vec<String> =
            words.iter().map(|word| substitute(word, value, known)).collect::<Result<_, _>>()?;
        let (program, arguments) = (words[0].clone(), words[1..].to_vec());
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
        let by_itself = || {
            let file = std::path::Path::new(&program).file_stem();
            let stem = file.map_or_else(|| program.clone(), |f| f.to_string_lossy().into_owned());
            stem.to_ascii_lowercase().chars().map(|c| if plain(c) { c } else { '_' }).collect()
        };
        let name = self.name.clone().or_else(|| named.map(str::to_owned)).unwrap_or_else(by_itself);
        if name.is_empty() || !name.chars().all(plain) {
            return Err(PlanError(format!(
                "executable name {name:?}: use lower case letters, digits, _ and - (it names a file)"
            )));
        }
        let refuse = |key: &str, value: &str, allowed: &str| {
            PlanError::of(&name, format!("{key}: {value:?} is not supported; use {allowed}"))
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
        let node = named.map(|name| NodeKind::named(name, viewers)).transpose();
        let node = node.map_err(|unknown| PlanError::of(&name, format!("there is {unknown}")))?;
        // The end of one of these nodes ends the run in any case: the key is for the launch of ROS 2.
        let ends_run = matches!(node, Some(NodeKind::DemSimulator | NodeKind::Recorder));
        if let Some(on_exit) = self.on_exit.as_deref().filter(|o| *o != "shutdown" || !ends_run) {
            return Err(refuse("on_exit", on_exit, "shutdown, for dem_simulator and recorder"));
        }
        Ok(NodePlan { node, program, arguments, respawn, name })
    }
}

/// Words of a command line, split at spaces outside quotes; `None` if a quote is not closed.
fn words(cmd: &str) -> Option<Vec<String>> {
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
fn substitute(
    word: &str,
    value: impl Fn(&str) -> Option<String>,
    known: impl Fn() -> String,
) -> Result<String, PlanError> {
    let mut out = String::new();
    let mut rest = word;
    while let Some((before, after)) = rest.split_once("$(") {
        let variable =
            after.split_once(')').and_then(|(inside, rest)| Some((inside.strip_prefix("var ")?, rest)));
        let (name, behind) = variable.ok_or_else(|| {
            PlanError(format!("`{word}`: only $(var NAME) is supported of the substitutions of ROS 2 launch"))
        })?;
        let name = name.trim();
        let undeclared =
            || format!("`{word}`: no arg declares the variable {name:?}; declared are: {}", known());
        let value = value(name).ok_or_else(|| PlanError(undeclared()))?;
        out += before;
        out += &value;
        rest = behind;
    }
    Ok(out + rest)
}

#[cfg(test)]
mod tests;
