//! `grainlab bag record`.

use crate::commands::run::print_recorded;
use grainlab_console::Failure;
use grainlab_launcher::NodeKind;
use grainlab_node_kit::NodeSpec;
use grainlab_node_kit::{Exit, RosArgs, Scope, run_node};
use grainlab_recorder::{Recorder, ResultSlot, Settings, contract_topics};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  grainlab bag record -a -o my_run
  grainlab bag record --topics stress packing

Ends with SIGINT (Ctrl-C) or SIGTERM; the file is then complete. Exit 3 if any message was lost.";

/// Arguments of `grainlab bag record`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Directory to make and record into [default: the next one under recordings/runs]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Topics to record
    #[arg(long, num_args = 1.., value_name = "TOPIC", conflicts_with = "all")]
    topics: Vec<String>,
    /// Record every topic, which is the default
    #[arg(short, long)]
    all: bool,
    /// Scene to attach: a built-in name or a file
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
    /// ROS 2 arguments, after --ros-args: -r, --log-level
    #[arg(last = true, value_name = "ROS_ARGUMENTS")]
    ros: Vec<String>,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let settings = Settings {
        output: args.output.clone(),
        topics: contract_topics(&args.topics)?,
        scene: args.scene.as_deref().map(|s| grainlab_console::scenes::load(s, &[], None)).transpose()?,
        whole_run: false,
        append: false,
    };
    let spec = NodeSpec {
        name: NodeKind::Recorder.name(),
        summary: "records topics to MCAP",
        scope: Scope::Everyone,
        parameters: Vec::new(),
    };
    let (ros, plain) = RosArgs::parse(&args.ros).map_err(Failure::usage)?;
    if let Some(stranger) = plain.first() {
        return Err(Failure::usage(format!("unexpected argument {stranger:?}")));
    }
    let recorded = ResultSlot::default();
    let exit = run_node(&spec, &ros, |bus, _| Ok(Box::new(Recorder::new(bus, &settings, recorded.clone())?)));
    print_recorded(&recorded)?;
    Ok(exit)
}
