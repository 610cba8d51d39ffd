//! Progress and end of a run by its messages, for nodes as processes and in one process.

use super::deadline::{Deadline, Logs, nothing};
use super::pending_results::{PendingResults, ResultState, Source};
use super::plan::NodePlan;
use super::progress::Progress;
use super::said;
use super::watch::Event;
use crate::nodes::NodeKind;
use grainlab_msgs::msg::RunState;
use grainlab_msgs::topics;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Instant;

/// The last packing is being measured by the probe, or is in its queue.
const PROBED: ResultState = ResultState::Open(Source::Node(NodeKind::AcousticProbe));

/// Outline of the loading path of the run.
#[derive(Clone, Copy, Debug)]
pub struct Outline {
    /// Number of phases.
    pub phases: usize,
    /// The run starts from a packing, which is published as that of step 0.
    pub starts_from_packing: bool,
    /// The last packing is recorded within a phase: it may have no results.
    pub ends_within: bool,
}

/// The messages of the run that the launcher received.
#[derive(Debug, Default)]
pub struct Received {
    /// Packings, by the last run state; `None` if the path was not finished.
    pub packings: Option<u32>,
    /// Steps of the packings with a result, by topic.
    pub results: BTreeMap<&'static str, BTreeSet<u64>>,
}

/// State of a run, as far as its messages say.
pub(super) enum Verdict {
    /// The loading path is not at its end.
    UnderWay,
    /// Every result is there that is expected.
    Complete,
    /// The last packing has nothing to invert; the reason was printed.
    Invalid,
    /// Results of the last packing are missing; with a new time limit for them.
    Pending(Option<Deadline>),
}

pub(super) struct Followed {
    pub(super) progress: Progress,
    pub(super) outline: Outline,
    pub(super) begun: bool,
    /// Last message of the simulator on what it does or waits for.
    simulator: Option<String>,
    simulator_joined: bool,
    /// That the DDS domain is full, in words.
    crowding: Option<String>,
    /// The step at which the run began or resumed.
    pub(super) first_step: Option<u64>,
    pub(super) finished: Option<RunState>,
    pub(super) failed: Option<String>,
    /// The watch failed: the end of the run would not be noticed.
    pub(super) blind: bool,
    pub(super) pending: PendingResults,
    pub(super) logs: Logs,
    /// The probe reported work since the last check.
    probing: bool,
    /// Step of the packing that the probe measures, and when that was first seen.
    probed: Option<(u64, Instant)>,
    /// State of the results for which the last time limit was set.
    limited: Option<ResultState>,
    /// Why the run did not end as it should.
    reasons: Vec<String>,
    /// Received results: steps of packings by topic.
    results: BTreeMap<&'static str, BTreeSet<u64>>,
    /// Ids of the processes that sent their last report.
    pub(super) left: BTreeSet<u32>,
}

impl Followed {
    /// A run of these nodes that has not begun.
    pub(super) fn new(plans: &[NodePlan], outline: Outline) -> Self {
        Self {
            progress: Progress::new(outline.phases),
            outline,
            begun: false,
            simulator: None,
            simulator_joined: false,
            crowding: None,
            first_step: None,
            finished: None,
            failed: None,
            blind: false,
            pending: PendingResults::of(plans),
            logs: Logs::new(plans),
            probing: false,
            probed: None,
            limited: None,
            reasons: Vec::new(),
            results: BTreeMap::new(),
            left: BTreeSet::new(),
        }
    }

    /// Judges the run by what was received so far.
    pub(super) fn verdict(&mut self) -> Verdict {
        let Some(last) = self.finished.as_ref().map(RunState::last_packing) else { return Verdict::UnderWay };
        let Some(step) = last else { return Verdict::Complete };
        match self.pending.state_of(step) {
            ResultState::Complete => Verdict::Complete,
            ResultState::Declined(_) | ResultState::Left if self.outline.ends_within => Verdict::Complete,
            ResultState::Declined(node) => {
                self.complain(format!("the last packing has no {}", nothing(node, &self.logs)));
                Verdict::Invalid
            }
            standing => {
                // Bursts through a long path may take any time; the run waits for a probe that works.
                let at_work = std::mem::take(&mut self.probing) && standing == PROBED;
                let is_new = self.limited.replace(standing) != Some(standing) || at_work;
                let of = if self.outline.ends_within { Deadline::within_a_phase } else { Deadline::of };
                Verdict::Pending(is_new.then(|| of(standing, &self.logs)))
            }
        }
    }

    /// Why the run did not end as it should, and the messages that were received.
    pub(super) fn received(self) -> (Vec<String>, Received) {
        let packings = self.finished.as_ref().map(|state| state.packings);
        (self.reasons, Received { packings, results: self.results })
    }

    pub(super) fn take(&mut self, event: Event) {
        match event {
            Event::State(state) => {
                let first = *self.first_step.get_or_insert(state.step);
                self.begun |= state.step != first || state.state != RunState::RUNNING;
                self.progress.show(&state);
                match state.state {
                    RunState::RUNNING => {}
                    RunState::FINISHED => self.finished = Some(state),
                    _ => self.failed = Some(state.message),
                }
            }
            Event::Phase(report) => self.progress.report(report),
            Event::Simulator(says) => self.simulator = Some(says),
            Event::Goodbye(pid) => {
                self.left.insert(pid);
            }
            Event::Open => {}
            Event::SimulatorJoined => self.simulator_joined = true,
            Event::Crowded(sentence) => {
                grainlab_console::say!("grainlab: {sentence}");
                self.crowding = Some(sentence);
            }
            Event::Measured(topic, step) => {
                self.note_result(topic, step);
                self.pending.measured(topic, step);
            }
            Event::MeasuredStart if self.outline.starts_from_packing => self.pending.measured_start(),
            Event::MeasuredStart => {}
            Event::Declined(topic, step) => self.pending.declined(topic, step),
            Event::Probing(step) => {
                self.probing = true;
                let (of, since) = *self.probed.get_or_insert_with(|| (step, Instant::now()));
                let since = if of == step { since } else { self.probed.insert((step, Instant::now())).1 };
                if self.finished.is_some() {
                    let seconds = since.elapsed().as_secs();
                    self.progress.still(&format!(
                        "measuring waves through the packing of step {step}, for {seconds} s"
                    ));
                }
            }
            Event::Microstructure { source, step, member, nothing } => {
                self.note_result(topics::MICROSTRUCTURE.name, step);
                self.pending.inverted(&source, step, member);
                let is_of_start =
                    self.outline.starts_from_packing && self.pending.is_measured_by_node(&source);
                self.progress.say(&said::inverted(&source, step, is_of_start, nothing.as_deref()));
            }
            Event::Stranger(text) => {
                grainlab_console::say!("grainlab: {text} and is not of this run: it is ignored")
            }
            Event::Failed(message) => {
                self.complain(format!("the launcher cannot use the bus: {message}; the run ends"));
                self.blind = true;
            }
        }
    }

    /// Prints why the run does not end as it should, and keeps it for the result.
    pub(super) fn complain(&mut self, reason: String) {
        grainlab_console::say!("grainlab: {reason}");
        self.reasons.push(reason);
    }

    /// Complains that a node ended with this code; false if its end was a reason already.
    pub(super) fn blame(&mut self, node: NodeKind, code: u8) -> bool {
        let says = |name: &str| self.reasons.iter().any(|r| r.starts_with(&format!("{name} ended")));
        let is_new = !self.logs.names(Source::Node(node)).any(says);
        let log = self.logs.of(Source::Node(node));
        is_new.then(|| self.complain(format!("{node} ended with exit code {code}: {log}"))).is_some()
    }

    /// Complains about a simulator that ended with an error after its last message.
    pub(super) fn simulator_failed(&mut self) {
        let node = NodeKind::DemSimulator;
        let log = self.logs.of(Source::Node(node));
        self.complain(format!("{node} failed: {log}"));
    }

    /// Data of an external instrument do not belong to a packing of the run.
    fn note_result(&mut self, topic: &'static str, step: u64) {
        if step > 0 {
            self.results.entry(topic).or_default().insert(step);
        }
    }

    /// Prints the condition that a run that has not begun waits for, as far as its simulator has said it.
    pub(super) fn say_what_is_waited_for(&self) {
        let simulator = self.simulator.as_deref();
        if let Some(what) = said::awaited(simulator, self.simulator_joined, self.first_step) {
            let crowding = self.crowding.iter().map(|sentence| format!(" ({sentence})"));
            self.progress.say(&format!("the run has not begun: {what}{}", crowding.collect::<String>()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_names_the_log_of_the_process_as_the_launch_file_calls_it() {
        let plan =
            |node, name: &str| NodePlan { name: name.to_owned(), node: Some(node), ..NodePlan::default() };
        let plans = [plan(NodeKind::Recorder, "left-recorder"), plan(NodeKind::DemSimulator, "left-sand")];
        let outline = Outline { phases: 1, starts_from_packing: false, ends_within: false };
        let mut followed = Followed::new(&plans, outline);
        followed.simulator_failed();
        assert!(followed.blame(NodeKind::Recorder, 1));
        followed.finished = Some(RunState { packings: 1, last_packing_step: 7, ..RunState::default() });
        let Verdict::Pending(Some(late)) = followed.verdict() else { panic!("it is measured") };
        let needles = ["see logs/left-sand.log", "see logs/left-recorder.log"];
        assert!(followed.reasons.iter().zip(needles).all(|(reason, log)| reason.ends_with(log)));
        assert!(late.message.ends_with("the launch file starts no fabric_analyzer"), "{}", late.message);
        followed.complain("left-recorder ended with exit code 3: the run ends".to_owned());
        assert!(!followed.blame(NodeKind::Recorder, 1), "it has said so under its name");
    }
}
