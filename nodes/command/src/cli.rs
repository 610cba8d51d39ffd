//! The command line.

use crate::commands::{analyze, bag, completions, invert, launch, man, pick, probe, run, scene};
#[cfg(feature = "studio")]
use crate::commands::{calibrate, campaign, new, report, reproduce, view};
use clap::error::ContextKind;
use clap::{CommandFactory, Parser, Subcommand};
use grainlab_console::Failure;
#[cfg(feature = "studio")]
use grainlab_graph::{doctor, interface, node, param, topic};
use grainlab_node_kit::Exit;
use std::ffi::OsString;

const END_OF_HELP: &str = "\
Not listed: completions SHELL prints completions for a shell, man DIR writes manual pages.

Exit codes: 0 done, 1 failure, 2 usage, scene or parameters, 3 done with data loss, 4 physics invalid, 130 interrupted.
Results go to stdout, everything else to stderr. All quantities are in SI units.";

/// A laboratory for granular packings: prepares them, measures them, and infers their microstructure.
///
/// Without a command, the demo scene is run: every node as its own process over DDS on this host, everything recorded.
#[derive(Debug, Parser)]
#[command(name = "grainlab", version, after_help = END_OF_HELP, arg_required_else_help = false)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scene: every node as its own process, recorded, measured, inverted. The default.
    Launch(launch::Args),
    /// List, show, check and create scenes: what a run simulates.
    #[command(subcommand)]
    Scene(scene::SceneCommand),
    /// Run one node as this process, with ROS 2 arguments.
    Run(run::Args),
    /// Record, play and inspect recordings.
    #[command(subcommand)]
    Bag(bag::BagCommand),
    /// Infer the microstructure from moduli: coordination and anisotropy with uncertainty.
    Invert(Box<invert::Args>),
    /// Measure packings from files: structure, stress and the full stiffness.
    Analyze(analyze::Args),
    /// Pick arrivals in records of an oscilloscope: speeds of long waves, with errors.
    Pick(pick::Args),
    /// Send waves through packings from files: their speeds, and the moduli that follow.
    Probe(probe::Args),
    /// Print completions of this command line for a shell.
    #[command(hide = true)]
    Completions(completions::Args),
    /// Write a manual page for each command.
    #[command(hide = true)]
    Man(man::Args),
    #[cfg(feature = "studio")]
    #[command(flatten)]
    Studio(Studio),
}

/// Commands of the studio: what people look at.
#[cfg(feature = "studio")]
#[derive(Debug, Subcommand)]
enum Studio {
    /// Learn the constants of the models from measured packings.
    Calibrate(calibrate::Args),
    /// Run many scenes: each a recorded run in a folder of its own, on this machine or a cluster.
    Campaign(campaign::Args),
    /// Report runs: a page with results, plots and packings; for many runs one row per run.
    Report(report::Args),
    /// Show packings in three dimensions, as a page or PNG, or with --live a running laboratory.
    View(Box<view::Args>),
    /// Reproduce the tables and figures of the paper: sixteen states, one page.
    Reproduce(reproduce::Args),
    /// List topics, print, publish and measure their messages, show publishers and subscriptions.
    #[command(subcommand)]
    Topic(topic::Command),
    /// List nodes, and what each publishes, subscribes to and serves.
    #[command(subcommand)]
    Node(node::Command),
    /// List, read and set parameters of running nodes.
    #[command(subcommand)]
    Param(param::Command),
    /// Show the definitions of message and service types.
    #[command(subcommand)]
    Interface(interface::Command),
    /// Find what keeps nodes from working together: QoS, types, names, network.
    Doctor(doctor::Args),
    /// Write a node of your own in Python or Rust, with a launch file and a test.
    #[command(subcommand)]
    New(new::NewCommand),
}

/// Parses the words of a command line, of which the first is the program, runs the command, and reports. Wrong words end the process.
pub fn main(words: Vec<OsString>) -> Exit {
    grainlab_console::memory::bound();
    let cli = Cli::try_parse_from(&words).unwrap_or_else(|error| {
        let refused = error.get(ContextKind::InvalidArg).map(ToString::to_string);
        let words = words[1..].iter().map(|word| word.to_string_lossy().into_owned());
        let words: Vec<String> = words.chain(refused).collect();
        if let Some(advice) = crate::hints::hint(&words).filter(|_| error.use_stderr()) {
            _ = error.print();
            grainlab_console::say!("grainlab: {advice}");
            std::process::exit(Exit::Usage as i32);
        }
        error.exit()
    });
    let outcome = match cli.command {
        None => launch::run(&launch::Args::default()),
        Some(Command::Launch(args)) => launch::run(&args),
        Some(Command::Scene(command)) => scene::run(&command),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Bag(command)) => bag::run(&command),
        Some(Command::Invert(args)) => invert::run(&args),
        Some(Command::Analyze(args)) => analyze::run(&args),
        Some(Command::Pick(args)) => pick::run(&args),
        Some(Command::Probe(args)) => probe::run(&args),
        Some(Command::Completions(args)) => completions::run(&args, Cli::command()),
        // A manual has a page for each command.
        Some(Command::Man(args)) => man::run(&args, with_all()),
        #[cfg(feature = "studio")]
        Some(Command::Studio(command)) => studio(&command),
    };
    outcome.unwrap_or_else(|failure| report(&failure))
}

/// The command line with the commands that its help does not list.
fn with_all() -> clap::Command {
    Cli::command().mut_subcommands(|command| command.hide(false))
}

#[cfg(feature = "studio")]
fn studio(command: &Studio) -> Result<Exit, Failure> {
    match command {
        Studio::Calibrate(args) => calibrate::run(args),
        Studio::Campaign(args) => campaign::run(args),
        Studio::Report(args) => report::run(args),
        Studio::View(args) => view::run(args),
        Studio::Reproduce(args) => reproduce::run(args),
        Studio::Topic(command) => topic::run(command),
        Studio::Node(command) => node::run(command),
        Studio::Param(command) => param::run(command),
        Studio::Interface(command) => interface::run(command),
        Studio::Doctor(args) => doctor::run(args),
        Studio::New(command) => new::run(command),
    }
}

fn report(failure: &Failure) -> Exit {
    grainlab_console::say!("grainlab: {failure}");
    failure.exit
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap_complete::{Shell, generate};

    /// Adds the flags of a command and its sub-commands that have the name of an earlier flag of the same command.
    fn repeated(command: &clap::Command, found: &mut Vec<String>) {
        let names = command.get_arguments().flat_map(|arg| {
            let aliases = arg.get_all_aliases().unwrap_or_default();
            let long = arg.get_long().into_iter().chain(aliases).map(|long| format!("--{long}"));
            let short = arg.get_short().into_iter().chain(arg.get_all_short_aliases().unwrap_or_default());
            long.chain(short.map(|short| format!("-{short}"))).collect::<Vec<_>>()
        });
        let mut known = std::collections::BTreeSet::new();
        let again = names.filter(|name| !known.insert(name.clone()));
        found.extend(again.map(|name| format!("{} {name}", command.get_name())));
        command.get_subcommands().for_each(|below| repeated(below, found));
    }

    #[test]
    fn no_two_flags_of_a_command_have_one_name() {
        let mut found = Vec::new();
        let flag = |id: &'static str| clap::Arg::new(id).long("flag").short('f');
        repeated(&clap::Command::new("planted").arg(flag("a")).arg(flag("b")), &mut found);
        assert_eq!(found, ["planted --flag", "planted -f"]);
        found.clear();
        repeated(&Cli::command(), &mut found);
        assert_eq!(found, [""; 0]);
    }

    /// Every command and sub-command, as the words that call it.
    fn calls(command: &clap::Command, before: &str) -> Vec<String> {
        let call = format!("{before}{}", command.get_name());
        let below = command.get_subcommands().flat_map(|c| calls(c, &format!("{call}-")));
        std::iter::once(call.clone()).chain(below).collect()
    }

    #[test]
    fn the_manual_has_a_page_for_each_command_and_sub_command() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("man1");
        let words = ["grainlab".as_ref(), "man".as_ref(), folder.as_os_str()];
        let Some(Command::Man(args)) = Cli::parse_from(words).command else { panic!("no man") };
        man::run(&args, with_all()).unwrap();
        let mut pages: Vec<_> = calls(&Cli::command(), "").iter().map(|call| format!("{call}.1")).collect();
        pages.sort_unstable();
        let mut written: Vec<_> = std::fs::read_dir(&folder)
            .unwrap()
            .map(|f| f.unwrap().file_name().into_string().unwrap())
            .collect();
        written.sort_unstable();
        assert_eq!(written, pages);
        let page = std::fs::read_to_string(folder.join("grainlab-bag-play.1")).unwrap();
        assert!(page.contains("Publish the messages of a recording"), "{page}");
    }

    #[test]
    fn the_completions_of_each_shell_have_every_command() {
        for shell in [Shell::Bash, Shell::Zsh, Shell::Fish, Shell::Elvish, Shell::PowerShell] {
            let mut script = Vec::new();
            generate(shell, &mut Cli::command(), "grainlab", &mut script);
            let script = String::from_utf8(script).unwrap();
            for command in Cli::command().get_subcommands() {
                assert!(script.contains(command.get_name()), "{shell}: {}", command.get_name());
            }
        }
    }

    fn table() -> String {
        let line = |c: &clap::Command| {
            // A bar would end the cell.
            let about = c.get_about().unwrap_or_default().to_string().replace('|', "\\|");
            format!("| `{}` | {about} |\n", c.get_name())
        };
        "| command | |\n|---|---|\n".to_owned()
            + &Cli::command().get_subcommands().filter(|c| !c.is_hide_set()).map(line).collect::<String>()
    }

    /// With `GRAINLAB_BLESS=1` the test writes the table between two comments of the README.
    #[test]
    fn the_table_of_the_readme_has_exactly_the_commands_and_their_descriptions() {
        const MARKS: [&str; 2] =
            ["<!-- commands: written by a test of nodes/command/src/cli.rs -->\n", "<!-- end -->\n"];
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../README.md");
        let page = std::fs::read_to_string(path).unwrap();
        let (before, rest) = page.split_once(MARKS[0]).expect("the README has a mark before the table");
        let (written, after) = rest.split_once(MARKS[1]).expect("the README has a mark after the table");
        let table = table();
        if std::env::var_os("GRAINLAB_BLESS").is_some() {
            std::fs::write(path, format!("{before}{}{table}{}{after}", MARKS[0], MARKS[1])).unwrap();
        } else {
            let bless = "GRAINLAB_BLESS=1 cargo test --release -p grainlab_command table_of_the_readme";
            assert_eq!(written, table, "{path} is out of date: {bless} writes it");
        }
    }
}
