//! `grainlab completions`: completions of the command line, for a shell.

use clap_complete::{Shell, generate};
use grainlab_console::{Failure, print};
use grainlab_node_kit::Exit;

/// The shell to write for.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  grainlab completions bash > ~/.local/share/bash-completion/completions/grainlab
  grainlab completions zsh > ~/.zfunc/_grainlab        # with fpath+=~/.zfunc before compinit
  grainlab completions fish > ~/.config/fish/completions/grainlab.fish")]
pub(crate) struct Args {
    /// Shell that reads the completions
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Prints the completions of `command`, the whole command line.
pub(crate) fn run(args: &Args, mut command: clap::Command) -> Result<Exit, Failure> {
    let mut script = Vec::new();
    generate(args.shell, &mut command, "grainlab", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Done)
}
