//! Where the members of a campaign run.

mod cluster;
mod local;
mod print;

use crate::campaign::Campaign;
use crate::folder::{Folder, MemberState};
use crate::lock::Lock;
use crate::progress::Progress;
use grainlab_console::{Failure, worse};
use grainlab_node_kit::Exit;
use std::time::Duration;

/// Where the members of a campaign run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Engine {
    /// On this machine, some at a time
    #[default]
    Local,
    /// As a job array of Slurm, by sbatch
    Slurm,
    /// As a task array of HyperQueue, by hq
    Hq,
    /// Nowhere: print the commands as a shell script
    Print,
}

/// How a campaign is run.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Members at a time on this machine; `None`: one more than there are cores, since each waits at its start and end.
    pub jobs: Option<usize>,
    /// How often a member that was interrupted is tried again; the last time anew.
    pub retries: usize,
    /// Run members again that failed.
    pub redo_failed: bool,
}

impl Engine {
    /// Runs the members that are not finished. The exit is 0 if all are.
    ///
    /// # Errors
    /// A folder in use, a scheduler that cannot be reached, a folder that cannot be written.
    pub fn run(self, campaign: &Campaign, folder: &Folder, options: Options) -> Result<Exit, Failure> {
        if self == Self::Print {
            print::run(campaign, folder)?;
            return Ok(Exit::Done);
        }
        let _lock = Lock::take(folder.root(), Duration::from_secs(10))?;
        if options.redo_failed {
            for member in
                campaign.members.iter().filter(|m| matches!(folder.state(m), MemberState::Failed(_)))
            {
                folder.remove(member)?;
            }
        }
        let pending: Vec<usize> = pending(campaign, folder);
        let mut progress = Progress::new(campaign.members.len(), campaign.members.len() - pending.len());
        let interrupted = match self {
            _ if pending.is_empty() => false,
            Self::Slurm => cluster::run(&cluster::SLURM, campaign, folder, options, &mut progress)?,
            Self::Hq => cluster::run(&cluster::HYPER_QUEUE, campaign, folder, options, &mut progress)?,
            _ => local::run(campaign, folder, options, pending, &mut progress)?,
        };
        progress.end();
        let exit = report(campaign, folder);
        Ok(if interrupted { Exit::Interrupted } else { exit })
    }
}

/// The members that can still be run.
fn pending(campaign: &Campaign, folder: &Folder) -> Vec<usize> {
    let is_pending = |n: &usize| {
        matches!(folder.state(&campaign.members[*n]), MemberState::Waiting | MemberState::Interrupted)
    };
    (0..campaign.members.len()).filter(is_pending).collect()
}

/// Names the members that are not finished; their exit code.
fn report(campaign: &Campaign, folder: &Folder) -> Exit {
    let mut exit = Exit::Done;
    for member in &campaign.members {
        let (why, code) = match folder.state(member) {
            MemberState::Finished => continue,
            MemberState::Failed(code) => {
                let of = Exit::ALL.into_iter().find(|e| e.code() == code).unwrap_or(Exit::Failure);
                (format!("failed with exit code {code}"), of)
            }
            MemberState::Waiting => ("did not begin".to_owned(), Exit::Failure),
            MemberState::Interrupted => ("is not finished".to_owned(), Exit::Failure),
        };
        exit = worse(exit, code);
        grainlab_console::say!(
            "grainlab: {} {why}: {}",
            member.name,
            folder.logs().join(format!("{}.log", member.name)).display()
        );
    }
    exit
}
