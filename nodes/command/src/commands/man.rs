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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Command;

    #[test]
    fn every_command_and_sub_command_has_a_page_of_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let args = Args { folder: folder.path().join("man1") };
        let play = Command::new("play").about("Publish a recording");
        let bag = Command::new("bag").subcommand(play).subcommand_required(true);
        run(&args, Command::new("grainlab").subcommand(bag)).unwrap();
        let mut pages: Vec<_> =
            std::fs::read_dir(&args.folder).unwrap().map(|f| f.unwrap().file_name()).collect();
        pages.sort_unstable();
        assert_eq!(pages, ["grainlab-bag-play.1", "grainlab-bag.1", "grainlab.1"]);
        let text = std::fs::read_to_string(args.folder.join("grainlab-bag-play.1")).unwrap();
        assert!(text.contains("Publish a recording"), "{text}");
    }
}
