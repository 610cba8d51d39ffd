//! Engine of a run, as options that set arguments of its launch file.

use std::collections::BTreeMap;

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
    /// Sets the arguments of a launch file.
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
