//! `grainlab run`: one node as this process.

use crate::failure::Failure;
use crate::lifeline;
use crate::output::print;
use crate::recorder::{self, Recorder};
use crate::results::last_packing;
use crate::scenes;
use grainlab_acoustic_probe::AcousticProbe;
use grainlab_dem_simulator::DemSimulator;
use grainlab_emt_inversion::EmtInversion;
use grainlab_fabric_analyzer::FabricAnalyzer;
use grainlab_node_kit::run::NodeSpec;
use grainlab_node_kit::{Exit, Node, NodeError, ParameterSpec, RosArgs, Scope, run_node};
use grainlab_recordings::input;
use grainlab_servo_controller::ServoController;
use std::path::Path;

/// Every node: its name, what it does, its parameters.
pub(crate) fn nodes() -> Vec<NodeSpec> {
    // By hand, the lockstep and its record keep apart from launched runs; who measures hears everyone.
    let of_run = |name| ["dem_simulator", "servo_controller", "recorder"].contains(&name);
    let node = |name, summary, parameters| {
        let scope = if of_run(name) { Scope::OwnRun } else { Scope::Everyone };
        NodeSpec { name, summary, scope, parameters }
    };
    let mut simulator = vec![
        ParameterSpec::new("scene", "demo", "what to simulate: a built-in scene or a file"),
        scenes::set_parameter(),
        ParameterSpec::new("seed", -1_i64, "seed of every random choice; -1: the one of the scene"),
        ParameterSpec::new(
            "resume",
            "",
            "recording to go on from: the run continues from its last packing, to the same bytes; empty: from the beginning",
        ),
    ];
    simulator.extend(grainlab_dem_simulator::parameters());
    vec![
        node("dem_simulator", "owns the run: publishes stress and packings, obeys strain rates", simulator),
        node(
            "servo_controller",
            "answers every stress with a strain rate",
            grainlab_servo_controller::parameters(),
        ),
        node(
            "fabric_analyzer",
            "turns packings into fabric and moduli",
            grainlab_fabric_analyzer::parameters(),
        ),
        node(
            "acoustic_probe",
            "sends waves through packings: turns them into wave speeds",
            grainlab_acoustic_probe::parameters(),
        ),
        node(
            "emt_inversion",
            "turns moduli and wave speeds into microstructure",
            grainlab_emt_inversion::parameters(),
        ),
        node("recorder", "records every topic to MCAP", recorder::parameters()),
    ]
}

/// One node, with ROS 2 arguments.
#[derive(Debug, clap::Args)]
#[command(after_help = help(), override_usage = "grainlab run NODE [--ros-args -p NAME:=VALUE -r FROM:=TO ...]")]
pub(crate) struct Args {
    /// dem_simulator, servo_controller, fabric_analyzer, acoustic_probe, emt_inversion or recorder
    #[arg(value_name = "NODE")]
    node: String,
    /// ROS 2 arguments: --ros-args -p, -r, --params-file, --log-level
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    rest: Vec<String>,
}

fn help() -> String {
    let mut text = String::from("Nodes and their parameters (set with -p NAME:=VALUE):\n");
    for node in nodes() {
        text += &format!("\n  {}: {}\n", node.name, node.summary);
        node.parameters.iter().for_each(|p| text += &format!("    {p}\n"));
    }
    text + "\nExamples:\n  grainlab run dem_simulator --ros-args -p scene:=s2 -p seed:=3 -r __ns:=/left\n  \
            grainlab run fabric_analyzer --ros-args -p tolerance:=1e-10 --log-level debug"
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    lifeline::watch();
    let mut nodes = nodes();
    let known = nodes.iter().map(|n| n.name).collect::<Vec<_>>().join(", ");
    let Some(at) = nodes.iter().position(|n| n.name == args.node) else {
        return Err(Failure::usage(format!("no node {:?}; there are: {known}", args.node)));
    };
    let spec = nodes.swap_remove(at);
    let (ros, plain) = RosArgs::parse(&args.rest).map_err(Failure::usage)?;
    if let Some(stranger) = plain.first() {
        let message = format!("unexpected argument {stranger:?}; ROS arguments come after --ros-args");
        return Err(Failure::usage(message));
    }
    if spec.name == "recorder" {
        return record(&spec, &ros, recorder::Settings::of);
    }
    Ok(run_node(&spec, &ros, |bus, parameters| {
        let node: Box<dyn Node> = match spec.name {
            "dem_simulator" => {
                let seed = u64::try_from(parameters.get::<i64>("seed")).ok();
                let name: String = parameters.get("scene");
                let sets: Vec<String> = parameters.get("set");
                let scene = scenes::load(&name, &sets, seed).map_err(|e| node_error(&e))?;
                let recording: String = parameters.get("resume");
                let from = (!recording.is_empty()).then(|| last_packing::read(Path::new(&recording)));
                let from = from.transpose().map_err(|e| node_error(&e))?;
                let from = from.or(scene.start.map(|packing| (packing, Vec::new())));
                let simulator = DemSimulator::new(bus, scene.scene, from, parameters.into());
                Box::new(simulator.map_err(|e| NodeError::new(Exit::Failure, e.to_string()))?)
            }
            "servo_controller" => Box::new(ServoController::new(bus, parameters.into())?),
            "fabric_analyzer" => {
                let settings = grainlab_fabric_analyzer::Settings::try_from(parameters);
                let settings = settings.map_err(|e| NodeError::new(Exit::Usage, e.to_string()))?;
                Box::new(FabricAnalyzer::new(bus, settings)?)
            }
            "acoustic_probe" => {
                let settings = grainlab_acoustic_probe::Settings::try_from(parameters);
                let settings = settings.map_err(|e| NodeError::new(Exit::Usage, e.to_string()))?;
                Box::new(AcousticProbe::new(bus, settings)?)
            }
            _ => {
                let read =
                    |path: &str| input::text(Path::new(path), input::SETTINGS).map_err(|e| e.to_string());
                let settings = grainlab_emt_inversion::Settings::new(parameters, read);
                let settings = settings.map_err(|e| NodeError::new(Exit::Usage, e.to_string()))?;
                Box::new(EmtInversion::new(bus, settings)?)
            }
        };
        Ok(node)
    }))
}

/// Runs the recorder and prints what it recorded.
pub(crate) fn record(
    spec: &NodeSpec,
    ros: &RosArgs,
    settings: impl FnOnce(&grainlab_node_kit::Parameters) -> Result<recorder::Settings, Failure>,
) -> Result<Exit, Failure> {
    let result = recorder::Result::default();
    let exit = run_node(spec, ros, |bus, parameters| {
        let settings = settings(parameters).map_err(|e| node_error(&e))?;
        Ok(Box::new(Recorder::new(bus, &settings, result.clone())?))
    });
    if let Some(finished) = result.borrow().as_ref() {
        let (tallies, file) = (finished.ledger.tallies(), finished.file.display());
        print(&format!(
            "{}{file}: {} messages, {} bytes\n",
            recorder::counts(&tallies),
            finished.messages,
            finished.bytes
        ))?;
    }
    Ok(exit)
}

fn node_error(failure: &Failure) -> NodeError {
    NodeError::new(failure.exit, failure.to_string())
}
