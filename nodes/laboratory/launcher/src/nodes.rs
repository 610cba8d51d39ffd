//! Every node: one variant each, and all differences between them outside their own crates.
//!
//! To add a node: its crate, a variant here with all matches on it, and the launch files that start it.

use crate::{last_packing, recorded_speeds};
use clap::ValueEnum;
use grainlab_acoustic_probe::AcousticProbe;
use grainlab_dem_simulator::DemSimulator;
use grainlab_emt_inversion::EmtInversion;
use grainlab_fabric_analyzer::FabricAnalyzer;
use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::{
    Bus, Names, Node, NodeError, NodeSpec, ParameterSpec, Parameters, RosArgs, Scope, use_sim_time,
};
use grainlab_packing_pictures::PackingPictures;
use grainlab_recorder::{self as recorder, Recorder, ResultSlot};
use grainlab_recordings::{input, scenes};
use grainlab_servo_controller::ServoController;
use std::fmt;
use std::ops::RangeInclusive;
use std::path::Path;

/// Advice for the name of a node of earlier versions.
const FOXGLOVE: &str = "no node \"foxglove_bridge\" any more: open a recording in Foxglove, or run ROS 2's bridge \
                        (ros2 launch foxglove_bridge foxglove_bridge_launch.xml) and `grainlab run packing_pictures`";

/// A node of the laboratory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum NodeKind {
    /// Moves the grains along the loading path of a scene.
    DemSimulator,
    /// Answers each stress with a strain rate.
    ServoController,
    /// Measures structure and stiffness of packings.
    FabricAnalyzer,
    /// Sends waves through packings.
    AcousticProbe,
    /// Infers the microstructure from moduli and wave speeds.
    EmtInversion,
    /// Records every message.
    Recorder,
    /// Draws packings for viewers.
    PackingPictures,
}

impl NodeKind {
    /// Every node, in the order of the help.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::value_variants().iter().copied()
    }

    /// The node with this name.
    ///
    /// # Errors
    /// If there is none; the text lists all.
    pub fn named(name: &str) -> Result<Self, String> {
        let unknown = || match name {
            "foxglove_bridge" => FOXGLOVE.to_owned(),
            _ => format!("no node {name:?}; there are: {}", Self::names()),
        };
        Self::all().find(|kind| kind.name() == name).ok_or_else(unknown)
    }

    /// Name of the node, unless `__node` sets another one.
    pub fn name(self) -> &'static str {
        match self {
            Self::DemSimulator => "dem_simulator",
            Self::ServoController => "servo_controller",
            Self::FabricAnalyzer => "fabric_analyzer",
            Self::AcousticProbe => "acoustic_probe",
            Self::EmtInversion => "emt_inversion",
            Self::Recorder => "recorder",
            Self::PackingPictures => "packing_pictures",
        }
    }

    /// The names of all, comma separated.
    pub fn names() -> String {
        Self::all().map(Self::name).collect::<Vec<_>>().join(", ")
    }

    /// Description in one line.
    pub fn summary(self) -> &'static str {
        match self {
            Self::DemSimulator => "advances the run: publishes stress and packings, applies strain rates",
            Self::ServoController => "returns a strain rate for every stress",
            Self::FabricAnalyzer => "measures structure, stress and stiffness of packings",
            Self::AcousticProbe => "measures wave speeds of packings",
            Self::EmtInversion => "infers the microstructure from moduli and wave speeds",
            Self::Recorder => "records every topic to MCAP",
            Self::PackingPictures => {
                "publishes packings as points and markers for viewers, while somebody subscribes"
            }
        }
    }

    /// Parameters of the node.
    pub fn parameters(self) -> Vec<ParameterSpec> {
        match self {
            Self::DemSimulator => simulator_parameters(),
            Self::ServoController => grainlab_servo_controller::parameters(),
            Self::FabricAnalyzer => grainlab_fabric_analyzer::parameters(),
            Self::AcousticProbe => grainlab_acoustic_probe::parameters(),
            Self::EmtInversion => grainlab_emt_inversion::parameters(),
            Self::Recorder => recorder::parameters(),
            Self::PackingPictures => Vec::new(),
        }
    }

    /// The processes whose samples it accepts when it is started by hand: the lockstep and its recorder
    /// ignore launched runs; a node that measures or shows accepts all.
    fn scope(self) -> Scope {
        match self {
            Self::DemSimulator | Self::ServoController | Self::Recorder => Scope::OwnRun,
            _ => Scope::Everyone,
        }
    }

    /// Specification for the run loop.
    pub fn spec(self) -> NodeSpec {
        NodeSpec {
            name: self.name(),
            summary: self.summary(),
            scope: self.scope(),
            parameters: self.parameters(),
        }
    }

    /// The names of its topics and the values of its parameters with these ROS arguments; the error is text.
    pub(crate) fn parse(self, arguments: &[String]) -> Result<(Names, Parameters), String> {
        let (ros, plain) = RosArgs::parse(arguments).map_err(|e| e.to_string())?;
        if let Some(word) = plain.first() {
            return Err(format!("unexpected argument {word:?}; ROS arguments come after --ros-args"));
        }
        let names = Names::from_args(self.name(), &ros).map_err(|e| e.to_string())?;
        self.check_remaps(&names)?;
        let specs: Vec<_> = self.parameters().into_iter().chain([use_sim_time()]).collect();
        let parameters = Parameters::resolve(&specs, self.name(), &names, &ros);
        Ok((names, parameters.map_err(|e| e.to_string())?))
    }

    /// Refuses a remap of a topic that does not exist, which would have no effect.
    pub fn check_remaps(self, names: &Names) -> Result<(), String> {
        let known = || topics::TOPICS.iter().chain(topics::PICTURES).map(|topic| topic.name);
        names.unknown_remap(known()).map_or(Ok(()), |from| {
            let known = known().collect::<Vec<_>>().join(", ");
            Err(format!("remap of {from}: {self} has no such topic; there are, in its namespace unless with a slash: {known}"))
        })
    }

    /// The topics that it publishes or reads in a run, of those that are recorded.
    pub(crate) fn topics(self) -> Vec<Topic> {
        let own: &[Topic] = match self {
            Self::DemSimulator => &[
                topics::STRESS,
                topics::STRAIN_RATE,
                topics::PACKING,
                topics::PACKING_REPORT,
                topics::MODULI,
                topics::WAVE_SPEEDS,
                topics::MICROSTRUCTURE,
                topics::RUN_STATE,
                topics::ENERGY,
                topics::CLOCK,
                topics::TF_STATIC,
            ],
            Self::ServoController => &[topics::STRESS, topics::STRAIN_RATE],
            Self::FabricAnalyzer => &[topics::PACKING, topics::PACKING_REPORT],
            Self::AcousticProbe => &[topics::PACKING, topics::WAVE_SPEEDS, topics::WAVEFORM],
            Self::EmtInversion => {
                &[topics::PACKING_REPORT, topics::MODULI, topics::WAVE_SPEEDS, topics::MICROSTRUCTURE]
            }
            Self::Recorder => topics::TOPICS,
            Self::PackingPictures => &[topics::PACKING],
        };
        let of_every_node = [topics::DIAGNOSTICS, topics::ROSOUT].into_iter().filter(|t| !own.contains(t));
        own.iter().copied().filter(Topic::is_recorded).chain(of_every_node).collect()
    }

    /// Number of such nodes that a run may have, as a range and as text: a second one of a unique node would
    /// contradict the first.
    pub fn per_run(self) -> (RangeInclusive<usize>, &'static str) {
        match self {
            Self::Recorder | Self::DemSimulator => (1..=1, "one"),
            Self::EmtInversion => (0..=usize::MAX, "any number"),
            _ => (0..=1, "at most one"),
        }
    }

    /// The topic of its data, from each of which a microstructure is inferred.
    pub fn measures(self) -> Option<Topic> {
        match self {
            Self::FabricAnalyzer => Some(topics::PACKING_REPORT),
            Self::AcousticProbe => Some(topics::WAVE_SPEEDS),
            _ => None,
        }
    }

    /// Creates the node on its bus. A recorder leaves its finished recording in `recorded`.
    pub fn build(
        self,
        bus: &mut dyn Bus,
        parameters: &Parameters,
        recorded: &ResultSlot,
    ) -> Result<Box<dyn Node>, NodeError> {
        Ok(match self {
            Self::DemSimulator => Box::new(simulator(bus, parameters)?),
            Self::ServoController => {
                let min_readers = parameters.get::<i64>("min_readers").unsigned_abs();
                Box::new(ServoController::new(bus, min_readers as usize)?)
            }
            Self::FabricAnalyzer => {
                let settings = grainlab_fabric_analyzer::Settings::try_from(parameters);
                Box::new(FabricAnalyzer::new(bus, settings.map_err(NodeError::usage)?)?)
            }
            Self::AcousticProbe => {
                let settings = grainlab_acoustic_probe::Settings::try_from(parameters);
                Box::new(AcousticProbe::new(bus, settings.map_err(NodeError::usage)?)?)
            }
            Self::EmtInversion => {
                let read =
                    |path: &str| input::text(Path::new(path), input::SETTINGS).map_err(|e| e.to_string());
                let settings = grainlab_emt_inversion::Settings::new(parameters, read);
                Box::new(EmtInversion::new(bus, settings.map_err(NodeError::usage)?)?)
            }
            Self::Recorder => {
                let settings = recorder::Settings::of(parameters)?;
                Box::new(Recorder::new(bus, &settings, recorded.clone())?)
            }
            Self::PackingPictures => Box::new(PackingPictures::new(bus)?),
        })
    }
}

impl fmt::Display for NodeKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

fn simulator_parameters() -> Vec<ParameterSpec> {
    let mut all = vec![
        ParameterSpec::new("scene", "demo", "scene to simulate: a built-in one or a file"),
        grainlab_recorder::set_parameter(),
        ParameterSpec::new("seed", -1_i64, "seed of every random choice; -1: the one of the scene"),
        ParameterSpec::new(
            "resume",
            "",
            "recording to resume: the run continues from its last packing, to the same bytes; empty: from the beginning",
        ),
    ];
    all.extend(grainlab_dem_simulator::parameters());
    all
}

fn simulator(bus: &mut dyn Bus, parameters: &Parameters) -> Result<DemSimulator, NodeError> {
    let seed = u64::try_from(parameters.get::<i64>("seed")).ok();
    let name: String = parameters.get("scene");
    let sets: Vec<String> = parameters.get("set");
    let scene = scenes::load(&name, &sets, seed)?;
    let recording: String = parameters.get("resume");
    let is_earlier = parameters.get::<bool>("exit_when_finished")
        || !parameters.get::<Vec<String>>("until_inverted").is_empty()
        || parameters.get::<f64>("inverted_within") > 0.0;
    if is_earlier {
        log::warn!(
            "exit_when_finished, until_inverted and inverted_within are parameters of an earlier version: use finish and awaited"
        );
    }
    let mut settings = grainlab_dem_simulator::Settings::from(parameters);
    let from = match recording.as_str() {
        "" => scene.start.map(|packing| (packing, Vec::new())),
        recording => {
            let recording = Path::new(recording);
            settings.next_request = last_packing::next_request(recording)?;
            settings.recorded = recorded_speeds::read(recording)?;
            Some(last_packing::read(recording)?)
        }
    };
    DemSimulator::new(bus, scene.scene, from, settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_node_kit::{Hub, Statistics};

    #[test]
    fn a_name_means_its_node_and_an_unknown_one_lists_all() {
        for kind in NodeKind::all() {
            assert_eq!(NodeKind::named(kind.name()), Ok(kind));
        }
        let error = NodeKind::named("dem_simulater").unwrap_err();
        assert!(error.starts_with("no node \"dem_simulater\"; there are: dem_simulator, servo"), "{error}");
        let removed = NodeKind::named("foxglove_bridge").unwrap_err();
        assert!(
            removed.contains("open a recording in Foxglove") && removed.contains("ros2 launch"),
            "{removed}"
        );
    }

    #[test]
    fn a_node_uses_no_topic_beside_those_whose_names_are_compared_before_the_start() {
        let folder = tempfile::tempdir().unwrap();
        for kind in NodeKind::all() {
            let output = format!("output:={}", folder.path().join("run").display());
            let given = ["--ros-args", "-p", &output].map(str::to_owned);
            let given = if kind == NodeKind::Recorder { given.as_slice() } else { &[] };
            let (names, parameters) = kind.parse(given).unwrap();
            let mut bus = Hub::new(1).bus(names);
            let _node = kind.build(&mut bus, &parameters, &ResultSlot::default()).unwrap();
            let used = bus.published().into_iter().map(|p| p.topic);
            let used = used.chain(bus.received().into_iter().map(|r| r.topic));
            // Nodes of a run read no pictures.
            let is_of_run = |t: &Topic| t.is_recorded() && !topics::PICTURES.contains(t);
            for name in used.filter(|name| Topic::by_name(name).is_some_and(is_of_run)) {
                assert!(kind.topics().iter().any(|t| t.absolute_name() == name), "{kind}: {name}");
            }
        }
    }

    #[test]
    fn who_measures_is_who_writes_the_topic() {
        for (kind, topic) in NodeKind::all().filter_map(|kind| Some((kind, kind.measures()?))) {
            assert_eq!(kind.name(), topic.writer);
        }
    }
}
