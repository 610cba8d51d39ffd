//! What is recorded, and where to.

use crate::failure::Failure;
use crate::scenes::{self, SceneText};
use grainlab_msgs::{TOPICS, Topic};
use grainlab_node_kit::{ParameterSpec, Parameters};
use grainlab_recordings::runs::{RUNS, create_run_directory};
use std::io;
use std::path::{Path, PathBuf};

/// What is recorded, and where to.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    /// The run directory; `None` makes the next one under `recordings/runs`.
    pub(crate) output: Option<PathBuf>,
    /// Rows of the contract.
    pub(crate) topics: Vec<Topic>,
    /// The scene of the run, which is attached.
    pub(crate) scene: Option<SceneText>,
    /// One run is recorded, from its first message on: what is missing at its beginning counts as lost, too, and what its
    /// processes say again is recorded once.
    pub(crate) whole_run: bool,
    /// Goes on with the recording that is there, in its next file.
    pub(crate) append: bool,
}

/// The parameters of the node.
pub(crate) fn parameters() -> Vec<ParameterSpec> {
    vec![
        ParameterSpec::new(
            "output",
            "",
            "directory to make and record into; empty: the next one under recordings/runs",
        ),
        ParameterSpec::new(
            "topics",
            Vec::<String>::new(),
            "topics to record; empty: every topic of the laboratory",
        ),
        ParameterSpec::new(
            "scene",
            "",
            "scene of the run, a built-in name or a file, attached to the recording",
        ),
        scenes::set_parameter(),
        ParameterSpec::new("seed", -1_i64, "seed of the run; -1: the one of the scene"),
        ParameterSpec::new("append", false, "go on with the recording in output, in its next file"),
    ]
}

impl Settings {
    /// From the parameters of [`parameters`].
    pub(crate) fn of(parameters: &Parameters) -> Result<Self, Failure> {
        let text = |name: &str| Some(parameters.get::<String>(name)).filter(|t| !t.is_empty());
        let seed = u64::try_from(parameters.get::<i64>("seed")).ok();
        Ok(Self {
            output: text("output").map(PathBuf::from),
            topics: contract_topics(&parameters.get::<Vec<String>>("topics"))?,
            scene: text("scene")
                .map(|s| scenes::load(&s, &parameters.get::<Vec<String>>("set"), seed))
                .transpose()?,
            whole_run: true,
            append: parameters.get("append"),
        })
    }

    /// The directory to record into.
    pub(super) fn directory(&self) -> io::Result<PathBuf> {
        match (&self.output, &self.scene) {
            (Some(directory), _) => Ok(directory.clone()),
            (None, Some(s)) => create_run_directory(Path::new(RUNS), &s.scene.name, s.scene.seed),
            (None, None) => create_run_directory(Path::new(RUNS), "recording", 0),
        }
    }
}

/// Rows of the contract by name; all of them for no name, except those that only carry parts of another topic's messages.
pub(crate) fn contract_topics(names: &[String]) -> Result<Vec<Topic>, Failure> {
    let recorded = || TOPICS.iter().filter(|t| !t.is_transport());
    if names.is_empty() {
        return Ok(recorded().copied().collect());
    }
    let known = || recorded().map(|t| t.name).collect::<Vec<_>>().join(", ");
    let row = |name: &String| match Topic::by_name(name) {
        Some(row) if row.is_transport() => Err(Failure::usage(format!(
            "topic {name:?} only carries parts of large packings: record packing, which holds them whole"
        ))),
        Some(row) => Ok(*row),
        None => Err(Failure::usage(format!("no topic {name:?} in the laboratory; there are: {}", known()))),
    };
    names.iter().map(row).collect()
}
