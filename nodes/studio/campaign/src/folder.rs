//! The folder of a campaign, and how far its members came.

use crate::campaign::Campaign;
use crate::member::Member;
use grainlab_console::{Failure, append_in, json, replace_whole};
use grainlab_msgs::Exit;
use grainlab_recordings::{AtWork, Lock, RunEnd, RunState, input, run_end, run_state};
use serde::Serialize;
use std::collections::BTreeSet;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Progress of a member.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemberState {
    /// It has not begun.
    Waiting,
    /// A process is at work on it.
    Running,
    /// It began on another host, whose processes cannot be seen from here.
    Unknown,
    /// It began, is not finished, and no process is at work on it: it can be continued.
    Interrupted,
    /// It ended with this exit code, and would end so again.
    Failed(u8),
    /// The run is finished, and the recording whole.
    Finished,
}

/// State of a member, and the reason why it is not finished.
#[derive(Clone, Debug, Serialize)]
pub struct Standing {
    /// Name of the member.
    pub name: String,
    /// State in one word.
    pub state: &'static str,
    /// Why it is not finished, or what runs it.
    pub reason: Option<String>,
    /// Wall time, s: so far, or of its last process. `None` for one that runs on another host.
    pub seconds: Option<f64>,
}

impl Standing {
    const STATES: [&str; 6] = ["finished", "running", "waiting", "interrupted", "failed", "unknown"];

    /// Number of members in each state, without states that have none.
    pub fn counts(all: &[Self]) -> Vec<(&'static str, usize)> {
        let count = |state| (state, all.iter().filter(|s| s.state == state).count());
        Self::STATES.into_iter().map(count).filter(|(_, n)| *n > 0).collect()
    }

    /// [`Standing::counts`] in words.
    pub fn words(all: &[Self]) -> String {
        Self::counts(all).iter().map(|(state, n)| format!("{n} {state}")).collect::<Vec<_>>().join(", ")
    }
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

    /// Creates the folder of a campaign, or finds it.
    ///
    /// # Errors
    /// Returns wrong usage for the folder of another campaign, and for one with files that the campaign would replace.
    pub fn create(root: &Path, campaign: &Campaign) -> Result<Self, Failure> {
        refuse_others(root, campaign)?;
        let failed = |e: io::Error| Failure::failed(format!("the folder {}: {e}", root.display()));
        std::fs::create_dir_all(root).map_err(failed)?;
        let folder = Self { root: root.canonicalize().map_err(failed)? };
        for part in [folder.members(), folder.logs()] {
            std::fs::create_dir_all(part).map_err(failed)?;
        }
        Ok(folder)
    }

    /// Reserves the folder for this process, as long as the lock is held.
    pub fn lock(&self) -> Result<Lock, Failure> {
        Lock::take(&self.root, TIME_LIMIT)
    }

    /// For this process alone to write the tables, as long as the lock is held. The campaign may go on.
    pub fn lock_tables(&self) -> Result<Lock, Failure> {
        Lock::take(&self.logs(), TIME_TO_GATHER)
    }

    /// Writes what its members are; refuses the folder of another campaign, which may have begun meanwhile.
    pub fn plan(&self, campaign: &Campaign) -> Result<(), Failure> {
        refuse_others(&self.root, campaign)?;
        self.write(TEXT, &campaign.text)?;
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

    fn members(&self) -> PathBuf {
        self.root.join(MEMBERS)
    }

    pub(crate) fn logs(&self) -> PathBuf {
        self.root.join(LOGS)
    }

    /// The directory of the run of a member.
    pub fn run(&self, member: &Member) -> PathBuf {
        self.members().join(&member.name)
    }

    /// Number of runs of members that are not in the campaign: an earlier file had them.
    pub fn others(&self, campaign: &Campaign) -> usize {
        let names: BTreeSet<&str> = campaign.members.iter().map(|m| m.name.as_str()).collect();
        let runs = std::fs::read_dir(self.members()).into_iter().flatten().flatten();
        runs.filter(|run| run.file_name().to_str().is_some_and(|name| !names.contains(name))).count()
    }

    /// Progress of a member.
    pub fn state(&self, member: &Member) -> MemberState {
        self.look(member).0
    }

    fn look(&self, member: &Member) -> (MemberState, AtWork) {
        let run = self.run(member);
        // Before its end is looked for: a run that ends meanwhile is not taken for a killed one.
        let at_work = Lock::at_work(&run);
        let given_up = input::text(&self.given_up(member), input::SETTINGS).ok();
        if let Some(code) = given_up.and_then(|text| text.lines().next()?.trim().parse().ok()) {
            return (MemberState::Failed(code), at_work);
        }
        let state = match (run_state(&run), &at_work) {
            (RunState::Ended(0), _) if has_recording(&run) => MemberState::Finished,
            (RunState::Ended(code), _) if will_end_so_again(code) => MemberState::Failed(code),
            (_, AtWork::Holder(_)) => MemberState::Running,
            (_, AtWork::Elsewhere(_)) => MemberState::Unknown,
            (RunState::Absent, _) => MemberState::Waiting,
            _ => MemberState::Interrupted,
        };
        (state, at_work)
    }

    /// Progress of a member, with its reason and its time.
    pub fn standing(&self, member: &Member) -> Standing {
        let (name, run) = (member.name.clone(), self.run(member));
        let (state, at_work) = self.look(member);
        let end = run_end(&run);
        let killed = || "its process ended without a result".to_owned();
        let ended = |state| (state, Some(end.as_ref().map_or_else(killed, RunEnd::reason)));
        let (state, reason) = match (state, at_work) {
            (MemberState::Finished, _) => ("finished", None),
            (MemberState::Waiting, _) => ("waiting", self.last_line(member)),
            (MemberState::Failed(_), _) => match self.limit(member) {
                None => ended("failed"),
                limit => ("failed", limit),
            },
            (_, AtWork::Holder(who)) => ("running", Some(who)),
            (_, AtWork::Elsewhere(who)) => {
                ("unknown", Some(format!("begun by {who}, and only there it is seen whether that runs")))
            }
            _ => ended("interrupted"),
        };
        let seconds = match state {
            "running" => Lock::held_for(&run).map(|time| time.as_secs_f64()),
            _ => end.as_ref().and_then(|end| end.wall_seconds),
        };
        Standing { name, state, reason, seconds }
    }

    /// The end of the log of a member that was tried, and left no run.
    fn last_line(&self, member: &Member) -> Option<String> {
        let log = input::text(&self.log(member), input::TEXT).ok()?;
        log.lines()
            .rfind(|line| !line.trim().is_empty())
            .filter(|line| line.contains("error"))
            .map(|line| format!("did not begin: {line}"))
    }

    /// Numbers of the members that can still be run.
    pub(crate) fn pending(&self, campaign: &Campaign) -> Vec<usize> {
        let can_run = |n: &usize| {
            !matches!(self.state(&campaign.members[*n]), MemberState::Finished | MemberState::Failed(_))
        };
        (0..campaign.members.len()).filter(can_run).collect()
    }

    pub(crate) fn log(&self, member: &Member) -> PathBuf {
        self.logs().join(log_name(member))
    }

    pub(crate) fn open_log(&self, member: &Member) -> io::Result<File> {
        append_in(&self.logs(), &log_name(member))
    }

    /// The file with the exit code of a member that was given up, and the limit that it reached.
    fn given_up(&self, member: &Member) -> PathBuf {
        self.logs().join(format!("{}.failed", member.name))
    }

    pub(crate) fn give_up(&self, member: &Member) -> Result<(), Failure> {
        let RunState::Ended(code) = run_state(&self.run(member)) else { return Ok(()) };
        self.fail(member, code, "")
    }

    /// Notes that a member failed; `limit` is the one that it reached.
    pub(crate) fn fail(&self, member: &Member, code: u8, limit: &str) -> Result<(), Failure> {
        let path = self.given_up(member);
        replace_whole(&path, format!("{code}\n{limit}\n")).map_err(Failure::at(&path))
    }

    fn limit(&self, member: &Member) -> Option<String> {
        let text = input::text(&self.given_up(member), input::SETTINGS).ok()?;
        text.lines().nth(1).filter(|line| !line.is_empty()).map(str::to_owned)
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

    pub(crate) fn remove(&self, member: &Member) -> Result<(), Failure> {
        let run = self.run(member);
        let _ = std::fs::remove_file(self.given_up(member));
        match std::fs::remove_dir_all(&run) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => Err(Failure::at(&run)(e)),
            _ => Ok(()),
        }
    }

    /// Writes a file of the campaign at once, one of `FILES`.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<PathBuf, Failure> {
        assert!([TEXT, CAMPAIGN].iter().chain(&FILES).any(|known| *known == name), "{name} is none of FILES");
        let path = self.root.join(name);
        replace_whole(&path, content).map_err(Failure::at(&path))?;
        Ok(path)
    }
}

fn log_name(member: &Member) -> String {
    format!("{}.log", member.name)
}

/// Time for another process that works in the folder to end.
const TIME_LIMIT: Duration = Duration::from_secs(10);

/// Time for another process to write the tables.
const TIME_TO_GATHER: Duration = Duration::from_secs(600);

fn has_recording(run: &Path) -> bool {
    let is_recording =
        |e: io::Result<std::fs::DirEntry>| e.is_ok_and(|e| e.path().extension().is_some_and(|x| x == "mcap"));
    std::fs::read_dir(run).is_ok_and(|mut entries| entries.any(is_recording))
}

/// Refuses a folder of another campaign, and a folder without a campaign in which this one would replace a file.
fn refuse_others(root: &Path, campaign: &Campaign) -> Result<(), Failure> {
    let known = Folder::open(root).ok().map(|(_, known)| known);
    if let Some(Campaign { name, .. }) = known.as_ref().filter(|known| known.name != campaign.name) {
        let root = root.display();
        return Err(Failure::usage(format!("{root}: the campaign {name} is there: choose another folder")));
    }
    // The text that the campaign was read from, or that an earlier start wrote.
    let texts = [Some(&campaign.text), known.as_ref().map(|known| &known.text)];
    let is_own = |text: String| texts.contains(&Some(&text));
    let of_campaign = |name: &str| match name {
        TEXT => input::text(&root.join(name), input::SETTINGS).is_ok_and(is_own),
        _ => known.is_some(),
    };
    // Folders may be empty: a campaign that was killed at its start leaves them.
    let is_there = |path: &Path| match std::fs::read_dir(path) {
        Ok(mut entries) => entries.next().is_some(),
        Err(_) => path.symlink_metadata().is_ok(),
    };
    let is_other = |name: &&str| is_there(&root.join(name)) && !of_campaign(name);
    let mut names = [TEXT, CAMPAIGN, MEMBERS, LOGS].into_iter().chain(FILES);
    let Some(name) = names.find(is_other) else { return Ok(()) };
    Err(Failure::usage(format!(
        "{}: this is not of this campaign, which would replace it: choose another folder with --out, or move it",
        root.join(name).display()
    )))
}

const MEMBERS: &str = "members";

const LOGS: &str = "logs";

/// Name of the copy of the file of the campaign.
const TEXT: &str = "campaign.toml";

/// Name of the file of the members.
const CAMPAIGN: &str = "campaign.json";

/// Names of the files of results, and of the programs for a cluster.
const FILES: [&str; 7] =
    ["states.csv", "groups.csv", "index.html", "reproduction.json", "reproduction.csv", "tasks.sh", "hq.py"];

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
        let text = "name = 'x'\nscenes = ['s1']\nseeds = [1, 2, 3, 4, 5]";
        let campaign = Campaign::parse(text, root.path()).unwrap();
        let folder = Folder::create(root.path(), &campaign).unwrap();
        folder.plan(&campaign).unwrap();
        for (member, exit) in campaign.members.iter().zip([0, 4, 130]) {
            let run = folder.run(member);
            std::fs::create_dir_all(&run).unwrap();
            std::fs::write(run.join("summary.json"), format!("{{\"exit\": {exit}}}")).unwrap();
            std::fs::write(run.join("x_0.mcap"), "").unwrap();
        }
        let (again, known) = Folder::open(root.path()).unwrap();
        assert_eq!(known, campaign);
        let killed = folder.run(&known.members[4]);
        std::fs::create_dir_all(&killed).unwrap();
        std::fs::write(killed.join("launch.json"), "{}").unwrap();
        let at_work = Lock::take(&killed, Duration::ZERO).unwrap();
        let hour = Duration::from_secs(3600);
        let lock = File::options().append(true).open(killed.join(Lock::FILE)).unwrap();
        lock.set_modified(std::time::SystemTime::now() - hour).unwrap();
        let running = again.standing(&known.members[4]);
        assert!(running.seconds.is_some_and(|s| s < 60.0), "the wall clock was set forward by an hour");
        assert_eq!(running.state, "running");
        drop(at_work);
        let standings: Vec<Standing> = known.members.iter().map(|m| again.standing(m)).collect();
        assert_eq!(Standing::words(&standings), "1 finished, 1 waiting, 2 interrupted, 1 failed");
        assert_eq!(standings[4].reason.as_deref(), Some("its process ended without a result"));
        std::fs::remove_file(folder.run(&known.members[0]).join("x_0.mcap")).unwrap();
        assert_eq!(again.state(&known.members[0]), MemberState::Interrupted, "without its recording");
        again.remove(&known.members[0]).unwrap();
        again.remove(&known.members[0]).unwrap();
        assert_eq!(again.state(&known.members[0]), MemberState::Waiting);
        folder.fail(&known.members[2], 1, "ended at the limit").unwrap();
        assert_eq!(again.state(&known.members[2]), MemberState::Failed(1));
        assert_eq!(again.standing(&known.members[2]).reason.as_deref(), Some("ended at the limit"));
        again.redo(&known.members[2]).unwrap();
        assert_eq!(again.state(&known.members[2]), MemberState::Interrupted, "it continues");
        assert!(Folder::open(&root.path().join("logs")).unwrap_err().to_string().contains("not the folder"));
        let fewer = Campaign { members: known.members[..2].to_vec(), ..known.clone() };
        assert_eq!([&known, &fewer].map(|campaign| again.others(campaign)), [0, 2]);
        let refused = folder.plan(&Campaign { name: "y".into(), ..known.clone() }).unwrap_err().to_string();
        assert!(refused.ends_with("the campaign x is there: choose another folder"), "{refused}");
        std::fs::write(root.path().join(TEXT), "# edited").unwrap();
        let refused = folder.plan(&known).unwrap_err().to_string();
        assert!(refused.contains("campaign.toml: this is not of this campaign"), "{refused}");
    }

    #[test]
    fn a_campaign_replaces_no_file_of_others() {
        let text = "name = 'x'\nscenes = ['s1']\nseeds = [1]";
        let campaign = Campaign::parse(text, Path::new("")).unwrap();
        for name in [TEXT, CAMPAIGN].into_iter().chain(FILES) {
            let root = tempfile::tempdir().unwrap();
            std::fs::write(root.path().join(name), "of the user").unwrap();
            let refused = Folder::create(root.path(), &campaign).unwrap_err();
            assert_eq!(refused.exit, Exit::Usage);
            assert!(refused.to_string().contains(&format!("{name}: this is not of")), "{refused}");
            assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 1, "nothing is made");
        }
        let root = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(root.path().join("members/s1-1")).unwrap();
        let refused = Folder::create(root.path(), &campaign).unwrap_err().to_string();
        assert!(refused.contains("members: this is not of"), "{refused}");
        // The file of the campaign may be in its folder.
        let root = tempfile::tempdir().unwrap();
        std::fs::write(root.path().join(TEXT), text).unwrap();
        std::fs::write(root.path().join("notes.txt"), "").unwrap();
        let folder = Folder::create(root.path(), &campaign).unwrap();
        folder.plan(&campaign).unwrap();
        folder.write("states.csv", "a").unwrap();
        Folder::create(root.path(), &campaign).unwrap().plan(&campaign).unwrap();
    }
}
