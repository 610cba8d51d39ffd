//! `grainlab bag`: commands for recordings, as `ros2 bag`.

mod check;
#[cfg(feature = "studio")]
pub(crate) mod export;
mod info;
mod record;
mod recorded;
mod recover;

use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use grainlab_recorder::play;
use recorded::Recorded;

/// Commands for recordings.
#[derive(Debug, Subcommand)]
pub(crate) enum BagCommand {
    /// Record topics until SIGINT or SIGTERM.
    Record(Box<record::Args>),
    /// Publish the messages of a recording.
    Play(play::Args),
    /// Show the content of a recording.
    #[command(after_help = info::EXAMPLES)]
    Info(Recorded),
    /// Read every record of a recording and list all faults.
    #[command(after_help = check::EXAMPLES)]
    Check(Recorded),
    /// Write the packings of a recording as VTK, XYZ, LAMMPS or CSV files.
    #[cfg(feature = "studio")]
    Export(export::Args),
    /// Complete a recording whose recorder was killed, so that other tools read it.
    #[command(visible_alias = "reindex")]
    Recover(recover::Args),
    #[cfg(feature = "studio")]
    #[command(flatten)]
    Tool(grainlab_bag_tools::Command),
}

pub(crate) fn run(command: &BagCommand) -> Result<Exit, Failure> {
    match command {
        BagCommand::Record(args) => record::run(args),
        BagCommand::Play(args) => play::run(args),
        BagCommand::Info(args) => info::run(args),
        BagCommand::Check(args) => check::run(args),
        #[cfg(feature = "studio")]
        BagCommand::Export(args) => export::run(args),
        BagCommand::Recover(args) => recover::run(args),
        #[cfg(feature = "studio")]
        BagCommand::Tool(command) => grainlab_bag_tools::run(command),
    }
}
