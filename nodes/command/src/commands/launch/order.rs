//! The launch file and its arguments, kept beside the recording so that the run can be resumed.

use crate::viewers::VIEWERS;
use grainlab_console::{Failure, json, write_whole};
use grainlab_launcher::{LaunchFile, NodeKind, NodePlan, check_one_process};
use grainlab_recordings::input;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the file in the run directory.
pub(super) const FILE: &str = "launch.json";

/// A launch file with its arguments.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Order {
    /// Text of the launch file.
    pub(super) launch: String,
    /// Values given for its arguments, except scene, seed and out.
    pub(super) arguments: BTreeMap<String, String>,
    /// The seed of the run.
    pub(super) seed: u64,
    /// The launch file, by its built-in name or whole path, and the arguments: the words of the command.
    #[serde(default)]
    pub(super) words: Vec<String>,
    /// Messages that are recorded.
    #[serde(default)]
    pub(super) record: Record,
    /// All nodes are in the process of the launcher.
    #[serde(default)]
    pub(super) one_process: bool,
    /// Engine of the simulator, and its program, where they are given.
    #[serde(default, skip_serializing_if = "EngineOrder::is_default")]
    pub(super) engine: EngineOrder,
}

/// The engine of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::Args)]
pub(super) struct EngineOrder {
    /// Program that moves the grains once they touch; the gas before is always that of grainlab. lammps: an `lmp` on the PATH, see
    /// nodes/laboratory/lammps/README.md
    #[arg(long, value_parser = ["grainlab", "lammps"])]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    engine: Option<String>,
    /// The program of the engine with what starts it, as in 'mpiexec -n 4 lmp' [default: lmp]
    #[arg(long, value_name = "COMMAND")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    engine_command: Option<String>,
    /// Longest time of one exchange with the program of the engine, after which it counts as hung [default: 300]
    #[arg(long, value_name = "SECONDS")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    engine_time_limit: Option<String>,
}

impl EngineOrder {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Options of this command, and for those not given the known ones.
    pub(super) fn or(self, known: Self) -> Self {
        Self {
            engine: self.engine.or(known.engine),
            engine_command: self.engine_command.or(known.engine_command),
            engine_time_limit: self.engine_time_limit.or(known.engine_time_limit),
        }
    }

    /// Sets the parameters of the simulator.
    fn apply(&self, plan: &mut NodePlan) {
        let quoted = |text: &String| serde_json::Value::from(text.as_str()).to_string();
        let given = [
            ("engine", self.engine.as_ref().map(quoted)),
            ("engine_command", self.engine_command.as_ref().map(quoted)),
            ("engine_time_limit", self.engine_time_limit.clone()),
        ];
        for (name, value) in given {
            if let Some(value) = value.filter(|_| plan.is(NodeKind::DemSimulator)) {
                plan.insist(&[&format!("{name}:={value}")]);
            }
        }
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
            && self.engine == other.engine
            && is_recorded
    }

    /// Writes it into the run directory.
    pub(super) fn keep(&self, directory: &Path) -> Result<(), Failure> {
        let path = directory.join(FILE);
        // At once: what has a launch file can be resumed.
        write_whole(&path, json(self)?).map_err(Failure::at(&path))
    }

    /// Reads it back.
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

    /// The processes to start, for a run in this directory.
    pub(super) fn plans(&self, directory: &Path) -> Result<Vec<NodePlan>, Failure> {
        // Parameters are YAML: a path with a space or a colon needs quotes.
        let path = |p: &Path| serde_json::Value::from(p.to_string_lossy()).to_string();
        let mut values: BTreeMap<&str, String> =
            self.arguments.iter().map(|(name, value)| (name.as_str(), value.clone())).collect();
        values.insert("scene", path(&directory.join("scene.toml")));
        values.insert("seed", self.seed.to_string());
        values.insert("out", path(directory));
        let file = LaunchFile::parse(&self.launch).map_err(Failure::usage)?;
        let mut plans = file.nodes(&values, VIEWERS).map_err(Failure::usage)?;
        let scene = directory.join("scene.toml");
        let agrees = |plan: &NodePlan| plan.check_handed_on(&scene, self.seed, directory);
        plans.iter().try_for_each(agrees).map_err(Failure::usage)?;
        plans.iter_mut().for_each(|plan| self.engine.apply(plan));
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
    use grainlab_launcher::BUILT_IN;

    #[test]
    fn what_was_launched_is_read_back_as_it_was() {
        let directory = tempfile::tempdir().unwrap();
        let arguments = BTreeMap::from([("simd".to_owned(), "scalar".to_owned())]);
        let (launch, words) = (BUILT_IN[0].1.to_owned(), vec!["demo".to_owned()]);
        let order = Order {
            launch,
            arguments,
            seed: 7,
            words,
            record: Record::Results,
            one_process: false,
            engine: EngineOrder::default(),
        };
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
