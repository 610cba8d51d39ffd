//! The launch file and its arguments, kept beside the recording so that the run can be resumed.

use grainlab_console::{Failure, json, replace_whole};
use grainlab_launcher::{LaunchFile, NodePlan, check_one_process};
use grainlab_recordings::input;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

pub(super) const FILE: &str = "launch.json";

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Order {
    /// Text of the launch file.
    pub(super) launch: String,
    /// Values given for its arguments, except scene, seed and out.
    pub(super) arguments: BTreeMap<String, String>,
    pub(super) seed: u64,
    /// The launch file, by its built-in name or whole path, and the arguments: the words of the command.
    #[serde(default)]
    pub(super) words: Vec<String>,
    #[serde(default)]
    pub(super) record: Record,
    #[serde(default)]
    pub(super) one_process: bool,
}

/// The engine of a run.
#[derive(Clone, Debug, Default, clap::Args)]
pub(super) struct EngineOptions {
    /// Program that moves the grains once they touch; the gas before is always that of grainlab. lammps: an `lmp` on the PATH, see
    /// nodes/laboratory/lammps/README.md
    #[arg(long, value_parser = ["grainlab", "lammps"])]
    engine: Option<String>,
    /// The program of the engine with what starts it, as in 'mpiexec -n 4 lmp' [default: lmp]
    #[arg(long, value_name = "COMMAND")]
    engine_command: Option<String>,
    /// Longest time of one exchange with the program of the engine, after which it counts as hung [default: 300]
    #[arg(long, value_name = "SECONDS")]
    engine_time_limit: Option<f64>,
}

impl EngineOptions {
    pub(super) fn set(&self, arguments: &mut BTreeMap<String, String>) {
        let quoted = |text: &String| serde_json::Value::from(text.as_str()).to_string();
        let given = [
            ("engine", self.engine.clone()),
            ("engine_command", self.engine_command.as_ref().map(quoted)),
            ("engine_time_limit", self.engine_time_limit.map(|limit| format!("{limit:?}"))),
        ];
        arguments.extend(given.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))));
    }
}

/// Messages that are recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub(super) enum Record {
    /// All messages of a run
    #[default]
    All,
    /// Packings, what was measured of them and inferred from it, and the states of the run; not the lockstep and the log
    Results,
}

impl Order {
    /// True if this one starts the nodes of the other, wherever its launch file is, as processes or in one, and records what the
    /// other does, or more.
    pub(super) fn contains(&self, other: &Self) -> bool {
        let is_recorded = self.record == other.record || self.record == Record::All;
        self.launch == other.launch
            && self.arguments == other.arguments
            && self.seed == other.seed
            && is_recorded
    }

    pub(super) fn keep(&self, directory: &Path) -> Result<(), Failure> {
        let path = directory.join(FILE);
        // At once: what has a launch file can be resumed.
        replace_whole(&path, json(self)?).map_err(Failure::at(&path))
    }

    pub(super) fn read(directory: &Path) -> Result<Self, Failure> {
        let path = directory.join(FILE);
        let failed = |e: &dyn std::fmt::Display| {
            Failure::failed(format!(
                "{}: {e}: only a run that `grainlab launch` began can be resumed",
                path.display()
            ))
        };
        let text = input::text(&path, input::SETTINGS).map_err(|e| failed(&e))?;
        serde_json::from_str(&text).map_err(|e| failed(&e))
    }

    pub(super) fn plans(&self, directory: &Path) -> Result<Vec<NodePlan>, Failure> {
        // Parameters are YAML: a path with a space or a colon needs quotes.
        let path = |p: &Path| serde_json::Value::from(p.to_string_lossy()).to_string();
        let mut values: BTreeMap<&str, String> =
            self.arguments.iter().map(|(name, value)| (name.as_str(), value.clone())).collect();
        values.insert("scene", path(&directory.join("scene.toml")));
        values.insert("seed", self.seed.to_string());
        values.insert("out", path(directory));
        let earlier = |fault| {
            let run = directory.display();
            let end = "an earlier version, which ran them, began this run and must finish it";
            Failure::usage(format!(
                "{run}: actions of its launch file cannot be run any more: {end}. The fault: {fault}"
            ))
        };
        let file = LaunchFile::parse(&self.launch, Path::new(".")).map_err(earlier)?;
        let mut plans = file.nodes(&values).map_err(Failure::usage)?;
        let scene = directory.join("scene.toml");
        let agrees = |plan: &NodePlan| plan.check_handed_on(&scene, self.seed, directory);
        plans.iter().try_for_each(agrees).map_err(Failure::usage)?;
        if self.record == Record::Results {
            plans.iter_mut().for_each(NodePlan::record_results);
        }
        if self.one_process {
            check_one_process(&plans).map_err(Failure::usage)?;
            plans.iter_mut().for_each(NodePlan::composed);
        }
        Ok(plans)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_launcher::{BUILT_IN, NodeKind};

    #[test]
    fn what_was_launched_is_read_back_as_it_was() {
        let directory = tempfile::tempdir().unwrap();
        let arguments = BTreeMap::from([("simd".to_owned(), "scalar".to_owned())]);
        let (launch, words) = (BUILT_IN[0].1.to_owned(), vec!["demo".to_owned()]);
        let order = Order { launch, arguments, seed: 7, words, record: Record::Results, one_process: false };
        order.keep(directory.path()).unwrap();
        let known = Order::read(directory.path()).unwrap();
        assert_eq!(known, order);
        assert!(known.contains(&Order { words: Vec::new(), ..order.clone() }));
        assert!(known.contains(&Order { one_process: true, ..order.clone() }));
        assert!(!known.contains(&Order { record: Record::All, ..order.clone() }));
        assert!(Order { record: Record::All, ..order.clone() }.contains(&known));
        assert!(!known.contains(&Order { seed: 8, ..order }));
        let plans = known.plans(directory.path()).unwrap();
        let simulator = plans.iter().find(|p| p.is(NodeKind::DemSimulator)).unwrap();
        assert!(
            simulator.arguments.contains(&"simd:=scalar".to_owned())
                && simulator.arguments.contains(&"seed:=7".to_owned())
        );
        let elsewhere = tempfile::tempdir().unwrap();
        assert!(Order::read(elsewhere.path()).unwrap_err().to_string().contains("can be resumed"));
    }
}
