//! `grainlab bag recover`.

use grainlab_console::{Failure, print, say};
use grainlab_node_kit::Exit;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  grainlab bag recover recordings/runs/demo-1-1

Completes the recording of a recorder that was killed, so that other tools read it: every readable message keeps its
bytes, times and sequence number, and every file is completed with its index; the directory gets a metadata.yaml. The original
is kept as NAME.mcap.orig (metadata.yaml.orig) and may be removed after a check of the new one. A second call changes nothing. A recording that
is complete is not changed. Exit 3 if a part could not be read, or a file of metadata.yaml is missing, with a message.";

/// Arguments of `grainlab bag recover`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Run directory or MCAP file
    #[arg(value_name = "PATH")]
    path: PathBuf,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let done = grainlab_recordings::recover(&args.path)?;
    let mut text = String::new();
    for file in &done.files {
        let path = file.path.display();
        text += &match &file.original {
            None => format!(
                "{path}: complete, {}; nothing to do\n",
                grainlab_console::count(file.messages, "message")
            ),
            Some(original) => {
                format!(
                    "{path}: recovered, {}; original: {}\n",
                    grainlab_console::count(file.messages, "message"),
                    original.display()
                )
            }
        };
    }
    if done.metadata_written {
        text += &format!("{}: metadata.yaml was written\n", done.path.display());
    }
    print(&text)?;
    done.unreadable().for_each(|w| say!("grainlab: {w}"));
    Ok(if done.unreadable().next().is_none() { Exit::Done } else { Exit::DataLoss })
}
