//! Engines that run the members of a campaign.

mod array;
mod cluster;
mod limits;
mod local;
mod options;

pub use options::{Engine, Options};

use crate::campaign::Campaign;
use crate::command::{command, line};
use crate::folder::{Folder, MemberState, Standing};
use crate::member::Member;
use crate::progress::Progress;
use grainlab_console::{Failure, worse};
use grainlab_msgs::Exit;

impl Options {
    /// Runs the members that are not finished; the caller holds the lock of the folder. The exit is 0 if all are.
    ///
    /// # Errors
    /// A folder in use, a scheduler that cannot be reached, a folder that cannot be written.
    pub fn run(&self, campaign: &Campaign, folder: &Folder) -> Result<Exit, Failure> {
        if self.engine == Engine::Print {
            grainlab_console::print(&self.script(campaign, folder)?)?;
            return Ok(Exit::Done);
        }
        if self.redo_failed {
            for member in
                campaign.members.iter().filter(|m| matches!(folder.state(m), MemberState::Failed(_)))
            {
                folder.redo(member)?;
            }
        }
        let pending = folder.pending(campaign);
        let is_finished = |m: &&Member| folder.state(m) == MemberState::Finished;
        let finished = campaign.members.iter().filter(is_finished).count();
        let failed = campaign.members.len() - pending.len() - finished;
        let mut progress = Progress::new(campaign.members.len(), finished, failed);
        let interrupted = match self.engine {
            _ if pending.is_empty() => false,
            Engine::Slurm | Engine::Hq => cluster::run(campaign, folder, self, &mut progress)?,
            _ => local::run(campaign, folder, self, pending, &mut progress)?,
        };
        progress.end();
        let exit = report(campaign, folder);
        Ok(if interrupted { Exit::Interrupted } else { exit })
    }

    /// The commands of the members as a script: for sbatch, if an option of it was given.
    fn script(&self, campaign: &Campaign, folder: &Folder) -> Result<String, Failure> {
        if self.chunk.is_some() || !self.sbatch().is_empty() {
            return cluster::script(campaign, folder, self);
        }
        let mut script = format!(
            "#!/bin/sh\n# Campaign {}: {}, in any order. Each line can be repeated: a finished run is left as it is, an\n\
             # interrupted one is continued.\nunset ROS_DOMAIN_ID\n",
            campaign.name,
            grainlab_console::count(campaign.members.len(), "run")
        );
        for member in &campaign.members {
            script += &line(&command(campaign, folder, member)?);
            script.push('\n');
        }
        Ok(script)
    }
}

/// Names the members that are not finished; their exit code.
fn report(campaign: &Campaign, folder: &Folder) -> Exit {
    let mut exit = Exit::Done;
    for member in &campaign.members {
        let code = match folder.state(member) {
            MemberState::Finished => continue,
            MemberState::Failed(code) => {
                Exit::ALL.into_iter().find(|e| e.code() == code).unwrap_or(Exit::Failure)
            }
            _ => Exit::Failure,
        };
        exit = worse(exit, code);
        let Standing { name, state, reason, .. } = folder.standing(member);
        let reason = reason.map_or_else(String::new, |r| format!(": {r}"));
        grainlab_console::say!("grainlab: {name} {state}{reason} ({})", folder.log(member).display());
    }
    exit
}
