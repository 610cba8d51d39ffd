//! `grainlab node list`.

use crate::observer::Observer;
use crate::view::Common;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// Arguments of `grainlab node list`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  grainlab node list --format json")]
pub struct Args {
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let graph = Observer::join()?.settled(args.common.patience());
    let names: Vec<&str> = graph.nodes.iter().map(|n| n.name.as_str()).collect();
    args.common.show(&names, || names.iter().map(|name| format!("{name}\n")).collect())?;
    Ok(Exit::Done)
}
