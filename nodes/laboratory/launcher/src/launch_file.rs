//! Launch files: the YAML form of ROS 2 launch.
//!
//! - `entry`: the actions of a file; `scope`: actions in their order, to processes; `words`: command lines and substitutions

mod entry;
mod scope;
mod words;

use crate::nodes::NodeKind;
use crate::plan::{NodePlan, PlanError};
use entry::{Entry, File, Placed};
use grainlab_console::input;
use scope::Scope;
use std::collections::BTreeMap;
use std::path::Path;
use words::{ADVICE, LONGEST, OF_ROS2};

/// The built-in launch files; the first one is the default.
pub const BUILT_IN: [(&str, &str); 2] = [
    ("demo", include_str!("../../../launch/demo.launch.yaml")),
    ("acoustic", include_str!("../../../launch/acoustic.launch.yaml")),
];

/// The arguments that the launcher sets: name, default under ROS 2, parameter of a node.
const OF_LAUNCHER: [(&str, &str, &str); 3] =
    [("scene", "demo", "scene"), ("seed", "-1", "seed"), ("out", "''", "output")];

/// Maximum number of processes of a run. A member number is one byte: 0 means none, and 255 is the launcher.
const PLACES: usize = 254;

const DIRNAME: &str = "$(dirname)";

/// Levels of files that include each other.
const DEEPEST: usize = 16;
const TOO_DEEP: &str = "more than 16 levels of files include each other";

/// A parsed launch file, with the defaults of its arguments.
#[derive(Debug)]
pub struct LaunchFile {
    text: String,
    entries: Vec<Placed>,
    arguments: Vec<(String, Option<String>)>,
}

impl LaunchFile {
    /// Reads a launch file, and the files that it includes. `$(dirname)` is the folder.
    ///
    /// # Errors
    /// An action, a key or a substitution that is not supported, with its line.
    pub fn parse(text: &str, folder: &Path) -> Result<Self, PlanError> {
        let file = File { launch: read(text, folder, 0)? };
        let mut arguments = Vec::new();
        declared(&file.launch, &mut arguments);
        // A resumed run does not read the included files again: their text is kept with this one.
        let has_others = text.contains(DIRNAME) || text.contains("include");
        let whole = || serde_json::to_string(&file).map_err(|e| PlanError(e.to_string()));
        let text = if has_others { whole()? } else { text.to_owned() };
        Ok(Self { text, entries: file.launch, arguments })
    }

    /// Text of the file, with those that it includes.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The default of an argument, without the quotes of an empty string; `None` if it has no default.
    pub fn default_of(&self, name: &str) -> Option<&str> {
        let (_, default) = self.arguments.iter().find(|(n, _)| n == name)?;
        default.as_deref().map(|d| d.trim_matches('\''))
    }

    /// The processes of a file that has no simulator; `None` if it has one, or no process at all.
    ///
    /// # Errors
    /// As [`LaunchFile::nodes`], of a file that is not given the args of a run.
    pub fn without_run(&self, values: &BTreeMap<&str, String>) -> Result<Option<Vec<NodePlan>>, PlanError> {
        if OF_LAUNCHER.iter().any(|(name, ..)| self.arguments.iter().any(|(declared, _)| declared == name)) {
            return Ok(None);
        }
        let plans = self.processes(values)?;
        let is_run = plans.is_empty() || plans.iter().any(|p| p.is(NodeKind::DemSimulator));
        Ok((!is_run).then_some(plans))
    }

    /// The nodes of a run to start, in order, with these values for arguments.
    ///
    /// # Errors
    /// If the file starts a node that does not exist, or is no file of a run.
    pub fn nodes(&self, values: &BTreeMap<&str, String>) -> Result<Vec<NodePlan>, PlanError> {
        let nodes = self.processes(values)?;
        // The end of one of these nodes ends the run in any case: the key is for the launch of ROS 2.
        let ends_run = |n: &NodePlan| matches!(n.node, Some(NodeKind::DemSimulator | NodeKind::Recorder));
        if let Some(n) = nodes.iter().find(|n| n.ends_all && !ends_run(n)) {
            let reason = "on_exit: in a run \"shutdown\" is supported for dem_simulator and recorder";
            return Err(PlanError::of(&n.name, reason));
        }
        for node in NodeKind::all() {
            let count = nodes.iter().filter(|n| n.is(node)).count();
            if !node.per_run().0.contains(&count) {
                return Err(PlanError::count(node, count));
            }
        }
        Ok(nodes)
    }

    fn processes(&self, values: &BTreeMap<&str, String>) -> Result<Vec<NodePlan>, PlanError> {
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
        if let Some((name, _)) = values.iter().find(|(_, value)| value.len() > LONGEST) {
            return Err(PlanError(format!("the value of the arg {name:?} has more than {LONGEST} bytes")));
        }
        let variables = values.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
        let mut nodes = Vec::new();
        Scope::new(variables).run(&self.entries, &mut nodes)?;
        if nodes.len() > PLACES {
            let count = nodes.len();
            return Err(PlanError(format!(
                "the launch file starts {count} processes; a run has at most {PLACES}"
            )));
        }
        Ok(nodes)
    }
}

/// Returns the actions of a file, with the actions of the files that it includes.
fn read(text: &str, folder: &Path, level: usize) -> Result<Vec<Placed>, PlanError> {
    let here = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let whole = text.replace(DIRNAME, &here.to_string_lossy());
    let format = |e: serde_saphyr::Error| {
        let fault = e.to_string();
        let is_of_ros2 = |word: &str| {
            ["field", "variant"].iter().any(|kind| fault.contains(&format!("unknown {kind} `{word}`")))
        };
        // The error quotes lines of the file: the advice has a line of its own.
        let advice = if fault.contains("expected sequence") {
            format!("\na group is a list of actions, each with its own condition; {ADVICE}")
        } else if OF_ROS2.iter().any(|word| is_of_ros2(word)) {
            format!("\n{ADVICE}")
        } else {
            String::new()
        };
        PlanError(format!("not a launch file that can be run here: {fault}{advice}"))
    };
    // `y` and `on` are texts, as in ROS 2's own reader.
    let options = serde_saphyr::options! { strict_booleans: true };
    let mut file: File = serde_saphyr::from_str_with_options(&whole, options).map_err(format)?;
    include(&mut file.launch, level)?;
    Ok(file.launch)
}

/// Reads the files that these actions include, unless they are there.
fn include(entries: &mut [Placed], level: usize) -> Result<(), PlanError> {
    for Placed { entry, line } in entries {
        match entry {
            Entry::Group(children) => include(children, level)?,
            Entry::Include(i) if i.children.is_none() => {
                let values =
                    i.arg.drain(..).map(|setting| Placed { entry: Entry::Let(setting), line: *line });
                let read = of_file(&i.file, level).map_err(|fault| fault.in_line(*line))?;
                i.children = Some(values.chain(read).collect());
            }
            _ => {}
        }
    }
    Ok(())
}

/// Returns the actions of an included file.
fn of_file(file: &str, level: usize) -> Result<Vec<Placed>, PlanError> {
    let fault = |reason: String| PlanError(reason).included(file);
    if level >= DEEPEST {
        return Err(fault(TOO_DEEP.to_owned()));
    }
    if file.contains("$(") || !(file.ends_with(".yaml") || file.ends_with(".yml")) {
        let expected = "a YAML file by its path, which may begin with $(dirname), is expected";
        return Err(fault(format!("{expected}. {ADVICE}")));
    }
    let path = Path::new(file);
    let text = input::text(path, input::SETTINGS).map_err(|e| fault(e.to_string()))?;
    read(&text, path.parent().unwrap_or(Path::new(".")), level + 1)
        .map_err(|e| if e.0.ends_with(TOO_DEEP) { e } else { fault(e.0) })
}

/// Adds every declared argument with its default.
fn declared(entries: &[Placed], found: &mut Vec<(String, Option<String>)>) {
    for placed in entries {
        match &placed.entry {
            Entry::Arg(a) => found.push((a.name.clone(), a.default.as_ref().map(|d| d.0.clone()))),
            Entry::Group(children) => declared(children, found),
            Entry::Include(include) => declared(include.children.as_deref().unwrap_or_default(), found),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests;
