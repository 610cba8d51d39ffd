//! What the end of a run waits for, without clock and bus: the data about the last packing, and an answer to each of them.

use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::{Exit, Participant, member_of, run_of};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// Topics of data about packings.
pub(crate) const DATA: [Topic; 3] = [topics::PACKING_REPORT, topics::MODULI, topics::WAVE_SPEEDS];

/// Topics that nodes and programs write.
const OF_PROGRAMS: [Topic; 2] = [topics::MODULI, topics::WAVE_SPEEDS];

/// Time between two looks that counts at most: this process was stopped in a longer one.
const LOOK: Duration = Duration::from_secs(2);

/// Longest time for further data of programs, once all that are expected are answered.
const SETTLES_WITHIN: Duration = Duration::from_secs(60);

/// Wave speeds that were recorded before a run is resumed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordedSpeeds {
    /// Number of sets of speeds, by the step of their packing.
    pub measured: BTreeMap<u64, usize>,
    /// Steps of the packings whose speeds were inverted.
    pub inverted: BTreeSet<u64>,
}

/// Who sends data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Sender {
    /// A node that measures every packing, and says of each that it has.
    Node,
    /// A program that measures the packings of its choice.
    Program,
}

/// The processes of the run, as far as discovery and heartbeats tell.
#[derive(Clone, Debug, Default)]
pub(crate) struct Processes {
    /// Writers of each topic of data.
    pub(crate) writers: BTreeMap<&'static str, BTreeSet<Participant>>,
    /// Writers of answers.
    pub(crate) inversions: BTreeSet<Participant>,
    /// Nodes that measure every packing, and whether each is at work.
    pub(crate) measuring: BTreeMap<Participant, bool>,
    /// Names of the nodes whose heartbeats were received.
    pub(crate) names: BTreeMap<Participant, String>,
    /// True while one of them is stopped by a signal.
    pub(crate) any_stopped: bool,
}

/// What is known about the last packing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum State {
    /// Data of this topic are missing.
    Open(&'static Topic, Sender),
    /// Data of this topic are missing, and the node that sends them is not there.
    Left(&'static Topic),
    /// Data of this topic have no answer of every inversion.
    Answering(&'static Topic),
    /// A node found nothing to invert.
    Declined(&'static Topic),
    /// Data of this topic are missing, and no program that sends them is left.
    Gone(&'static Topic),
    /// All data are answered. A process writes this topic and has sent no heartbeat yet: it may be a node that measures.
    Unheard(&'static Topic),
    /// All data are answered; a program may send more.
    Settling,
    /// All data are answered.
    Complete,
}

/// The end of the wait, and why the run is not complete.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Verdict {
    pub(crate) exit: Exit,
    pub(crate) reason: String,
}

/// Numbers of messages, by packing.
type Counts = BTreeMap<u64, usize>;

/// Data and answers received so far, and for how long the present state lasts.
#[derive(Clone, Debug, Default)]
pub(crate) struct RunEnd {
    awaited: Vec<Topic>,
    recorded: RecordedSpeeds,
    /// The last packing is recorded within a phase: it may have no data.
    within_phase: bool,
    data: BTreeMap<(&'static str, Participant), Counts>,
    /// Data without a value to invert.
    declined: BTreeSet<(&'static str, Participant, u64)>,
    answers: BTreeMap<(&'static str, Participant), Counts>,
    /// Why data of the run were refused, of the first ones.
    refused: Option<String>,
    state: Option<State>,
    lasted: Duration,
    /// Time since all expected data were answered first.
    settling: Duration,
    looked: Option<Duration>,
}

impl RunEnd {
    /// Waits in any case for data of the topics `awaited`, and for data of the programs that sent the speeds `recorded`.
    pub(crate) fn new(awaited: &[Topic], recorded: RecordedSpeeds, within_phase: bool) -> Self {
        Self { awaited: awaited.to_vec(), recorded, within_phase, ..Self::default() }
    }

    /// Forgets what was received: latched messages of an earlier run.
    pub(crate) fn begin(&mut self) {
        self.data.clear();
        self.declined.clear();
        self.answers.clear();
        self.refused = None;
    }

    /// Notes why data were refused, which have no estimate.
    pub(crate) fn hear_refused(&mut self, why: String) {
        self.refused.get_or_insert(why);
    }

    /// Notes data about the packing of `step`; `is_declined` if they have no value to invert.
    pub(crate) fn hear_data(&mut self, topic: &Topic, step: u64, from: Participant, is_declined: bool) {
        let Some(topic) = DATA.iter().find(|known| known.name == topic.name) else { return };
        *self.data.entry((topic.name, from)).or_default().entry(step).or_default() += 1;
        if is_declined {
            self.declined.insert((topic.name, from, step));
        }
        self.lasted = Duration::ZERO;
    }

    /// Notes an answer to data of the topic named `source`.
    pub(crate) fn hear_answer(&mut self, source: &str, step: u64, from: Participant) {
        let Some(topic) = DATA.iter().find(|known| known.name == source) else { return };
        *self.answers.entry((topic.name, from)).or_default().entry(step).or_default() += 1;
        self.lasted = Duration::ZERO;
    }

    /// Looks at the packing of `step` at the time `now`: what its end waits for, or the verdict.
    pub(crate) fn look(
        &mut self,
        step: u64,
        processes: &Processes,
        now: Duration,
    ) -> Result<Verdict, String> {
        let state = self.state(step, processes);
        let passed = now.saturating_sub(self.looked.replace(now).unwrap_or(now)).min(LOOK);
        let is_new = self.state.replace(state) != Some(state);
        if is_new || self.is_at_work(state, processes) {
            self.lasted = Duration::ZERO;
        } else if !processes.any_stopped {
            self.lasted += passed;
        }
        if state == State::Settling || !self.settling.is_zero() {
            self.settling += passed;
        }
        let limit = self.limit(state);
        let has_settled = state == State::Settling && self.settling >= SETTLES_WITHIN;
        if self.lasted >= limit || has_settled {
            return Ok(self.verdict(state, step, limit));
        }
        Err(match state {
            State::Open(topic, _) | State::Left(topic) | State::Gone(topic) => {
                format!("{} of step {step}", topic.name)
            }
            State::Unheard(topic) => format!("a heartbeat of a process that writes {}", topic.name),
            State::Answering(topic) => format!("the inversion of the {} of step {step}", topic.name),
            _ => format!("further data of step {step}"),
        })
    }

    fn is_at_work(&self, state: State, processes: &Processes) -> bool {
        let State::Open(topic, Sender::Node) = state else { return false };
        let writers = processes.writers.get(topic.name).into_iter().flatten();
        writers.filter_map(|writer| processes.measuring.get(writer)).any(|is_at_work| *is_at_work)
    }

    /// Returns the longest time that the end of the run waits in a state.
    fn limit(&self, state: State) -> Duration {
        Duration::from_secs(match state {
            State::Open(_, Sender::Node) if !self.within_phase => 600,
            State::Open(..) | State::Left(_) => 60,
            State::Answering(_) => 30,
            State::Gone(_) | State::Unheard(_) => 5,
            State::Settling => 2,
            State::Declined(_) | State::Complete => 0,
        })
    }

    fn verdict(&self, state: State, step: u64, limit: Duration) -> Verdict {
        let seconds = limit.as_secs();
        let (exit, reason) = match state {
            State::Answering(topic) => (
                Exit::Failure,
                format!(
                    "the data on {} about the last packing (step {step}) were not inverted within {seconds} s",
                    topic.name
                ),
            ),
            State::Complete | State::Settling | State::Unheard(_) => match &self.refused {
                None => (Exit::Done, String::new()),
                Some(why) => (Exit::DataLoss, format!("data were refused and have no estimate: {why}")),
            },
            _ if self.within_phase => (Exit::Done, String::new()),
            State::Open(topic, Sender::Node) => (
                Exit::Failure,
                format!(
                    "the last packing (step {step}) was not measured: no {} within {seconds} s",
                    topic.name
                ),
            ),
            State::Left(topic) => (
                Exit::Failure,
                format!(
                    "the last packing (step {step}) was not measured: the node that sent {} of other packings has ended",
                    topic.name
                ),
            ),
            State::Declined(topic) => {
                let nothing =
                    if topic.name == topics::WAVE_SPEEDS.name { "wave speeds" } else { "stiffness" };
                (Exit::PhysicsInvalid, format!("the last packing (step {step}) has no {nothing} to invert"))
            }
            State::Open(topic, Sender::Program) => (
                Exit::DataLoss,
                format!(
                    "the last packing (step {step}) lacks {}, which programs sent about every other packing, or which are awaited: \
                     too few arrived within {seconds} s",
                    topic.name
                ),
            ),
            State::Gone(topic) => (
                Exit::DataLoss,
                format!(
                    "the last packing (step {step}) lacks {}, which a program sent about every other packing: that program has \
                     ended",
                    topic.name
                ),
            ),
        };
        Verdict { exit, reason }
    }

    /// Returns the state of the packing of `step`: that of the data that are furthest from complete.
    fn state(&self, step: u64, processes: &Processes) -> State {
        let expected = self.expected(step, processes);
        if expected.is_empty() {
            return State::Open(&DATA[0], Sender::Node);
        }
        let is_gone = |e: &Expected| e.missing && e.sender == Sender::Program && !e.is_sender_present;
        let (gone, left): (Vec<_>, Vec<_>) = expected.iter().partition(|e| is_gone(e));
        if let Some(open) = left.iter().find(|e| e.missing) {
            let has_left = open.sender == Sender::Node && !open.is_sender_present && open.is_known;
            return if has_left { State::Left(open.topic) } else { State::Open(open.topic, open.sender) };
        }
        if let Some(open) = left.iter().find(|e| !e.is_answered) {
            return State::Answering(open.topic);
        }
        if let Some(declined) = left.iter().find(|e| e.is_declined) {
            return State::Declined(declined.topic);
        }
        if let Some(gone) = gone.first() {
            return State::Gone(gone.topic);
        }
        if let Some(unheard) = OF_PROGRAMS.iter().find(|topic| self.is_unheard(topic, processes)) {
            return State::Unheard(unheard);
        }
        if processes.inversions.iter().any(|p| self.is_unheard_inversion(p, processes)) {
            return State::Unheard(&topics::MICROSTRUCTURE);
        }
        let may_send = |e: &&Expected| e.sender == Sender::Program && e.is_sender_present;
        if left.into_iter().any(|e| may_send(&e)) { State::Settling } else { State::Complete }
    }

    /// True if a process writes a topic, and has sent neither data nor a heartbeat.
    fn is_unheard(&self, topic: &Topic, processes: &Processes) -> bool {
        let is_known =
            |w: &Participant| processes.names.contains_key(w) || self.data.contains_key(&(topic.name, *w));
        processes.writers.get(topic.name).is_some_and(|writers| !writers.iter().all(is_known))
    }

    /// Returns the data that are expected about the packing of `step`.
    fn expected(&self, step: u64, processes: &Processes) -> Vec<Expected> {
        let of_topic =
            |topic| [self.of_nodes(topic, step, processes), self.of_programs(topic, step, processes)];
        DATA.iter().flat_map(of_topic).flatten().collect()
    }

    /// Returns what a node sends about the packing of `step`, if one writes the topic or has sent data about any packing.
    fn of_nodes(&self, topic: &'static Topic, step: u64, processes: &Processes) -> Option<Expected> {
        let counts = self.counts(topic, Sender::Node, processes);
        let is_sender_present = processes.has_writer(topic, Sender::Node);
        (is_sender_present || !counts.is_empty()).then(|| Expected {
            topic,
            sender: Sender::Node,
            missing: !counts.contains_key(&step),
            is_answered: self.is_answered(topic, step, 1, processes),
            is_declined: self.is_declined(topic, step, processes),
            is_sender_present,
            is_known: !counts.is_empty(),
        })
    }

    /// Returns what programs send about the packing of `step`, if they have sent data about any packing or their data are awaited.
    fn of_programs(&self, topic: &'static Topic, step: u64, processes: &Processes) -> Option<Expected> {
        let by_node = self.of_nodes(topic, step, processes);
        let mut counts = self.counts(topic, Sender::Program, processes);
        let is_recorded = topic.name == topics::WAVE_SPEEDS.name && by_node.is_none();
        let is_settled = is_recorded && self.recorded.inverted.contains(&step) && !counts.contains_key(&step);
        if is_recorded {
            let others = self.recorded.measured.iter().filter(|(other, _)| **other != step);
            others.for_each(|(step, n)| *counts.entry(*step).or_default() += n);
        }
        let is_awaited = by_node.is_none() && self.awaited.iter().any(|awaited| awaited.name == topic.name);
        if counts.is_empty() && !is_awaited {
            return None;
        }
        // A program that sent several sets of data about every other packing sends as many about this one.
        let of_others = counts.iter().filter(|(other, _)| **other != step).map(|(_, sets)| *sets).min();
        let sets = counts.get(&step).copied().unwrap_or(0);
        let answers = sets + usize::from(by_node.is_some_and(|data| !data.missing));
        Some(Expected {
            topic,
            sender: if Processes::is_of_nodes(topic) { Sender::Node } else { Sender::Program },
            missing: !is_settled && sets < of_others.unwrap_or(1),
            is_answered: is_settled || self.is_answered(topic, step, answers, processes),
            is_declined: false,
            is_sender_present: counts.is_empty() || processes.has_writer(topic, Sender::Program),
            is_known: !counts.is_empty(),
        })
    }

    /// Counts the data of a topic by packing.
    fn counts(&self, topic: &Topic, sender: Sender, processes: &Processes) -> Counts {
        let mut counts = Counts::new();
        for ((name, from), by_step) in &self.data {
            if *name == topic.name && processes.sender(topic, from) == sender {
                by_step.iter().for_each(|(step, n)| *counts.entry(*step).or_default() += n);
            }
        }
        counts
    }

    /// True if a node found nothing to invert.
    fn is_declined(&self, topic: &Topic, step: u64, processes: &Processes) -> bool {
        let by_node = |from| processes.sender(topic, from) == Sender::Node;
        self.declined.iter().any(|(name, from, of)| (*name, *of) == (topic.name, step) && by_node(from))
    }

    /// True if as many inversions have given so many answers as there are inversions.
    fn is_answered(&self, topic: &Topic, step: u64, sets: usize, processes: &Processes) -> bool {
        // A restarted inversion goes on with the answers of its predecessor.
        let mut by_inversion: BTreeMap<String, usize> = BTreeMap::new();
        for ((name, from), counts) in &self.answers {
            let answers = by_inversion.entry(processes.name(from)).or_default();
            *answers += counts.get(&step).filter(|_| *name == topic.name).copied().unwrap_or(0);
        }
        let heard = processes.inversions.iter().filter(|p| !self.is_unheard_inversion(p, processes));
        let inversions: BTreeSet<String> = heard.map(|p| processes.name(p)).collect();
        by_inversion.values().filter(|answers| **answers >= sets).count() >= inversions.len().max(1)
    }

    /// True if this inversion has sent neither answers nor a heartbeat: it may have been killed at its start.
    fn is_unheard_inversion(&self, of: &Participant, processes: &Processes) -> bool {
        let has_answered = self.answers.keys().any(|(_, from)| from == of);
        !has_answered && member(of).is_none() && !processes.names.contains_key(of)
    }
}

impl Processes {
    /// True if only nodes write a topic.
    fn is_of_nodes(topic: &Topic) -> bool {
        !OF_PROGRAMS.iter().any(|known| known.name == topic.name)
    }

    /// Returns which kind of process sends data on a topic.
    fn sender(&self, topic: &Topic, from: &Participant) -> Sender {
        let is_node = self.measuring.contains_key(from) || Self::is_of_nodes(topic);
        if is_node { Sender::Node } else { Sender::Program }
    }

    fn has_writer(&self, topic: &Topic, sender: Sender) -> bool {
        let writers = self.writers.get(topic.name).into_iter().flatten();
        writers.into_iter().any(|writer| self.sender(topic, writer) == sender)
    }

    /// Returns a name that is the same before and after a restart, if the process has one.
    fn name(&self, of: &Participant) -> String {
        let of_node = || self.names.get(of).cloned().unwrap_or_else(|| format!("{of:02x?}"));
        member(of).map_or_else(of_node, |member| format!("member {member}"))
    }
}

/// Returns the number of a process in its launch.
fn member(of: &Participant) -> Option<u8> {
    Some(member_of(of)).filter(|member| *member > 0 && run_of(of).is_some())
}

/// Data of one topic that are expected about a packing.
struct Expected {
    topic: &'static Topic,
    sender: Sender,
    missing: bool,
    is_answered: bool,
    is_declined: bool,
    is_sender_present: bool,
    /// Data about some packing arrived.
    is_known: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_node_kit::{Identity, RunId};

    const REPORT: &Topic = &topics::PACKING_REPORT;
    const MODULI: &Topic = &topics::MODULI;
    const SPEEDS: &Topic = &topics::WAVE_SPEEDS;

    const ANALYZER: Participant = [1; 12];
    const PROBE: Participant = [2; 12];
    const PROGRAM: Participant = [3; 12];
    const INVERSION: Participant = [4; 12];

    /// The processes of a run with an inversion and these writers; analyzer and probe measure every packing.
    fn processes(writers: &[(&Topic, Participant)]) -> Processes {
        let mut found = Processes { inversions: [INVERSION].into(), ..Processes::default() };
        for (topic, writer) in writers {
            found.writers.entry(topic.name).or_default().insert(*writer);
        }
        found.measuring = [(ANALYZER, false), (PROBE, false)].into();
        let names =
            [(ANALYZER, "analyzer"), (PROBE, "probe"), (PROGRAM, "program"), (INVERSION, "inversion")];
        found.names = names.map(|(participant, name)| (participant, name.to_owned())).into();
        found
    }

    fn end() -> RunEnd {
        RunEnd::default()
    }

    /// Data about a packing, and their answer.
    fn answered(end: &mut RunEnd, topic: &Topic, step: u64, from: Participant) {
        end.hear_data(topic, step, from, false);
        end.hear_answer(topic.name, step, INVERSION);
    }

    /// The exit, and the whole seconds after which it is known.
    fn ends(end: &mut RunEnd, step: u64, processes: &Processes) -> (Exit, u64) {
        for second in 0..1000 {
            if let Ok(verdict) = end.look(step, processes, Duration::from_secs(second)) {
                assert_eq!(verdict.exit == Exit::Done, verdict.reason.is_empty(), "{verdict:?}");
                return (verdict.exit, second);
            }
        }
        panic!("it never ends");
    }

    #[test]
    fn both_kinds_of_data_of_an_analyzer_and_a_probe_must_be_inverted() {
        let there = processes(&[(REPORT, ANALYZER), (SPEEDS, PROBE)]);
        let mut d = end();
        assert_eq!(d.state(7, &there), State::Open(REPORT, Sender::Node));
        answered(&mut d, REPORT, 7, ANALYZER);
        assert_eq!(d.state(7, &there), State::Open(SPEEDS, Sender::Node));
        d.hear_data(SPEEDS, 7, PROBE, false);
        d.hear_answer(SPEEDS.name, 6, INVERSION);
        assert_eq!(d.state(7, &there), State::Answering(SPEEDS), "another packing");
        d.hear_answer(SPEEDS.name, 7, INVERSION);
        assert_eq!(ends(&mut d, 7, &there), (Exit::Done, 0));
    }

    #[test]
    fn every_way_to_have_no_results_has_its_limit_and_its_exit() {
        let analyzer = processes(&[(REPORT, ANALYZER)]);
        assert_eq!(ends(&mut end(), 7, &processes(&[])), (Exit::Failure, 600), "no analyzer");
        assert_eq!(ends(&mut end(), 7, &analyzer), (Exit::Failure, 600), "a silent analyzer");
        let mut dead = end();
        answered(&mut dead, REPORT, 5, ANALYZER);
        assert_eq!(ends(&mut dead, 7, &processes(&[])), (Exit::Failure, 60), "a dead analyzer");
        let mut without_inversion = end();
        without_inversion.hear_data(REPORT, 7, ANALYZER, false);
        let alone = Processes { inversions: BTreeSet::new(), ..analyzer.clone() };
        assert_eq!(ends(&mut without_inversion, 7, &alone), (Exit::Failure, 30), "no inversion");
        let mut gas = end();
        gas.hear_data(REPORT, 7, ANALYZER, true);
        gas.hear_answer(REPORT.name, 7, INVERSION);
        assert_eq!(ends(&mut gas, 7, &analyzer), (Exit::PhysicsInvalid, 0), "a gas");
        let there = processes(&[(REPORT, ANALYZER), (SPEEDS, PROGRAM)]);
        for (there, expected) in [(&there, (Exit::DataLoss, 60)), (&analyzer, (Exit::DataLoss, 5))] {
            let mut silent = end();
            [5, 7].iter().for_each(|step| answered(&mut silent, REPORT, *step, ANALYZER));
            answered(&mut silent, SPEEDS, 5, PROGRAM);
            assert_eq!(ends(&mut silent, 7, there), expected, "a silent instrument, and one that has left");
        }
    }

    #[test]
    fn a_packing_within_a_phase_may_have_no_results_but_those_it_has_are_inverted() {
        let there = processes(&[(REPORT, ANALYZER)]);
        let within = || RunEnd::new(&[], RecordedSpeeds::default(), true);
        assert_eq!(ends(&mut within(), 7, &there), (Exit::Done, 60));
        let mut measured = within();
        measured.hear_data(REPORT, 7, ANALYZER, false);
        assert_eq!(ends(&mut measured, 7, &there), (Exit::Failure, 30));
    }

    #[test]
    fn a_probe_at_work_is_waited_for_without_a_limit() {
        let mut there = processes(&[(SPEEDS, PROBE)]);
        there.measuring.insert(PROBE, true);
        let mut d = end();
        assert!((0..2000).all(|second| d.look(7, &there, Duration::from_secs(second)).is_err()));
        there.measuring.insert(PROBE, false);
        let late = (2000..3000).position(|second| d.look(7, &there, Duration::from_secs(second)).is_ok());
        assert_eq!(late, Some(599));
    }

    #[test]
    fn time_does_not_count_while_a_process_or_the_simulator_itself_is_stopped() {
        let mut there = processes(&[(REPORT, ANALYZER)]);
        let mut d = end();
        d.hear_data(REPORT, 7, ANALYZER, false);
        let mut is_over = |there: &Processes, second| d.look(7, there, Duration::from_secs(second)).is_ok();
        assert!(!is_over(&there, 0) && !is_over(&there, 500), "the simulator was stopped: one step counts");
        there.any_stopped = true;
        assert!((501..1000).all(|second| !is_over(&there, second)));
        there.any_stopped = false;
        assert!(!is_over(&there, 1001) && (1002..1032).any(|second| is_over(&there, second)));
    }

    #[test]
    fn an_instrument_is_waited_for_once_it_has_measured_and_as_many_shots_as_before() {
        let there = processes(&[(REPORT, ANALYZER), (SPEEDS, PROGRAM)]);
        let mut d = end();
        [7, 9].iter().for_each(|step| answered(&mut d, REPORT, *step, ANALYZER));
        assert_eq!(d.state(9, &there), State::Complete, "it has measured no packing");
        (0..3).for_each(|_| answered(&mut d, SPEEDS, 7, PROGRAM));
        for shot in 0..3 {
            assert_eq!(d.state(9, &there), State::Open(SPEEDS, Sender::Program), "{shot}");
            answered(&mut d, SPEEDS, 9, PROGRAM);
        }
        assert_eq!(d.state(9, &there), State::Settling);
        d.hear_data(SPEEDS, 9, PROGRAM, false);
        assert_eq!(d.state(9, &there), State::Answering(SPEEDS));
        d.hear_answer(SPEEDS.name, 9, INVERSION);
        assert_eq!(ends(&mut d, 9, &there), (Exit::Done, 2), "more may come");
        assert_eq!(d.state(9, &processes(&[(REPORT, ANALYZER)])), State::Complete, "it has left");
    }

    #[test]
    fn a_program_that_never_stops_is_heard_for_a_minute() {
        let there = processes(&[(REPORT, ANALYZER), (SPEEDS, PROGRAM)]);
        let mut d = end();
        answered(&mut d, REPORT, 9, ANALYZER);
        let ended = (0..100).position(|second| {
            answered(&mut d, SPEEDS, 9, PROGRAM);
            d.look(9, &there, Duration::from_secs(second)).is_ok()
        });
        assert_eq!(ended, Some(60));
    }

    #[test]
    fn refused_data_make_a_complete_run_one_with_data_loss() {
        let there = processes(&[(REPORT, ANALYZER)]);
        let mut d = end();
        answered(&mut d, REPORT, 9, ANALYZER);
        d.hear_refused("NaN is refused".to_owned());
        assert_eq!(ends(&mut d, 9, &there), (Exit::DataLoss, 0));
    }

    #[test]
    fn without_an_analyzer_the_data_of_programs_are_enough() {
        let there = processes(&[(MODULI, PROGRAM)]);
        let mut d = end();
        assert_eq!(d.state(7, &there), State::Open(REPORT, Sender::Node), "it has sent nothing");
        answered(&mut d, MODULI, 7, PROGRAM);
        assert_eq!(d.state(7, &there), State::Settling);
    }

    #[test]
    fn awaited_data_are_waited_for_though_none_of_another_packing_came() {
        let there = processes(&[(REPORT, ANALYZER), (MODULI, PROGRAM)]);
        let mut d = RunEnd::new(&[topics::MODULI, topics::PACKING_REPORT], RecordedSpeeds::default(), false);
        answered(&mut d, REPORT, 9, ANALYZER);
        assert_eq!(d.state(9, &there), State::Open(MODULI, Sender::Program));
        answered(&mut d, MODULI, 9, PROGRAM);
        assert_eq!(d.state(9, &there), State::Settling);
    }

    #[test]
    fn a_resumed_run_waits_for_the_instrument_as_before_and_not_for_what_is_recorded() {
        let there = processes(&[(REPORT, ANALYZER), (SPEEDS, PROGRAM)]);
        let recorded = RecordedSpeeds { measured: [(7, 1), (9, 1)].into(), inverted: [7].into() };
        let mut d = RunEnd::new(&[], recorded, false);
        [7, 9, 11].iter().for_each(|step| answered(&mut d, REPORT, *step, ANALYZER));
        assert_eq!(d.state(7, &there), State::Settling);
        assert_eq!(d.state(9, &there), State::Open(SPEEDS, Sender::Program), "its speeds were not inverted");
        assert_eq!(d.state(11, &there), State::Open(SPEEDS, Sender::Program));
        let probe = processes(&[(REPORT, ANALYZER), (SPEEDS, PROBE)]);
        assert_eq!(
            d.state(7, &probe),
            State::Open(SPEEDS, Sender::Node),
            "a probe measures the packing again"
        );
    }

    #[test]
    fn every_inversion_answers_and_a_restarted_one_goes_on_for_its_predecessor() {
        let (second, again) = ([5; 12], [6; 12]);
        let mut there = processes(&[(REPORT, ANALYZER)]);
        there.inversions.extend([second, again]);
        let names = [(INVERSION, "a"), (second, "b"), (again, "b")];
        there.names.extend(names.map(|(participant, name)| (participant, name.to_owned())));
        let mut d = end();
        answered(&mut d, REPORT, 7, ANALYZER);
        assert_eq!(d.state(7, &there), State::Answering(REPORT));
        d.hear_answer(REPORT.name, 7, again);
        assert_eq!(d.state(7, &there), State::Complete);
    }

    #[test]
    fn an_inversion_that_was_killed_before_its_first_heartbeat_is_not_missed() {
        let mut there = processes(&[(REPORT, ANALYZER)]);
        there.inversions.insert([7; 12]);
        let mut d = end();
        answered(&mut d, REPORT, 7, ANALYZER);
        assert_eq!(ends(&mut d, 7, &there), (Exit::Done, 5));
        // Of a launched run the restarted process is known by its number.
        let launched = Identity::member_of(RunId::named("a"), 4);
        let (killed, again) = (launched.guid_prefix(), launched.guid_prefix());
        there.inversions = [killed, again].into();
        let mut d = end();
        d.hear_data(REPORT, 7, ANALYZER, false);
        d.hear_answer(REPORT.name, 7, again);
        assert_eq!(ends(&mut d, 7, &there), (Exit::Done, 0));
    }

    #[test]
    fn a_writer_that_has_sent_nothing_may_be_a_probe_whose_heartbeat_is_on_its_way() {
        let there = processes(&[(REPORT, ANALYZER), (SPEEDS, PROBE)]);
        let mut early = there.clone();
        early.names.remove(&PROBE);
        early.measuring.remove(&PROBE);
        let mut d = end();
        answered(&mut d, REPORT, 7, ANALYZER);
        assert_eq!(d.state(7, &early), State::Unheard(SPEEDS));
        assert_eq!(d.state(7, &there), State::Open(SPEEDS, Sender::Node));
        assert_eq!(ends(&mut d, 7, &early), (Exit::Done, 5), "an instrument that never sends");
    }

    #[test]
    fn what_came_before_the_run_began_does_not_count() {
        let there = processes(&[(REPORT, ANALYZER)]);
        let mut d = end();
        answered(&mut d, REPORT, 7, ANALYZER);
        d.begin();
        assert_eq!(d.state(7, &there), State::Open(REPORT, Sender::Node));
    }
}
