//! Decides whose samples a process accepts, and counts the ignored ones by participant.

use crate::identity::{Identity, RunId, Scope, may_be_ours, member_of, run_of};
use grainlab_msgs::Guid;
use std::collections::BTreeMap;

/// The GUID prefix of one participant.
pub type Participant = [u8; 12];

/// Maximum number of participants counted separately; further ones are counted together, so that memory is bounded.
const MAX_COUNTED: usize = 64;

/// A participant whose samples were ignored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stranger {
    /// GUID prefix; zero for the participants that are counted together.
    pub participant: Participant,
    /// The run in its GUID prefix.
    pub run: Option<RunId>,
    /// Process of the participant, as in `pid 4711 (python3)`, if known.
    pub process: Option<String>,
    /// Number of ignored samples by resolved topic.
    pub ignored: BTreeMap<String, u64>,
}

/// The process if known, the run, or the GUID prefix.
impl std::fmt::Display for Stranger {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.participant == [0; 12] {
            return write!(f, "further processes");
        }
        match &self.process {
            Some(process) => write!(f, "{process}")?,
            None => {
                write!(f, "participant ")?;
                self.participant.iter().try_for_each(|byte| write!(f, "{byte:02x}"))?;
            }
        }
        match self.run {
            Some(run) if member_of(&self.participant) == 0 => {
                write!(f, " with the name of run {run}")
            }
            Some(run) => write!(f, " of run {run}"),
            None => Ok(()),
        }
    }
}

/// A process on this host.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Process {
    /// Id of the process; 0 for one of another user, whose sockets cannot be seen.
    pub pid: u32,
    /// Name, as `ps` shows it.
    pub name: String,
    /// True if it descends from the process that started the run.
    pub below_root: bool,
}

/// Decides for one process whose samples it accepts.
#[derive(Debug)]
pub(crate) struct Admission {
    identity: Identity,
    own: Participant,
    /// Processes of participants without a run, and of other users with the name of ours, if they are on this host.
    processes: BTreeMap<Participant, Process>,
    strangers: BTreeMap<Participant, Stranger>,
}

impl Admission {
    pub(crate) fn new(identity: Identity, own: Participant) -> Self {
        Self { identity, own, processes: BTreeMap::new(), strangers: BTreeMap::new() }
    }

    pub(crate) fn identity(&self) -> &Identity {
        &self.identity
    }

    pub(crate) fn discovered(&mut self, participant: Participant, process: Process) {
        // As many as discovery itself keeps; further ones have no name. Those that admission depends on are always kept.
        let decides = process.below_root || process.pid == 0;
        let has_room = self.processes.len() < 16 * MAX_COUNTED;
        if decides || has_room || self.processes.contains_key(&participant) {
            self.processes.insert(participant, process);
        }
    }

    /// True if this participant must be known, however many others there are: one of the same run, or, without a run, one of this
    /// program.
    pub(crate) fn counts_on(&self, participant: &Participant) -> bool {
        match self.identity.run {
            Some(own) => run_of(participant) == Some(own) || self.admits(participant),
            None => may_be_ours(participant),
        }
    }

    /// Removes a participant that left. One of the run stays: samples that it sent before may still arrive, as after this process
    /// was stopped for a while.
    pub(crate) fn lost(&mut self, participant: &Participant) {
        if self.processes.get(participant).is_some_and(|process| !process.below_root) {
            self.processes.remove(participant);
        }
    }

    pub(crate) fn admits(&self, participant: &Participant) -> bool {
        if self.identity.scope == Scope::Everyone || *participant == self.own {
            return true;
        }
        match (self.identity.run, run_of(participant)) {
            // A process of a launched run accepts samples of its members only. In a run by hand no process has a member
            // number: the name of the run decides.
            (Some(own), Some(run))
                if run == own && (self.identity.member == 0 || member_of(participant) != 0) =>
            {
                self.processes.get(participant).is_none_or(|p| p.below_root)
            }
            // The processes of another launcher have another root.
            (Some(_), _) => self.processes.get(participant).is_some_and(|p| p.below_root),
            (None, run) => run.is_none(),
        }
    }

    /// Decides on one sample; an ignored one is counted. The second value is true for the first one of its writer.
    pub(crate) fn takes(&mut self, writer: Guid, topic: &str) -> (bool, bool) {
        let participant = writer.participant();
        if self.admits(&participant) {
            return (true, false);
        }
        let full = self.strangers.len() >= MAX_COUNTED && !self.strangers.contains_key(&participant);
        let key = if full { [0; 12] } else { participant };
        let new = !self.strangers.contains_key(&key);
        if new {
            self.strangers.insert(key, self.describe(&key));
        }
        if let Some(stranger) = self.strangers.get_mut(&key) {
            match stranger.ignored.get_mut(topic) {
                Some(count) => *count += 1,
                None => _ = stranger.ignored.insert(topic.into(), 1),
            }
        }
        (false, new)
    }

    /// The participants whose samples were ignored, by GUID prefix.
    pub(crate) fn strangers(&self) -> Vec<Stranger> {
        self.strangers.values().cloned().collect()
    }

    pub(crate) fn describe(&self, participant: &Participant) -> Stranger {
        let process = self.processes.get(participant).filter(|p| p.pid != 0);
        let process = process.map(|p| format!("pid {} ({})", p.pid, p.name));
        let (participant, run) = (*participant, run_of(participant));
        Stranger { participant, run, process, ignored: BTreeMap::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HAND: Identity = Identity { run: None, member: 0, root: None, scope: Scope::OwnRun };

    fn writer(prefix: Participant) -> Guid {
        let mut id = [3; 16];
        id[..12].copy_from_slice(&prefix);
        Guid(id)
    }

    fn process(below_root: bool) -> Process {
        Process { pid: 7, name: "python3".into(), below_root }
    }

    #[test]
    fn a_member_takes_its_own_run_and_what_the_launcher_started_and_nobody_else() {
        let (run, other) =
            (Identity::member_of(RunId::named("a"), 1), Identity::member_of(RunId::named("b"), 1));
        let mut admission = Admission::new(run, run.guid_prefix());
        assert!(admission.admits(&run.guid_prefix()));
        assert!(!admission.admits(&other.guid_prefix()), "another run");
        assert!(!admission.admits(&HAND.guid_prefix()), "a node started by hand");
        let joined = Identity::member_of(RunId::named("a"), 0);
        assert!(
            !admission.admits(&joined.guid_prefix()),
            "a process with the run's name and without a member number"
        );
        assert!(
            Admission::new(joined, joined.guid_prefix()).admits(&run.guid_prefix()),
            "it receives the run's samples"
        );
        let other_user = Identity::member_of(RunId::named("a"), 2).guid_prefix();
        assert!(admission.admits(&other_user));
        admission.discovered(other_user, Process::default());
        assert!(!admission.admits(&other_user), "a process of another user with the run and a member number");
        let instrument = [0x01, 0x10, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5];
        assert!(!admission.admits(&instrument));
        admission.discovered(instrument, process(false));
        assert!(!admission.admits(&instrument), "other software that was not started by the launcher");
        admission.discovered(instrument, process(true));
        assert!(admission.admits(&instrument));
        admission.lost(&instrument);
        assert!(
            admission.admits(&instrument),
            "what it sent before it left, or before this process was continued"
        );
    }

    #[test]
    fn by_hand_a_node_of_the_lockstep_ignores_launched_runs_and_a_tool_receives_from_all() {
        let launched = Identity::member_of(RunId::named("a"), 1).guid_prefix();
        let by_hand = Admission::new(HAND, HAND.guid_prefix());
        assert!(!by_hand.admits(&launched));
        assert!(by_hand.admits(&HAND.guid_prefix()));
        let tool = Admission::new(Identity::default(), Identity::default().guid_prefix());
        assert!(tool.admits(&launched) && tool.admits(&HAND.guid_prefix()));
    }

    #[test]
    fn a_process_of_the_run_must_be_known_and_so_must_a_program_that_the_launcher_started_among_any_number() {
        let [own, other] = ["a", "b"].map(|name| Identity::member_of(RunId::named(name), 1));
        let mut admission = Admission::new(own, own.guid_prefix());
        assert!(admission.counts_on(&own.guid_prefix()));
        let by_name = Identity { member: 0, ..own };
        assert!(admission.counts_on(&by_name.guid_prefix()), "started by hand with the name of the run");
        assert!(!admission.counts_on(&other.guid_prefix()) && !admission.counts_on(&HAND.guid_prefix()));
        let instrument = |number: u16| {
            let [high, low] = number.to_be_bytes();
            [0x01, 0x10, 5, 5, 5, 5, 5, 5, 5, 5, high, low]
        };
        (0..2000).for_each(|n| admission.discovered(instrument(n), process(false)));
        assert!(!admission.counts_on(&instrument(3000)));
        admission.discovered(instrument(3000), process(true));
        assert!(admission.counts_on(&instrument(3000)) && admission.admits(&instrument(3000)));
        let by_hand = Admission::new(HAND, HAND.guid_prefix());
        assert!(by_hand.counts_on(&HAND.guid_prefix()) && !by_hand.counts_on(&instrument(1)));
    }

    #[test]
    fn strangers_are_counted_by_topic_and_a_flood_of_them_together() {
        let run = Identity::member_of(RunId::named("a"), 1);
        let mut admission = Admission::new(run, run.guid_prefix());
        let stranger = HAND.guid_prefix();
        assert_eq!(admission.takes(writer(stranger), "/stress"), (false, true));
        assert_eq!(admission.takes(writer(stranger), "/stress"), (false, false));
        assert_eq!(admission.strangers()[0].ignored["/stress"], 2);
        (0..1000).for_each(|_| {
            admission.takes(writer(HAND.guid_prefix()), "/moduli");
        });
        let known = admission.strangers();
        assert_eq!(known.len(), MAX_COUNTED + 1);
        let counted: u64 = known.iter().flat_map(|s| s.ignored.values()).sum();
        assert_eq!(counted, 1002);
    }
}
