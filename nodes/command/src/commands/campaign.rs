//! `grainlab campaign`: many runs, their progress, and their states in one table.

pub(crate) mod gather;
mod status;

use super::launch;
use grainlab_campaign::{Campaign, Engine, Folder, Options};
use grainlab_console::{Failure, Format, worse};
use grainlab_node_kit::Exit;
use grainlab_recordings::Lock;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
`grainlab campaign keys` has a file of a campaign, and describes every key. Each member is a folder with a recorded run.
Started again, the command leaves finished members as they are and continues interrupted ones, to the same bytes.

Examples:
  grainlab campaign friction.toml
  grainlab campaign friction.toml --engine slurm --partition short --time 2:00:00 --chunk 10 --sbatch-option=--mem=2G
  grainlab campaign friction.toml --engine print --time 2:00:00 > job.sh    # for sbatch; afterwards `grainlab campaign friction.toml` gathers
  grainlab campaign status recordings/campaigns/friction
  grainlab campaign gather recordings/campaigns/friction";

const STATUS: &str = "\
States: waiting, running, finished, failed, interrupted (its process ended without a result: the campaign continues it), unknown (begun
on another host, whose processes cannot be seen from here). Seconds are those of the last process of a member. The time left follows
from the mean of the finished members, at as many at a time as run now.";

const GATHER: &str = "\
states.csv: a row for each member and state.
groups.csv: a row for each scene, values set and phase: n, and KEY_mean and KEY_standard_error over the seeds, but of axes, which have no sign (empty
for one seed). KEY_n is there if KEY is not known in every state of a group: its mean is over the others.

The same campaign gives the same bytes. `grainlab bag info` of a member has its version, commit, host and date.
Settings are numbers where every value is one, else text. The exit code is 3 while members are missing, or a run is not the one of its member: scene, seed and settings are compared.";

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
    #[arg(long, short, alias = "output", value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    options: Options,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Count the members by state, also while they run, with the time left and the reason of each failure
    #[command(after_help = STATUS)]
    Status {
        #[command(flatten)]
        place: Place,
        /// Format of the result; JSON and CSV have every member
        #[arg(long, value_enum, default_value_t)]
        format: Format,
    },
    /// Write the states of all finished members, and their means over seeds, as CSV, also while others run
    #[command(after_help = GATHER)]
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

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    match (&args.command, &args.file) {
        (Some(Command::Status { place, format }), _) => {
            let (folder, campaign) = Folder::open(&place.folder)?;
            status::run(&campaign, &folder, *format)
        }
        (Some(Command::Gather(place)), _) => {
            let (folder, campaign) = Folder::open(&place.folder)?;
            gather::run(&campaign, &folder)
        }
        (Some(Command::Keys), _) => {
            grainlab_console::print(&grainlab_campaign::reference()).map(|()| Exit::Done)
        }
        (None, Some(file)) => {
            let mut campaign = Campaign::read(file)?;
            let root = args.out.clone().unwrap_or_else(|| Folder::default_of(&campaign));
            campaign.processes = args.options.processes;
            let (folder, _lock) = begin(&campaign, &root, &args.options)?;
            let exit = args.options.run(&campaign, &folder)?;
            if args.options.engine == Engine::Print || exit == Exit::Interrupted {
                return Ok(exit);
            }
            check(&campaign, &folder, true).map_err(|e| {
                Failure::new(
                    e.exit,
                    format!("a scene was changed while the campaign ran: its members are of two: {e}"),
                )
            })?;
            Ok(worse(exit, gather::run(&campaign, &folder)?))
        }
        (None, None) => Err(Failure::usage("name the file of a campaign")),
    }
}

/// Creates or finds the folder of a campaign, and writes there what its members are. Reads every scene and compares it with the runs
/// that are there, so that a fault ends the campaign before it begins.
///
/// The folder is locked, but not for a script that is printed: its tasks run later, and this process runs no member.
pub(crate) fn begin(
    campaign: &Campaign,
    root: &Path,
    options: &Options,
) -> Result<(Folder, Option<Lock>), Failure> {
    options.check()?;
    let folder = Folder::create(root, campaign)?;
    let lock = (options.engine != Engine::Print).then(|| folder.lock()).transpose()?;
    check(campaign, &folder, false)?;
    folder.plan(campaign)?;
    Ok((folder, lock))
}

/// Reads the scene of every member, with its notes unless they were printed, and compares it with the run that is there.
fn check(campaign: &Campaign, folder: &Folder, were_printed: bool) -> Result<(), Failure> {
    for (n, member) in campaign.members.iter().enumerate() {
        let launch = launch::Args::of_member(campaign, member, folder.run(member));
        let checked = launch.check(were_printed || n > 0);
        checked.map_err(|e| Failure::new(e.exit, format!("member {}: {e}", member.name)))?;
    }
    Ok(())
}
