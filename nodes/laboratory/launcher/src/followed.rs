//! Progress and end of a run by its messages, for nodes as processes and in one process.

use super::plan::NodePlan;
use super::progress::Progress;
use super::said;
use super::watch::Event;
use crate::nodes::NodeKind;
use grainlab_msgs::msg::RunState;
use grainlab_msgs::topics;
use grainlab_node_kit::Exit;
use std::collections::{BTreeMap, BTreeSet};

/// Outline of the loading path of the run.
#[derive(Clone, Copy, Debug)]
pub struct Outline {
    /// Number of phases.
    pub phases: usize,
    /// The run starts from a packing, which is published as that of step 0.
    pub starts_from_packing: bool,
}

/// The messages of the run that the launcher received.
#[derive(Debug, Default)]
pub struct Received {
    /// Packings, by the last run state; `None` if the path was not finished.
    pub packings: Option<u32>,
    /// Steps of the packings with a result, by topic.
    pub results: BTreeMap<&'static str, BTreeSet<u64>>,
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
    /// Every process with its name, which is that of its log.
    processes: Vec<(Option<NodeKind>, String)>,
    /// A third-party program sent data of a packing.
    has_foreign_data: bool,
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
            processes: plans.iter().map(|plan| (plan.node, plan.name.clone())).collect(),
            has_foreign_data: false,
            reasons: Vec::new(),
            results: BTreeMap::new(),
            left: BTreeSet::new(),
        }
    }

    /// Returns the exit of a run whose results are judged by its simulator, which says why the run is not complete.
    pub(super) fn verdict(&mut self) -> Option<Exit> {
        let finished = self.finished.as_ref()?;
        let (exit, reason) = (finished.exit()?, finished.message.clone());
        if exit != Exit::Done {
            let is_absent = |node: &NodeKind| self.names(*node).next().is_none();
            let needed = [NodeKind::EmtInversion, NodeKind::FabricAnalyzer];
            let advice = match needed.into_iter().find(is_absent).filter(|_| exit == Exit::Failure) {
                Some(node) => format!("the launch file starts no {node}"),
                None => "see logs/".to_owned(),
            };
            self.complain(format!("{reason}: {advice}"));
        }
        Some(exit)
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
                    RunState::FINISHED => {
                        if state.exit_code.is_empty() && !state.message.is_empty() {
                            self.progress.still(&state.message);
                        }
                        self.finished = Some(state);
                    }
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
            Event::Measured { topic, step, has_first_stamp } => {
                self.note_result(topic, step);
                let is_of_packing = step > 0 || (has_first_stamp && self.outline.starts_from_packing);
                self.has_foreign_data |= is_of_packing && !self.is_measured_by_node(topic);
            }
            Event::Microstructure { source, step, nothing } => {
                self.note_result(topics::MICROSTRUCTURE.name, step);
                let is_of_start = self.outline.starts_from_packing && self.is_measured_by_node(&source);
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
        let is_new = !self.names(node).any(says);
        let log = self.log_of(node);
        is_new.then(|| self.complain(format!("{node} ended with exit code {code}: {log}"))).is_some()
    }

    /// Complains about a simulator that ended with an error after its last message.
    pub(super) fn simulator_failed(&mut self) {
        let node = NodeKind::DemSimulator;
        self.complain(format!("{node} failed: {}", self.log_of(node)));
    }

    fn names(&self, node: NodeKind) -> impl Iterator<Item = &str> {
        self.processes.iter().filter(move |(of, _)| *of == Some(node)).map(|(_, name)| name.as_str())
    }

    /// Returns the advice to read the logs of a node: names and namespaces of the launch file are in them.
    fn log_of(&self, node: NodeKind) -> String {
        let logs = self.names(node).map(|name| format!("logs/{name}.log"));
        format!("see {}", logs.collect::<Vec<_>>().join(", "))
    }

    fn is_measured_by_node(&self, topic: &str) -> bool {
        let measured = self.processes.iter().filter_map(|(node, _)| node.as_ref()?.measures());
        measured.into_iter().any(|by_node| by_node.name == topic)
    }

    /// Returns a sentence on third-party programs, if none of them sent data of any packing.
    pub(super) fn silent_programs(&self) -> Option<String> {
        let has = |node| self.names(node).next().is_some();
        let programs: Vec<_> =
            self.processes.iter().filter(|(node, _)| node.is_none()).map(|(_, name)| name.as_str()).collect();
        // One of them is the servo, if no node is.
        let is_servo = !has(NodeKind::ServoController) && programs.len() == 1;
        let may_be_silent =
            self.has_foreign_data || has(NodeKind::AcousticProbe) || is_servo || programs.is_empty();
        (!may_be_silent).then(|| {
            format!(
                "no wave speeds or other data of a packing came from {} before the run ended",
                programs.join(", ")
            )
        })
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

    fn plan(node: Option<NodeKind>, name: &str) -> NodePlan {
        NodePlan { name: name.to_owned(), node, ..NodePlan::default() }
    }

    fn followed(plans: &[NodePlan]) -> Followed {
        Followed::new(plans, Outline { phases: 1, starts_from_packing: true })
    }

    #[test]
    fn a_reason_names_the_log_of_the_process_as_the_launch_file_calls_it() {
        let mut followed = followed(&[
            plan(Some(NodeKind::Recorder), "left-recorder"),
            plan(Some(NodeKind::DemSimulator), "left-sand"),
        ]);
        followed.simulator_failed();
        assert!(followed.blame(NodeKind::Recorder, 1));
        let needles = ["see logs/left-sand.log", "see logs/left-recorder.log"];
        assert!(followed.reasons.iter().zip(needles).all(|(reason, log)| reason.ends_with(log)));
        followed.complain("left-recorder ended with exit code 3: the run ends".to_owned());
        assert!(!followed.blame(NodeKind::Recorder, 1), "it has said so under its name");
    }

    #[test]
    fn the_simulator_judges_the_results_and_its_reason_is_that_of_the_run() {
        let mut followed = followed(&[]);
        let state = |exit_code: &[u8], message: &str| {
            let (exit_code, message) = (exit_code.to_vec(), message.to_owned());
            Event::State(RunState { state: RunState::FINISHED, exit_code, message, ..RunState::default() })
        };
        followed.take(state(&[], "waiting for wave_speeds of step 7"));
        assert_eq!(followed.verdict(), None);
        followed.take(state(&[4], "no stiffness"));
        assert_eq!(followed.verdict(), Some(Exit::PhysicsInvalid));
        followed.take(state(&[1], "not inverted"));
        assert_eq!(followed.verdict(), Some(Exit::Failure));
        let reasons = ["no stiffness: see logs/", "not inverted: the launch file starts no emt_inversion"];
        assert_eq!(followed.reasons, reasons);
        followed.take(state(&[0], ""));
        assert_eq!(followed.verdict(), Some(Exit::Done));
    }

    #[test]
    fn a_program_that_sent_no_data_of_any_packing_is_named_unless_it_is_the_servo() {
        let (program, servo) = (plan(None, "watch"), plan(Some(NodeKind::ServoController), "servo"));
        assert_eq!(followed(std::slice::from_ref(&program)).silent_programs(), None, "it is the servo");
        let probe = plan(Some(NodeKind::AcousticProbe), "probe");
        assert_eq!(followed(&[program.clone(), servo.clone(), probe]).silent_programs(), None);
        let mut followed = followed(&[program, servo]);
        let sends = |step, has_first_stamp| Event::Measured {
            topic: topics::WAVE_SPEEDS.name,
            step,
            has_first_stamp,
        };
        followed.take(sends(0, false));
        assert!(followed.silent_programs().unwrap().contains("came from watch before"));
        followed.take(sends(0, true));
        assert_eq!(followed.silent_programs(), None);
    }
}
