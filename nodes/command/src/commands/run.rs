//! `grainlab run`: one node as this process.

use grainlab_console::{Failure, print};
use grainlab_launcher::NodeKind;
use grainlab_launcher::pipe;
use grainlab_node_kit::{Exit, Names, RosArgs, run_node};
use grainlab_recorder::{ResultSlot, tallies};

/// One node, with ROS 2 arguments.
#[derive(Debug, clap::Args)]
#[command(after_help = help(), override_usage = "grainlab run NODE [--ros-args -p NAME:=VALUE -r FROM:=TO ...]")]
pub(crate) struct Args {
    #[arg(value_name = "NODE", help = one_of(&NodeKind::names()))]
    node: String,
    /// ROS 2 arguments: --ros-args -p, -r, --params-file, --log-level
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    rest: Vec<String>,
}

/// The last comma of a list replaced by "or".
fn one_of(names: &str) -> String {
    names.rsplit_once(", ").map_or_else(|| names.to_owned(), |(all, last)| format!("{all} or {last}"))
}

fn help() -> String {
    let mut text = String::from("Nodes and their parameters (set with -p NAME:=VALUE):\n");
    for node in NodeKind::all() {
        text += &format!("\n  {node}: {}\n", node.summary());
        node.parameters().iter().for_each(|p| text += &format!("    {p}\n"));
    }
    text + "\nExamples:\n  grainlab run dem_simulator --ros-args -p scene:=s2 -p seed:=3 -r __ns:=/left\n  \
            grainlab run fabric_analyzer --ros-args -p tolerance:=1e-10 --log-level debug"
}

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    pipe::watch();
    // `ros2 run` names the package first.
    let (name, rest) = match (args.node.as_str(), args.rest.split_first()) {
        ("grainlab", Some((name, rest))) => (name.as_str(), rest),
        (name, _) => (name, &args.rest[..]),
    };
    let node = NodeKind::named(name).map_err(Failure::usage)?;
    let ros = ros_arguments(rest)?;
    // Invalid names are refused by the node.
    Names::from_args(node.name(), &ros)
        .map_or(Ok(()), |names| node.check_remaps(&names))
        .map_err(Failure::usage)?;
    let recorded = ResultSlot::default();
    let exit = run_node(&node.spec(), &ros, |bus, parameters| node.build(bus, parameters, &recorded));
    print_recorded(&recorded)?;
    Ok(exit)
}

/// Reads ROS 2 arguments, and refuses others.
pub(crate) fn ros_arguments(words: &[String]) -> Result<RosArgs, Failure> {
    let (ros, plain) = RosArgs::parse(words).map_err(Failure::usage)?;
    match plain.first() {
        None => Ok(ros),
        Some(stranger) => Err(Failure::usage(format!(
            "unexpected argument {stranger:?}; ROS arguments come after --ros-args"
        ))),
    }
}

/// Prints the counts of a recorder's recording, if one finished.
pub(crate) fn print_recorded(recorded: &ResultSlot) -> Result<(), Failure> {
    let recorded = recorded.borrow();
    let Some(finished) = recorded.as_ref() else { return Ok(()) };
    let (counts, file) = (tallies::counts(&finished.ledger.tallies()), finished.file.display());
    print(&format!(
        "{counts}{file}: {}, {} bytes\n",
        grainlab_console::count(finished.messages, "message"),
        finished.bytes
    ))
}
