//! The pending results of the last packing: one microstructure for every kind of data measured by the nodes
//! of the run.

use super::plan::NodePlan;
use crate::nodes::NodeKind;
use crate::recorded_speeds::RecordedSpeeds;
use grainlab_msgs::{Topic, topics};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    Node(NodeKind),
    /// The third-party programs of a launch file.
    Instrument,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Node(node) => write!(f, "{node}"),
            Self::Instrument => f.write_str("instrument"),
        }
    }
}

/// One kind of data, by the topic that carries it.
#[derive(Debug)]
struct Kind {
    /// Topic of the data: the `source` of a microstructure.
    topic: &'static str,
    source: Source,
    /// Number of sets of data about the packing of each step.
    measured: BTreeMap<u64, usize>,
    /// Number of answers, by step of the packing and member number of the inversion.
    inverted: BTreeMap<(u64, u8), usize>,
    /// Steps of the packings whose data were inverted before the run was resumed.
    settled: BTreeSet<u64>,
    /// Steps of the packings without data to invert.
    declined: BTreeSet<u64>,
}

impl Kind {
    fn new(topic: &'static str, source: Source) -> Self {
        let (measured, inverted, settled, declined) = Default::default();
        Self { topic, source, measured, inverted, settled, declined }
    }

    /// True if the packing is measured: an instrument that sent several sets of data about every other packing sends as many about
    /// this one.
    fn is_measured(&self, step: u64) -> bool {
        let others = self.measured.iter().filter(|(other, _)| **other != step).map(|(_, sets)| *sets).min();
        let expected = others.filter(|_| self.source == Source::Instrument).unwrap_or(1);
        self.settled.contains(&step) || self.measured.get(&step).is_some_and(|sets| *sets >= expected)
    }

    /// True if so many inversions have answered; those of an instrument each of its sets of data.
    fn is_inverted(&self, step: u64, inversions: usize) -> bool {
        let sets = match self.source {
            Source::Instrument => self.measured.get(&step).copied().unwrap_or(1),
            Source::Node(_) => 1,
        };
        let answers = self.inverted.range((step, 0)..=(step, u8::MAX)).filter(|(_, n)| **n >= sets);
        self.settled.contains(&step)
            || (answers.count() >= inversions
                && (self.source != Source::Instrument || self.is_measured(step)))
    }
}

/// The state of the results of one packing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ResultState {
    /// Every kind of data is inverted.
    Complete,
    /// Every kind of data is inverted, and a program may send more of them.
    Settling,
    /// No more results are expected: the programs that measured other packings have ended.
    Left,
    /// No more results are expected, and this node found no data to invert.
    Declined(Source),
    /// The data are not inverted yet; this node measured them.
    Measured(Source),
    /// This node has not measured it yet.
    Open(Source),
}

/// The known results of every kind of data.
#[derive(Debug)]
pub(crate) struct PendingResults {
    kinds: Vec<Kind>,
    /// Number of inversions of the run, each of which inverts every kind of data. 1 for a run without inversion: its
    /// results stay pending.
    inversions: usize,
    /// True while third-party programs run, which may publish wave speeds. If they published those of one packing, the run
    /// waits for those of its last packing; for data that `until_inverted` names and no node measures, in any case.
    instruments: bool,
    /// Names of those programs.
    programs: Vec<String>,
    /// True once one of them sent data of a packing.
    sent: bool,
}

impl PendingResults {
    /// For the nodes of a run. A microstructure from moduli is expected even without an analyzer: a user who launches without
    /// analyzer and probe is informed that nothing is inferred, unless a program of another origin publishes moduli.
    pub(crate) fn of(plans: &[NodePlan]) -> Self {
        let has = |node: NodeKind| plans.iter().any(|p| p.is(node));
        let kind = |node: NodeKind| Some(Kind::new(node.measures()?.name, Source::Node(node)));
        let mut kinds: Vec<Kind> = NodeKind::all().filter(|node| has(*node)).filter_map(kind).collect();
        let instruments = plans.iter().any(|p| p.node.is_none());
        let simulator = plans.iter().find(|p| p.is(NodeKind::DemSimulator)).filter(|_| instruments);
        if let Some(Ok(Some((.., parameters)))) = simulator.map(NodePlan::parsed) {
            let named: Vec<String> = parameters.get("until_inverted");
            for topic in named.iter().filter_map(|name| Topic::by_name(name)) {
                if !kinds.iter().any(|k| k.topic == topic.name) {
                    kinds.push(Kind::new(topic.name, Source::Instrument));
                }
            }
        }
        if kinds.is_empty() {
            kinds.push(Kind::new(topics::MODULI.name, Source::Node(NodeKind::FabricAnalyzer)));
        }
        let inversions = plans.iter().filter(|p| p.is(NodeKind::EmtInversion)).count().max(1);
        let programs = plans.iter().filter(|p| p.node.is_none() && !has(NodeKind::AcousticProbe));
        let mut programs: Vec<String> = programs.map(|p| p.name.clone()).collect();
        // One of them is the servo, if no node is.
        if !has(NodeKind::ServoController) && programs.len() == 1 {
            programs.clear();
        }
        Self { kinds, inversions, instruments, programs, sent: false }
    }

    /// A sentence on third-party programs, if none of them sent data of any packing.
    pub(crate) fn silent_programs(&self) -> Option<String> {
        let text = || {
            format!(
                "no wave speeds or other data of a packing came from {} before the run ended",
                self.programs.join(", ")
            )
        };
        (!self.sent && !self.programs.is_empty()).then(text)
    }

    /// The data of this topic about the packing of `step` were published.
    pub(crate) fn measured(&mut self, topic: &str, step: u64) {
        self.sent |= step > 0 && !self.is_measured_by_node(topic);
        // Step 0 means no packing.
        if topic == topics::WAVE_SPEEDS.name && step > 0 {
            self.expect_of_instruments();
        }
        self.of_topic(topic).for_each(|k| {
            *k.measured.entry(step).or_default() += 1;
        });
    }

    /// The wave speeds of the packing that the run starts from were published.
    pub(crate) fn measured_start(&mut self) {
        self.sent = true;
        self.expect_of_instruments();
        let of_instruments = self.kinds.iter_mut().filter(|k| k.source == Source::Instrument);
        of_instruments.for_each(|k| *k.measured.entry(0).or_insert(0) += 1);
    }

    /// Third-party programs measure: their data are awaited from now on.
    fn expect_of_instruments(&mut self) {
        if self.instruments && self.of_topic(topics::WAVE_SPEEDS.name).next().is_none() {
            self.kinds.push(Kind::new(topics::WAVE_SPEEDS.name, Source::Instrument));
        }
    }

    /// The wave speeds in the recording of a run that is resumed.
    pub(crate) fn remember(&mut self, recorded: &RecordedSpeeds) {
        for step in &recorded.measured {
            if *step == 0 { self.measured_start() } else { self.measured(topics::WAVE_SPEEDS.name, *step) }
        }
        let of_instruments = self.kinds.iter_mut().filter(|k| k.source == Source::Instrument);
        of_instruments.for_each(|k| k.settled.extend(&recorded.inverted));
    }

    /// All third-party programs have ended.
    pub(crate) fn instruments_left(&mut self) {
        self.instruments = false;
    }

    /// The inversion with this member number published a microstructure from the data of this topic.
    pub(crate) fn inverted(&mut self, topic: &str, step: u64, member: u8) {
        self.of_topic(topic).for_each(|k| {
            *k.inverted.entry((step, member)).or_default() += 1;
        });
    }

    /// There is nothing to invert on this topic about the packing of `step`.
    pub(crate) fn declined(&mut self, topic: &str, step: u64) {
        self.of_topic(topic).for_each(|k| {
            k.declined.insert(step);
        });
    }

    pub(crate) fn is_measured_by_node(&self, topic: &str) -> bool {
        self.kinds.iter().any(|k| k.topic == topic && matches!(k.source, Source::Node(_)))
    }

    fn of_topic<'a>(&'a mut self, topic: &str) -> impl Iterator<Item = &'a mut Kind> {
        self.kinds.iter_mut().filter(move |k| k.topic == topic)
    }

    /// The state of the results of the packing of `step`: that of the slowest one.
    pub(crate) fn state_of(&self, step: u64) -> ResultState {
        let inverted = |k: &Kind| k.is_inverted(step, self.inversions);
        // A program that has ended sends no more data.
        let never = |k: &Kind| k.source == Source::Instrument && !self.instruments && !k.is_measured(step);
        let owed = || self.kinds.iter().filter(|k| !inverted(k) && !never(k));
        let due = || owed().filter(|k| !k.declined.contains(&step));
        if let Some(open) = due().find(|k| !k.is_measured(step)) {
            return ResultState::Open(open.source);
        }
        if let Some(measured) = due().next() {
            return ResultState::Measured(measured.source);
        }
        let left = || self.kinds.iter().any(|k| never(k) && !inverted(k));
        match owed().next() {
            Some(declined) => ResultState::Declined(declined.source),
            None if left() => ResultState::Left,
            None if self.instruments && self.kinds.iter().any(|k| k.source == Source::Instrument) => {
                ResultState::Settling
            }
            None => ResultState::Complete,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANALYZER: Source = Source::Node(NodeKind::FabricAnalyzer);
    const PROBE: Source = Source::Node(NodeKind::AcousticProbe);

    /// A program that is not a node of grainlab.
    fn instrument() -> NodePlan {
        NodePlan { name: "instrument".to_owned(), ..NodePlan::default() }
    }

    fn pending(nodes: &[NodeKind]) -> PendingResults {
        let plan =
            |node: &NodeKind| NodePlan { name: node.to_string(), node: Some(*node), ..NodePlan::default() };
        PendingResults::of(&nodes.iter().map(plan).collect::<Vec<_>>())
    }

    /// Data of a packing, measured and inverted.
    fn answered(pending: &mut PendingResults, source: &'static str, step: u64) {
        pending.measured(source, step);
        pending.inverted(source, step, 2);
    }

    #[test]
    fn an_instrument_that_measured_one_packing_is_waited_for_at_the_last_and_is_missed_if_it_left() {
        let foreign = instrument();
        let ours = NodePlan { node: Some(NodeKind::FabricAnalyzer), ..foreign.clone() };
        let mut d = PendingResults::of(&[ours, foreign]);
        for step in [7, 9] {
            answered(&mut d, "packing_report", step);
        }
        d.measured("wave_speeds", 0);
        assert_eq!(d.state_of(9), ResultState::Complete, "speeds of no packing");
        let mut of_start = PendingResults::of(&[instrument()]);
        answered(&mut of_start, "moduli", 9);
        of_start.measured_start();
        assert_eq!(of_start.state_of(9), ResultState::Open(Source::Instrument));
        d.measured("wave_speeds", 7);
        assert!(d.is_measured_by_node("packing_report") && !d.is_measured_by_node("wave_speeds"));
        assert_eq!(d.state_of(9), ResultState::Open(Source::Instrument));
        d.measured("wave_speeds", 9);
        assert_eq!(d.state_of(9), ResultState::Measured(Source::Instrument));
        d.inverted("wave_speeds", 9, 2);
        assert_eq!(d.state_of(9), ResultState::Settling);
        assert_eq!(d.state_of(11), ResultState::Open(ANALYZER));
        answered(&mut d, "packing_report", 11);
        d.instruments_left();
        assert_eq!((d.state_of(9), d.state_of(11)), (ResultState::Complete, ResultState::Left));
    }

    #[test]
    fn a_resumed_run_waits_for_the_instrument_as_before_and_not_for_what_is_recorded() {
        let program = instrument();
        assert_eq!(
            PendingResults::of(std::slice::from_ref(&program)).silent_programs(),
            None,
            "it is the servo"
        );
        let servo = NodePlan { node: Some(NodeKind::ServoController), ..program.clone() };
        let mut d = PendingResults::of(&[program, servo]);
        assert!(d.silent_programs().unwrap().contains("from instrument before"));
        d.remember(&RecordedSpeeds { measured: [7, 9].into(), inverted: [7].into() });
        for step in [7, 9, 11] {
            answered(&mut d, "moduli", step);
        }
        assert_eq!(d.silent_programs(), None);
        assert_eq!(d.state_of(7), ResultState::Settling);
        assert_eq!(d.state_of(9), ResultState::Measured(Source::Instrument));
        assert_eq!(d.state_of(11), ResultState::Open(Source::Instrument));
    }

    #[test]
    fn data_of_a_program_that_until_inverted_names_are_waited_for() {
        let given = ["run", "dem_simulator", "--ros-args", "-p", "until_inverted:=[packing_report,moduli]"];
        let node = |node, name: &str| NodePlan { node, name: name.to_owned(), ..NodePlan::default() };
        let simulator = NodePlan {
            arguments: given.map(str::to_owned).into(),
            ..node(Some(NodeKind::DemSimulator), "dem_simulator")
        };
        let analyzer = node(Some(NodeKind::FabricAnalyzer), "analyzer");
        let servo = node(Some(NodeKind::ServoController), "servo");
        let mut d = PendingResults::of(&[simulator, analyzer, servo, node(None, "watch")]);
        answered(&mut d, "packing_report", 9);
        assert_eq!(d.state_of(9), ResultState::Open(Source::Instrument));
        assert!(
            d.silent_programs()
                .unwrap()
                .starts_with("no wave speeds or other data of a packing came from watch")
        );
        d.measured("moduli", 9);
        assert_eq!(d.state_of(9), ResultState::Measured(Source::Instrument));
        assert_eq!(d.silent_programs(), None);
        d.inverted("moduli", 9, 2);
        assert_eq!(d.state_of(9), ResultState::Settling);
    }

    #[test]
    fn as_many_shots_are_waited_for_as_every_other_packing_has() {
        let program = instrument();
        let mut d = PendingResults::of(&[program]);
        answered(&mut d, "moduli", 9);
        (0..3).for_each(|_| d.measured("wave_speeds", 7));
        for shot in 0..3 {
            assert_eq!(d.state_of(9), ResultState::Open(Source::Instrument), "{shot}");
            answered(&mut d, "wave_speeds", 9);
        }
        assert_eq!(d.state_of(9), ResultState::Settling);
        d.measured("wave_speeds", 9);
        assert_eq!(d.state_of(9), ResultState::Measured(Source::Instrument));
    }

    #[test]
    fn with_a_probe_both_kinds_of_data_must_be_inverted() {
        let mut d = pending(&[NodeKind::FabricAnalyzer, NodeKind::AcousticProbe]);
        assert_eq!(d.state_of(7), ResultState::Open(ANALYZER));
        answered(&mut d, "packing_report", 7);
        assert_eq!(d.state_of(7), ResultState::Open(PROBE));
        d.measured("wave_speeds", 7);
        assert_eq!(d.state_of(7), ResultState::Measured(PROBE));
        d.inverted("wave_speeds", 6, 2);
        assert_eq!(d.state_of(7), ResultState::Measured(PROBE), "another packing");
        d.inverted("wave_speeds", 7, 2);
        assert_eq!(d.state_of(7), ResultState::Complete);
    }

    #[test]
    fn without_a_probe_wave_speeds_from_elsewhere_are_not_waited_for() {
        let mut d = pending(&[NodeKind::FabricAnalyzer]);
        d.inverted("wave_speeds", 7, 2);
        assert_eq!(d.state_of(7), ResultState::Open(ANALYZER));
        d.inverted("packing_report", 7, 2);
        assert_eq!(d.state_of(7), ResultState::Complete);
        assert_eq!(pending(&[]).state_of(7), ResultState::Open(ANALYZER));
        let mut d = pending(&[NodeKind::AcousticProbe]);
        d.inverted("wave_speeds", 7, 2);
        assert_eq!(d.state_of(7), ResultState::Complete);
    }

    #[test]
    fn a_probe_that_declines_is_not_waited_for() {
        let mut d = pending(&[NodeKind::FabricAnalyzer, NodeKind::AcousticProbe]);
        d.declined("wave_speeds", 7);
        d.measured("packing_report", 7);
        assert_eq!(d.state_of(7), ResultState::Measured(ANALYZER));
        d.inverted("packing_report", 7, 2);
        assert_eq!(d.state_of(7), ResultState::Declined(PROBE));
    }
    #[test]
    fn every_inversion_of_the_run_is_waited_for() {
        let mut d = pending(&[NodeKind::FabricAnalyzer, NodeKind::EmtInversion, NodeKind::EmtInversion]);
        answered(&mut d, "packing_report", 7);
        d.inverted("packing_report", 7, 2);
        assert_eq!(d.state_of(7), ResultState::Measured(ANALYZER));
        d.inverted("packing_report", 7, 3);
        assert_eq!(d.state_of(7), ResultState::Complete);
    }

    #[test]
    fn a_packing_that_was_measured_and_has_no_stiffness_is_not_waited_for() {
        let mut d = pending(&[NodeKind::FabricAnalyzer]);
        d.measured("packing_report", 7);
        d.declined("packing_report", 7);
        assert_eq!(d.state_of(7), ResultState::Declined(ANALYZER));
        d.measured("packing_report", 9);
        assert_eq!(d.state_of(9), ResultState::Measured(ANALYZER));
    }

    #[test]
    fn without_an_analyzer_the_moduli_of_another_program_are_waited_for() {
        let mut d = pending(&[NodeKind::EmtInversion]);
        assert_eq!(d.state_of(7), ResultState::Open(ANALYZER));
        answered(&mut d, "moduli", 7);
        assert_eq!(d.state_of(7), ResultState::Complete);
    }
}
