//! Launch files: the YAML form of ROS 2 launch.
//!
//! - `entry`: the actions of a file; `scope`: actions in their order, to processes; `words`: command lines and substitutions

mod entry;
mod scope;
mod words;

use crate::nodes::{NodeKind, Viewer};
use crate::plan::{NodePlan, PlanError};
use entry::{Entry, File, Group, Include, Placed, Text};
use scope::Scope;
use std::collections::BTreeMap;
use std::path::Path;

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
        let mut has_others = false;
        let entries = read(text, folder, 0, &mut has_others)?;
        let mut arguments = Vec::new();
        declared(&entries, &mut arguments);
        // A resumed run does not read the included files again: their text is kept with this one.
        let whole = || serde_json::to_string(&File { launch: entries.clone() });
        let text = if has_others { whole().map_err(|e| PlanError(e.to_string()))? } else { text.to_owned() };
        Ok(Self { text, entries, arguments })
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
    pub fn without_run(
        &self,
        values: &BTreeMap<&str, String>,
        viewers: &'static [Viewer],
    ) -> Result<Option<Vec<NodePlan>>, PlanError> {
        if OF_LAUNCHER.iter().any(|(name, ..)| self.arguments.iter().any(|(declared, _)| declared == name)) {
            return Ok(None);
        }
        let plans = self.processes(values, viewers)?;
        let is_run = plans.is_empty() || plans.iter().any(|p| p.is(NodeKind::DemSimulator));
        Ok((!is_run).then_some(plans))
    }

    /// The nodes of a run to start, in order, with these values for arguments.
    ///
    /// # Errors
    /// If the file starts a node that is neither of the laboratory nor among `viewers`, or is no file of a run.
    pub fn nodes(
        &self,
        values: &BTreeMap<&str, String>,
        viewers: &'static [Viewer],
    ) -> Result<Vec<NodePlan>, PlanError> {
        let nodes = self.processes(values, viewers)?;
        // The end of one of these nodes ends the run in any case: the key is for the launch of ROS 2.
        let ends_run = |n: &NodePlan| matches!(n.node, Some(NodeKind::DemSimulator | NodeKind::Recorder));
        if let Some(n) = nodes.iter().find(|n| n.ends_all && !ends_run(n)) {
            let reason = "on_exit: in a run \"shutdown\" is supported for dem_simulator and recorder";
            return Err(PlanError::of(&n.name, reason));
        }
        for node in NodeKind::all(viewers) {
            let count = nodes.iter().filter(|n| n.is(node)).count();
            if !node.per_run().0.contains(&count) {
                return Err(PlanError::count(node, count));
            }
        }
        Ok(nodes)
    }

    fn processes(
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
        let variables = values.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
        let mut nodes = Vec::new();
        Scope::of(variables).run(&self.entries, viewers, &mut nodes)?;
        if nodes.len() > PLACES {
            let count = nodes.len();
            return Err(PlanError(format!(
                "the launch file starts {count} processes; a run has at most {PLACES}"
            )));
        }
        Ok(nodes)
    }
}

/// The actions of a file, with those of the files that it includes in the place of these.
fn read(text: &str, folder: &Path, level: usize, has_others: &mut bool) -> Result<Vec<Placed>, PlanError> {
    let here = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let whole = text.replace("$(dirname)", &here.to_string_lossy());
    *has_others |= whole != text;
    let format = |e| PlanError(format!("not a launch file that can be run here: {e}"));
    // `y` and `on` are texts, as in ROS 2's own reader.
    let options = serde_saphyr::options! { strict_booleans: true };
    let file: File = serde_saphyr::from_str_with_options(&whole, options).map_err(format)?;
    included(file.launch, level, has_others)
}

fn included(entries: Vec<Placed>, level: usize, has_others: &mut bool) -> Result<Vec<Placed>, PlanError> {
    let one = |Placed { entry, line }| {
        let entry = match entry {
            Entry::Group(group) => {
                let children = included(group.children, level, has_others)?;
                Entry::Group(Group { children, ..group })
            }
            Entry::Include(include) => {
                *has_others = true;
                of_file(include, line, has_others, level).map_err(|fault| fault.in_line(line))?
            }
            other => other,
        };
        Ok(Placed { entry, line })
    };
    entries.into_iter().map(one).collect()
}

/// The actions of an included file, after values for its arguments.
fn of_file(include: Include, line: u64, has_others: &mut bool, level: usize) -> Result<Entry, PlanError> {
    let Include { file, arg, if_, unless } = include;
    let fault = |reason: String| PlanError(reason).included(&file);
    if level >= DEEPEST {
        return Err(fault(TOO_DEEP.to_owned()));
    }
    let built_in =
        file.strip_prefix("$(find-pkg-share grainlab)/launch/").and_then(|f| f.strip_suffix(".launch.yaml"));
    let known = BUILT_IN.iter().find(|(name, _)| Some(*name) == built_in);
    if known.is_none() && (file.contains("$(") || !(file.ends_with(".yaml") || file.ends_with(".yml"))) {
        return Err(fault(
            "a YAML file by its path, which may begin with $(dirname), or one of grainlab is expected"
                .to_owned(),
        ));
    }
    let path = Path::new(&file);
    let text = known.map(|(_, text)| Ok((*text).to_owned()));
    let text = text.unwrap_or_else(|| std::fs::read_to_string(path)).map_err(|e| fault(e.to_string()))?;
    let entries = read(&text, path.parent().unwrap_or(Path::new(".")), level + 1, has_others)
        .map_err(|e| if e.0.ends_with(TOO_DEEP) { e } else { fault(e.0) })?;
    let values = arg.into_iter().map(|setting| Placed { entry: Entry::Let(setting), line });
    let children = values.chain(entries).collect();
    Ok(Entry::Group(Group {
        children,
        file: Some(file),
        scoped: Some(Text("false".to_owned())),
        if_,
        unless,
    }))
}

/// Every declared argument with its default.
fn declared(entries: &[Placed], found: &mut Vec<(String, Option<String>)>) {
    for placed in entries {
        match &placed.entry {
            Entry::Arg(a) => found.push((a.name.clone(), a.default.as_ref().map(|d| d.0.clone()))),
            Entry::Group(group) => declared(&group.children, found),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests;
