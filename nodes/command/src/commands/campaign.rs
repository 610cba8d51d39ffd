//! `grainlab campaign`: many runs, their progress, and their states in one table.

pub(crate) mod gather;

use super::launch;
use grainlab_campaign::{Campaign, Engine, Folder, MemberState, Options};
use grainlab_console::{Failure, Table, print, worse};
use grainlab_node_kit::Exit;
use grainlab_recordings::Lock;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
A campaign file:
  name = \"friction\"
  scenes = [\"demo\", \"mine.toml\"]           # built in, or files beside this one
  seeds = { first = 1, count = 5 }          # or a list
  vary = { friction = [0.05, 0.1, 0.3] }    # every combination is run with every seed
  set = { grains.count = 500 }              # keys of every scene

`grainlab campaign keys` describes every key: values in step, groups, tables of runs. Each member is a folder with a
recorded run. Started again, the command leaves finished members as they are and continues interrupted ones; the results are
the same to the last byte.

Examples:
  grainlab campaign friction.toml
  grainlab campaign friction.toml --engine slurm --partition short --time 2:00:00 --chunk 10 --sbatch-option=--mem=2G
  grainlab campaign friction.toml --engine print --time 2:00:00 > job.sh    # for sbatch; afterwards the first line gathers
  grainlab campaign status recordings/campaigns/friction
  grainlab campaign gather recordings/campaigns/friction";

/// A campaign to run.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    /// File of the campaign
    #[arg(required = true, value_name = "FILE")]
    file: Option<PathBuf>,
    /// Folder of the campaign [default: recordings/campaigns/NAME]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    options: Options,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Count the members by how far they came, and name those that are not finished
    Status(Place),
    /// Write the states of all finished members as states.csv and states.parquet, from their recordings
    Gather(Place),
    /// Show every key of the file of a campaign, as Markdown
    Keys,
}

/// A campaign that began.
#[derive(Debug, clap::Args)]
struct Place {
    /// Folder of the campaign
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    match (&args.command, &args.file) {
        (Some(Command::Status(place)), _) => status(place),
        (Some(Command::Gather(place)), _) => {
            let (folder, campaign) = Folder::open(&place.folder)?;
            let _lock = folder.lock()?;
            gather::run(&campaign, &folder)
        }
        (Some(Command::Keys), _) => print(&grainlab_campaign::reference()).map(|()| Exit::Done),
        (None, Some(file)) => {
            let mut campaign = Campaign::read(file)?;
            let root = args.out.clone().unwrap_or_else(|| Folder::default_of(&campaign));
            campaign.processes = args.options.processes;
            let (folder, _lock) = begin(&campaign, &root, &args.options)?;
            let exit = run_members(&args.options, &campaign, &folder)?;
            if args.options.engine == Engine::Print || exit == Exit::Interrupted {
                return Ok(exit);
            }
            Ok(worse(exit, gather::run(&campaign, &folder)?))
        }
        (None, None) => Err(Failure::usage("name the file of a campaign")),
    }
}

/// The folder of a campaign, locked; without a lock it was only named, and nothing written. Reads every scene and compares it with
/// the runs that are there, so that a fault ends the campaign before it begins.
pub(crate) fn begin(
    campaign: &Campaign,
    root: &Path,
    options: &Options,
) -> Result<(Folder, Option<Lock>), Failure> {
    options.check()?;
    let lock = if options.engine == Engine::Print { None } else { Some(Folder::create(root)?.1) };
    let folder = Folder::at(root)?;
    for member in &campaign.members {
        let launch = launch::Args::of_member(campaign, member, folder.run(member));
        launch.check().map_err(|e| Failure::new(e.exit, format!("member {}: {e}", member.name)))?;
    }
    lock.iter().try_for_each(|_| folder.plan(campaign))?;
    Ok((folder, lock))
}

/// Runs the members that are not finished.
pub(crate) fn run_members(options: &Options, campaign: &Campaign, folder: &Folder) -> Result<Exit, Failure> {
    options.run(campaign, folder, &|member| {
        let launch = launch::Args::of_member(campaign, member, folder.run(member));
        launch::run(&launch).unwrap_or_else(|failure| {
            grainlab_console::say!("grainlab: {failure}");
            failure.exit
        })
    })
}

fn status(place: &Place) -> Result<Exit, Failure> {
    let (folder, campaign) = Folder::open(&place.folder)?;
    let states: Vec<MemberState> = campaign.members.iter().map(|m| folder.state(m)).collect();
    let count = |is: fn(&MemberState) -> bool| states.iter().filter(|s| is(s)).count();
    let [finished, interrupted, waiting] = [
        count(|s| *s == MemberState::Finished),
        count(|s| *s == MemberState::Interrupted),
        count(|s| *s == MemberState::Waiting),
    ];
    let failed = states.len() - finished - interrupted - waiting;
    print(&format!(
        "{}: {}: {finished} finished, {interrupted} begun, {waiting} waiting, {failed} failed\n",
        campaign.name,
        grainlab_console::count(states.len(), "member")
    ))?;
    let mut table = Table::new(["member", "state", "directory"]);
    for (member, state) in campaign.members.iter().zip(&states) {
        let state = match state {
            MemberState::Finished | MemberState::Waiting => continue,
            MemberState::Interrupted => "begun".to_owned(),
            MemberState::Failed(code) => format!("failed, exit code {code}"),
        };
        table.row([member.name.clone(), state, folder.run(member).display().to_string()]);
    }
    if failed + interrupted > 0 {
        print(&table.text())?;
    }
    Ok(Exit::Done)
}
