//! Settings of the recorder.

use crate::discovery::OtherTopics;
use grainlab_console::Failure;
use grainlab_msgs::Topic;
use grainlab_msgs::topics::TOPICS;
use grainlab_node_kit::{ParameterSpec, Parameters};
use grainlab_recordings::WriterOptions;
use grainlab_recordings::runs::{RUNS, create_run_directory};
use grainlab_recordings::scenes::{self, SceneText};
use std::io;
use std::path::{Path, PathBuf};

/// Settings of the recorder.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The run directory; `None` makes the next one under `recordings/runs`.
    pub output: Option<PathBuf>,
    /// Rows of the topic table.
    pub topics: Vec<Topic>,
    /// Topics outside the contract are recorded, too.
    pub others: Option<OtherTopics>,
    /// The scene of the run, attached to the recording.
    pub scene: Option<SceneText>,
    /// One run is recorded, from its first message: messages missing at its start count as lost, and
    /// repetitions are recorded once.
    pub whole_run: bool,
    /// Size of files, compression.
    pub writer: WriterOptions,
    /// Continues the existing recording, in its next file.
    pub append: bool,
}

/// The parameters of the node.
pub fn parameters() -> Vec<ParameterSpec> {
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
        set_parameter(),
        ParameterSpec::new("seed", -1_i64, "seed of the run; -1: the one of the scene"),
        ParameterSpec::new("append", false, "continue the recording in output, in its next file"),
    ]
}

/// The parameter of nodes for keys of the scene.
pub fn set_parameter() -> ParameterSpec {
    let meaning = "keys of the scene to set, as in [grains.count=500, friction=0.2]";
    ParameterSpec::new("set", Vec::<String>::new(), meaning)
}

impl Settings {
    /// From the parameters of [`parameters()`].
    pub fn of(parameters: &Parameters) -> Result<Self, Failure> {
        let text = |name: &str| Some(parameters.get::<String>(name)).filter(|t| !t.is_empty());
        let seed = u64::try_from(parameters.get::<i64>("seed")).ok();
        Ok(Self {
            output: text("output").map(PathBuf::from),
            topics: contract_topics(&parameters.get::<Vec<String>>("topics"))?,
            scene: text("scene")
                .map(|s| scenes::load(&s, &parameters.get::<Vec<String>>("set"), seed))
                .transpose()?,
            others: None,
            whole_run: true,
            writer: WriterOptions::default(),
            append: parameters.get("append"),
        })
    }

    pub(super) fn directory(&self) -> io::Result<PathBuf> {
        match (&self.output, &self.scene) {
            (Some(directory), _) => Ok(directory.clone()),
            (None, Some(s)) => create_run_directory(Path::new(RUNS), &s.scene.name, s.scene.seed),
            (None, None) => create_run_directory(Path::new(RUNS), "recording", 0),
        }
    }
}

/// Rows of the topic table by name; without names all that are recorded.
pub fn contract_topics(names: &[String]) -> Result<Vec<Topic>, Failure> {
    let recorded = || TOPICS.iter().filter(|t| t.is_recorded());
    if names.is_empty() {
        return Ok(recorded().copied().collect());
    }
    let known = || recorded().map(|t| t.name).collect::<Vec<_>>().join(", ");
    let row = |name: &String| match Topic::by_name(name) {
        Some(row) if row.is_transport() => Err(Failure::usage(format!(
            "topic {name:?} has only parts of large packings: record packing, which has them whole"
        ))),
        Some(row) if !row.is_recorded() => Err(Failure::usage(format!(
            "topic {name:?} has only copies of some requests: record stress, which has all"
        ))),
        Some(row) => Ok(*row),
        None => Err(Failure::usage(format!("no topic {name:?} in the laboratory; there are: {}", known()))),
    };
    names.iter().map(row).collect()
}
