//! `grainlab bag record`.

use crate::commands::run::{print_recorded, ros_arguments};
use grainlab_console::Failure;
use grainlab_launcher::NodeKind;
use grainlab_msgs::Topic;
use grainlab_node_kit::{Exit, NodeSpec, Scope, run_node};
use grainlab_recorder::{OtherTopics, Recorder, ResultSlot, Settings, contract_topics};
use grainlab_recordings::{Compression, MessagePath, QosOverrides, TopicNames, WriterOptions};
use std::path::PathBuf;
use std::time::Duration;

const EXAMPLES: &str = "\
Examples:
  grainlab bag record -a -o my_run
  grainlab bag record /stress /packing
  grainlab bag record --regex '/camera/.*' --msg-path my_ws/install/share

Topics of any type are recorded, also those that appear later. Definitions of types come from grainlab, which has its own and
those in msgs/std, then from the folders of --msg-path. A topic whose definition is not found is recorded with an empty
schema. Readers are reliable (transient local) if all publishers of the topic are, or as --qos-profile-overrides-path says:

  /scan: {reliability: best_effort, durability: volatile, history: keep_last, depth: 500}

Ends with SIGINT (Ctrl-C) or SIGTERM; the file is then complete. Exit 3 if any message was lost.";

/// Arguments of `grainlab bag record`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Directory to make and record into [default: the next one under recordings/runs]
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: Option<PathBuf>,
    /// Topics to record, by name [default: all]
    #[arg(value_name = "TOPIC", conflicts_with = "topics")]
    named: Vec<String>,
    #[command(flatten)]
    names: TopicNames,
    /// Storage of the recording
    #[arg(short, long, value_name = "KIND", value_parser = ["mcap"], default_value = "mcap")]
    storage: String,
    /// Record every topic that is not hidden, which is the default
    #[arg(short, long, conflicts_with_all = ["topics", "named", "regex"])]
    all: bool,
    /// Record hidden topics, too: those with a part that begins with an underscore, and /parameter_events
    #[arg(long)]
    include_hidden_topics: bool,
    #[command(flatten)]
    messages: MessagePath,
    /// QoS of readers instead of the adapted one, as a YAML file of rosbag2
    #[arg(long, value_name = "FILE")]
    qos_profile_overrides_path: Option<PathBuf>,
    /// Begin the next file at this size, bytes; it is exceeded by one chunk (768 KiB) at most [default: 512 MiB]
    #[arg(short = 'b', long, value_name = "BYTES", value_parser = clap::value_parser!(u64).range(1..))]
    max_bag_size: Option<u64>,
    /// Begin the next file after this time, s [default: 900]
    #[arg(short = 'd', long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..))]
    max_bag_duration: Option<u64>,
    /// Compression of the chunks
    #[arg(long, value_enum, value_name = "KIND", default_value = "zstd")]
    compression: Compression,
    /// Scene to attach: a built-in name or a file
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
    /// ROS 2 arguments, after --ros-args: -r, --log-level
    #[arg(last = true, value_name = "ROS_ARGUMENTS")]
    ros: Vec<String>,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let (topics, others) = topics(args)?;
    let settings = Settings {
        output: args.output.clone(),
        topics,
        others: Some(others),
        scene: args.scene.as_deref().map(|s| grainlab_recordings::scenes::load(s, &[], None)).transpose()?,
        whole_run: false,
        append: false,
        writer: writer(args),
    };
    let spec = NodeSpec {
        name: NodeKind::Recorder.name(),
        summary: "records topics to MCAP",
        scope: Scope::Everyone,
        parameters: Vec::new(),
    };
    let ros = ros_arguments(&args.ros)?;
    let recorded = ResultSlot::default();
    let exit = run_node(&spec, &ros, |bus, _| Ok(Box::new(Recorder::new(bus, &settings, recorded.clone())?)));
    print_recorded(&recorded)?;
    Ok(exit)
}

fn topics(args: &Args) -> Result<(Vec<Topic>, OtherTopics), Failure> {
    let mut names = args.names.clone();
    names.topics.extend(args.named.iter().cloned());
    let not_recorded = |name: &&String| Topic::by_name(name).is_some_and(|topic| !topic.is_recorded());
    if let Some(name) = names.topics.iter().find(not_recorded) {
        contract_topics(std::slice::from_ref(name))?;
    }
    let qos = args.qos_profile_overrides_path.as_deref().map(QosOverrides::read).transpose()?;
    let others = OtherTopics {
        names,
        hidden: args.include_hidden_topics,
        definitions: args.messages.definitions()?,
        qos: qos.unwrap_or_default(),
    };
    let mut topics = contract_topics(&[])?;
    topics.retain(|topic| others.take(&topic.absolute_name()));
    if let Some(name) = others.qos.topics().map(|name| format!("/{name}")).find(|name| !others.take(name)) {
        return Err(Failure::usage(format!("--qos-profile-overrides-path: {name} is not recorded")));
    }
    Ok((topics, others))
}

fn writer(args: &Args) -> WriterOptions {
    let default = WriterOptions::default();
    WriterOptions {
        compression: args.compression,
        split_bytes: args.max_bag_size.unwrap_or(default.split_bytes),
        split_after: args.max_bag_duration.map_or(default.split_after, Duration::from_secs),
        ..default
    }
}
