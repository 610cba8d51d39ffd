//! The command line.

use crate::commands::{analyze, bag, completions, invert, launch, man, pick, probe, run, scene};
#[cfg(feature = "studio")]
use crate::commands::{calibrate, campaign, new, report, reproduce, verify, view};
use clap::{CommandFactory, Parser, Subcommand};
#[cfg(feature = "studio")]
use grainlab_bench as bench;
use grainlab_console::Failure;
#[cfg(feature = "studio")]
use grainlab_graph::{doctor, interface, node, param, service, topic};
use grainlab_node_kit::Exit;
use std::ffi::OsString;

/// Exit codes, shown by every help.
const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 failure, 2 usage, scene or parameters, 3 done with data loss, 4 physics invalid, 130 interrupted.
Results go to stdout, everything else to stderr. All quantities are in SI units.";

/// A laboratory for granular packings: prepares them, measures them, and infers their microstructure.
///
/// Without a command, the demo scene is run: every node as its own process over DDS on this host, everything recorded.
#[derive(Debug, Parser)]
#[command(name = "grainlab", version, after_help = EXIT_CODES, arg_required_else_help = false)]
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
    Completions(completions::Args),
    /// Write a manual page for each command.
    Man(man::Args),
    #[cfg(feature = "studio")]
    #[command(flatten)]
    Studio(Studio),
}

/// Commands of the studio: what people look at, and compare with.
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
    /// List and measure topics: rate, bandwidth, delay, publishers and subscriptions.
    #[command(subcommand)]
    Topic(topic::Command),
    /// List nodes, and what each publishes, subscribes to and serves.
    #[command(subcommand)]
    Node(node::Command),
    /// Read, describe and set parameters of running nodes.
    #[command(subcommand)]
    Param(param::Command),
    /// List and call services.
    #[command(subcommand)]
    Service(service::Command),
    /// Show the definitions of message and service types, and the topics of the laboratory.
    #[command(subcommand)]
    Interface(interface::Command),
    /// Find what keeps nodes from working together: QoS, types, names, network.
    Doctor(doctor::Args),
    /// Write a node of your own in Python or Rust, with a launch file and a test.
    #[command(subcommand)]
    New(new::NewCommand),
    /// Compare with other codes and the literature: one table of numbers, tolerances and verdicts.
    Verify(verify::Args),
    /// Measure cost and accuracy on this machine.
    #[command(subcommand)]
    Bench(bench::Command),
}

/// Parses the words of a command line, of which the first is the program, runs the command, and reports. Wrong words end the process.
pub fn main(words: Vec<OsString>) -> Exit {
    crate::memory::bound();
    let cli = Cli::try_parse_from(&words).unwrap_or_else(|error| {
        let words: Vec<String> = words[1..].iter().map(|word| word.to_string_lossy().into_owned()).collect();
        if let Some(form) = crate::ros2::hint(&words).filter(|_| error.use_stderr()) {
            _ = error.print();
            grainlab_console::say!("grainlab: instead of ros2 {}: {form}", words.join(" "));
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
        Some(Command::Man(args)) => man::run(&args, Cli::command()),
        #[cfg(feature = "studio")]
        Some(Command::Studio(command)) => studio(&command),
    };
    outcome.unwrap_or_else(|failure| report(&failure))
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
        Studio::Service(command) => service::run(command),
        Studio::Interface(command) => interface::run(command),
        Studio::Doctor(args) => doctor::run(args),
        Studio::New(command) => new::run(command),
        Studio::Verify(args) => verify::run(args),
        Studio::Bench(command) => bench::run(command),
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

    #[test]
    fn no_two_flags_of_a_command_have_one_name() {
        Cli::command().debug_assert();
    }

    /// Every command and sub-command, as the words that call it.
    fn calls(command: &clap::Command, before: &str) -> Vec<String> {
        let call = format!("{before}{}", command.get_name());
        let below = command.get_subcommands().flat_map(|c| calls(c, &format!("{call}-")));
        std::iter::once(call.clone()).chain(below).collect()
    }

    #[test]
    fn the_manual_has_a_page_for_each_command_and_sub_command() {
        let folder = tempfile::tempdir().unwrap();
        clap_mangen::generate_to(Cli::command(), folder.path()).unwrap();
        let mut pages: Vec<_> = calls(&Cli::command(), "").iter().map(|call| format!("{call}.1")).collect();
        pages.sort_unstable();
        let mut written: Vec<_> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|f| f.unwrap().file_name().into_string().unwrap())
            .collect();
        written.sort_unstable();
        assert_eq!(written, pages);
        assert!(pages.contains(&"grainlab-bag-play.1".to_owned()), "{pages:?}");
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

    /// The commands as a table in Markdown.
    fn table() -> String {
        let line = |c: &clap::Command| {
            // A bar would end the cell.
            let about = c.get_about().unwrap_or_default().to_string().replace('|', "\\|");
            format!("| `{}` | {about} |\n", c.get_name())
        };
        "| command | |\n|---|---|\n".to_owned()
            + &Cli::command().get_subcommands().map(line).collect::<String>()
    }

    /// The table between two comments of the README is that of the command line. With `GRAINLAB_BLESS=1` the test
    /// writes it.
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
