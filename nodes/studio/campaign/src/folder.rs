//! The folder of a campaign, and how far its members came.

use crate::campaign::Campaign;
use crate::member::Member;
use grainlab_console::{Failure, json, write_whole};
use grainlab_msgs::Exit;
use grainlab_recordings::{Lock, RunState, end_reason, input, run_state};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Progress of a member.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemberState {
    /// It has not begun.
    Waiting,
    /// It began and is not finished: it can be continued.
    Interrupted,
    /// It ended with this exit code, and would end so again.
    Failed(u8),
    /// The run is finished, and the recording whole.
    Finished,
}

/// The folder of a campaign.
#[derive(Clone, Debug)]
pub struct Folder {
    root: PathBuf,
}

impl Folder {
    /// The default folder of a campaign.
    pub fn default_of(campaign: &Campaign) -> PathBuf {
        Path::new("recordings/campaigns").join(&campaign.name)
    }

    /// The folder at this path, which need not be there.
    pub fn at(root: &Path) -> Result<Self, Failure> {
        let root = root.canonicalize().or_else(|_| std::path::absolute(root)).map_err(Failure::at(root))?;
        Ok(Self { root })
    }

    /// Creates the folder, or finds it, for this process alone as long as the lock is held.
    pub fn create(root: &Path) -> Result<(Self, Lock), Failure> {
        let failed = |e: io::Error| Failure::failed(format!("the folder {}: {e}", root.display()));
        std::fs::create_dir_all(root).map_err(failed)?;
        let folder = Self { root: root.canonicalize().map_err(failed)? };
        let lock = folder.lock()?;
        for part in [folder.members(), folder.logs()] {
            std::fs::create_dir_all(part).map_err(failed)?;
        }
        Ok((folder, lock))
    }

    /// For this process alone, as long as the lock is held.
    pub fn lock(&self) -> Result<Lock, Failure> {
        Lock::take(&self.root, TIME_LIMIT)
    }

    /// Writes what its members are.
    pub fn plan(&self, campaign: &Campaign) -> Result<(), Failure> {
        self.write("campaign.toml", &campaign.text)?;
        self.write(CAMPAIGN, &json(campaign)?).map(|_| ())
    }

    /// The folder of a campaign that began, and the campaign.
    pub fn open(root: &Path) -> Result<(Self, Campaign), Failure> {
        let path = root.join(CAMPAIGN);
        let failed = |e: &dyn std::fmt::Display| {
            Failure::failed(format!("{}: {e}: this is not the folder of a campaign", path.display()))
        };
        let text = input::text(&path, input::SETTINGS).map_err(|e| failed(&e))?;
        let campaign = serde_json::from_str(&text).map_err(|e| failed(&e))?;
        let root = root.canonicalize().map_err(|e| failed(&e))?;
        Ok((Self { root }, campaign))
    }

    /// Absolute path of the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The directories of the runs.
    fn members(&self) -> PathBuf {
        self.root.join("members")
    }

    /// The output of each member.
    pub(crate) fn logs(&self) -> PathBuf {
        self.root.join("logs")
    }

    /// The directory of the run of a member.
    pub fn run(&self, member: &Member) -> PathBuf {
        self.members().join(&member.name)
    }

    /// Progress of a member.
    pub fn state(&self, member: &Member) -> MemberState {
        let given_up = std::fs::read_to_string(self.given_up(member)).ok();
        if let Some(code) = given_up.and_then(|text| text.lines().next()?.trim().parse().ok()) {
            return MemberState::Failed(code);
        }
        match run_state(&self.run(member)) {
            RunState::Absent => MemberState::Waiting,
            RunState::Ended(0) if has_recording(&self.run(member)) => MemberState::Finished,
            RunState::Ended(code) if will_end_so_again(code) => MemberState::Failed(code),
            RunState::Begun | RunState::Ended(_) => MemberState::Interrupted,
        }
    }

    /// Numbers of the members that can still be run.
    pub(crate) fn pending(&self, campaign: &Campaign) -> Vec<usize> {
        let can_run = |n: &usize| {
            matches!(self.state(&campaign.members[*n]), MemberState::Waiting | MemberState::Interrupted)
        };
        (0..campaign.members.len()).filter(can_run).collect()
    }

    /// The file with the exit code of a member that was given up, and the limit that it reached.
    fn given_up(&self, member: &Member) -> PathBuf {
        self.logs().join(format!("{}.failed", member.name))
    }

    /// Gives up a member that ended so again and again.
    pub(crate) fn give_up(&self, member: &Member) -> Result<(), Failure> {
        let RunState::Ended(code) = run_state(&self.run(member)) else { return Ok(()) };
        self.fail(member, code, "")
    }

    /// Notes that a member failed; `limit` is the one that it reached.
    pub(crate) fn fail(&self, member: &Member, code: u8, limit: &str) -> Result<(), Failure> {
        let path = self.given_up(member);
        write_whole(&path, format!("{code}\n{limit}\n")).map_err(Failure::at(&path))
    }

    /// The limit that a member reached.
    fn limit(&self, member: &Member) -> Option<String> {
        let text = std::fs::read_to_string(self.given_up(member)).ok()?;
        text.lines().nth(1).filter(|line| !line.is_empty()).map(str::to_owned)
    }

    /// Why a member failed, if that is known.
    pub fn reason(&self, member: &Member) -> Option<String> {
        self.limit(member).or_else(|| end_reason(&self.run(member)))
    }

    /// Lets a failed member begin anew, or continue from where it reached a limit.
    pub(crate) fn redo(&self, member: &Member) -> Result<(), Failure> {
        match self.limit(member) {
            None => self.remove(member),
            Some(_) => {
                let path = self.given_up(member);
                std::fs::remove_file(&path).map_err(Failure::at(&path))
            }
        }
    }

    /// Removes the run of a member.
    pub(crate) fn remove(&self, member: &Member) -> Result<(), Failure> {
        let run = self.run(member);
        let _ = std::fs::remove_file(self.given_up(member));
        match std::fs::remove_dir_all(&run) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => Err(Failure::at(&run)(e)),
            _ => Ok(()),
        }
    }

    /// Writes a file of the campaign at once.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<PathBuf, Failure> {
        let path = self.root.join(name);
        write_whole(&path, content).map_err(Failure::at(&path))?;
        Ok(path)
    }
}

/// Time for another process that works in the folder to end.
const TIME_LIMIT: Duration = Duration::from_secs(10);

/// True if there is a file of a recording.
fn has_recording(run: &Path) -> bool {
    let is_recording =
        |e: io::Result<std::fs::DirEntry>| e.is_ok_and(|e| e.path().extension().is_some_and(|x| x == "mcap"));
    std::fs::read_dir(run).is_ok_and(|mut entries| entries.any(is_recording))
}

/// Name of the file of the members.
const CAMPAIGN: &str = "campaign.json";

/// True for an exit code that follows from the scene alone.
pub(crate) fn will_end_so_again(code: u8) -> bool {
    [Exit::Usage, Exit::PhysicsInvalid].iter().any(|exit| exit.code() == code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_campaign_is_read_back_from_its_folder_with_the_states_of_its_members() {
        let root = tempfile::tempdir().unwrap();
        let text = "name = 'x'\nscenes = ['s1']\nseeds = [1, 2, 3, 4]";
        let campaign = Campaign::parse(text, root.path()).unwrap();
        let (folder, _lock) = Folder::create(root.path()).unwrap();
        folder.plan(&campaign).unwrap();
        for (member, exit) in campaign.members.iter().zip([0, 4, 130]) {
            let run = folder.run(member);
            std::fs::create_dir_all(&run).unwrap();
            std::fs::write(run.join("summary.json"), format!("{{\"exit\": {exit}}}")).unwrap();
            std::fs::write(run.join("x_0.mcap"), "").unwrap();
        }
        let (again, known) = Folder::open(root.path()).unwrap();
        assert_eq!(known, campaign);
        let states: Vec<MemberState> = known.members.iter().map(|m| again.state(m)).collect();
        let expected =
            [MemberState::Finished, MemberState::Failed(4), MemberState::Interrupted, MemberState::Waiting];
        assert_eq!(states, expected);
        std::fs::remove_file(folder.run(&known.members[0]).join("x_0.mcap")).unwrap();
        assert_eq!(again.state(&known.members[0]), MemberState::Interrupted, "without its recording");
        again.remove(&known.members[0]).unwrap();
        again.remove(&known.members[0]).unwrap();
        assert_eq!(again.state(&known.members[0]), MemberState::Waiting);
        folder.fail(&known.members[2], 1, "ended at the limit").unwrap();
        assert_eq!(again.state(&known.members[2]), MemberState::Failed(1));
        assert_eq!(again.reason(&known.members[2]).as_deref(), Some("ended at the limit"));
        again.redo(&known.members[2]).unwrap();
        assert_eq!(again.state(&known.members[2]), MemberState::Interrupted, "it continues");
        assert!(Folder::open(&root.path().join("logs")).unwrap_err().to_string().contains("not the folder"));
    }
}
