//! `grainlab man`: manual pages of the command line.

use grainlab_console::{Failure, say};
use grainlab_node_kit::Exit;
use std::path::PathBuf;

/// The folder of the pages.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:
  grainlab man ~/.local/share/man/man1 && man grainlab-bag-play")]
pub(crate) struct Args {
    /// Folder to write the pages into; it is created, and pages of the same names are replaced
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Writes a page for `command`, the whole command line, and for each command and sub-command of it.
pub(crate) fn run(args: &Args, command: clap::Command) -> Result<Exit, Failure> {
    std::fs::create_dir_all(&args.folder).map_err(Failure::at(&args.folder))?;
    clap_mangen::generate_to(command, &args.folder).map_err(Failure::at(&args.folder))?;
    say!("grainlab: the pages are in {}", args.folder.display());
    Ok(Exit::Done)
}
