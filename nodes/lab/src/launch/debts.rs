//! What the run still owes of its last packing: one microstructure from every kind of data that its nodes measure.

use super::plan::NodePlan;
use crate::nodes::NodeKind;
use grainlab_msgs::topics;
use std::collections::BTreeSet;
use std::fmt;

/// Who measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// A node of ours.
    Node(NodeKind),
    /// The programs of a launch file that are not ours.
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
    /// Who writes it.
    source: Source,
    measured: BTreeSet<u64>,
    /// Step and place of the inversion.
    inverted: BTreeSet<(u64, u8)>,
    declined: BTreeSet<u64>,
}

impl Kind {
    fn new(topic: &'static str, source: Source) -> Self {
        let (measured, inverted, declined) = Default::default();
        Self { topic, source, measured, inverted, declined }
    }
}

/// Where the run stands with one packing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Standing {
    /// Every kind of data is inverted.
    Complete,
    /// Nothing is to come any more, and this node found nothing to invert.
    Declined(Source),
    /// This node measured a structure, and nothing that could be inverted has come.
    Bare(Source),
    /// What is there is not inverted yet; this node measured it.
    Measured(Source),
    /// This node has not measured it yet.
    Open(Source),
}

/// What is known of every kind of data.
#[derive(Debug)]
pub(crate) struct Debts {
    kinds: Vec<Kind>,
    /// Inversions of the run: each of them infers from every kind of data. One, where the run has none: somebody has to.
    inversions: usize,
    /// Whether programs that are not ours run, which may send wave speeds. If they sent those of one packing, the run waits
    /// for those of its last packing.
    instruments: bool,
    /// Packings whose structure was measured.
    structures: BTreeSet<u64>,
}

impl Debts {
    /// Of the nodes that a run has. A microstructure from the moduli is owed even where nobody measures any: who launches
    /// without analyzer and probe gets to know that nothing is inferred.
    pub(crate) fn of(plans: &[NodePlan]) -> Self {
        let has = |node: NodeKind| plans.iter().any(|p| p.is(node));
        let kind = |node: NodeKind| Some(Kind::new(node.measures()?.name, Source::Node(node)));
        let mut kinds: Vec<Kind> = NodeKind::all().filter(|node| has(*node)).filter_map(kind).collect();
        if kinds.is_empty() {
            kinds.extend(kind(NodeKind::FabricAnalyzer));
        }
        let inversions = plans.iter().filter(|p| p.is(NodeKind::EmtInversion)).count().max(1);
        let instruments = !has(NodeKind::AcousticProbe) && plans.iter().any(|p| p.node.is_none());
        Self { kinds, inversions, instruments, structures: BTreeSet::new() }
    }

    /// The structure of the packing of `step` was published. If the packing has moduli, they follow at once.
    pub(crate) fn structure(&mut self, step: u64) {
        self.structures.insert(step);
    }

    /// The data of this topic about the packing of `step` are there.
    pub(crate) fn measured(&mut self, topic: &str, step: u64) {
        // Step 0 is of no packing.
        let instrument = self.instruments && topic == topics::WAVE_SPEEDS.name && step > 0;
        if instrument && self.of_topic(topic).next().is_none() {
            self.kinds.push(Kind::new(topics::WAVE_SPEEDS.name, Source::Instrument));
        }
        self.of_topic(topic).for_each(|k| {
            k.measured.insert(step);
        });
    }

    /// No program that is not ours runs any more.
    pub(crate) fn instruments_left(&mut self) {
        self.instruments = false;
    }

    /// A microstructure from the data of this topic is there, by the inversion in this place.
    pub(crate) fn inverted(&mut self, topic: &str, step: u64, member: u8) {
        self.of_topic(topic).for_each(|k| {
            k.inverted.insert((step, member));
        });
    }

    /// There are no data of this topic about the packing of `step`, and there will be none.
    pub(crate) fn declined(&mut self, topic: &str, step: u64) {
        self.of_topic(topic).for_each(|k| {
            k.declined.insert(step);
        });
    }

    fn of_topic<'a>(&'a mut self, topic: &str) -> impl Iterator<Item = &'a mut Kind> {
        self.kinds.iter_mut().filter(move |k| k.topic == topic)
    }

    /// Where the run stands with the packing of `step`: by what takes longest.
    pub(crate) fn standing(&self, step: u64) -> Standing {
        let inverted = |k: &Kind| k.inverted.range((step, 0)..=(step, u8::MAX)).count() >= self.inversions;
        // A program that is gone sends nothing more.
        let never =
            |k: &Kind| k.source == Source::Instrument && !self.instruments && !k.measured.contains(&step);
        let owed = || self.kinds.iter().filter(|k| !inverted(k) && !never(k));
        let due = || owed().filter(|k| !k.declined.contains(&step));
        let without_moduli = |k: &Kind| k.topic == topics::MODULI.name && self.structures.contains(&step);
        if let Some(open) = due().find(|k| !k.measured.contains(&step) && !without_moduli(k)) {
            return Standing::Open(open.source);
        }
        if let Some(bare) = due().find(|k| !k.measured.contains(&step)) {
            return Standing::Bare(bare.source);
        }
        if let Some(measured) = due().next() {
            return Standing::Measured(measured.source);
        }
        owed().next().map_or(Standing::Complete, |k| Standing::Declined(k.source))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANALYZER: Source = Source::Node(NodeKind::FabricAnalyzer);
    const PROBE: Source = Source::Node(NodeKind::AcousticProbe);

    fn debts(nodes: &[NodeKind]) -> Debts {
        let plan = |node: &NodeKind| NodePlan {
            name: node.to_string(),
            node: Some(*node),
            program: "grainlab".to_owned(),
            arguments: Vec::new(),
            respawn: false,
        };
        Debts::of(&nodes.iter().map(plan).collect::<Vec<_>>())
    }

    #[test]
    fn an_instrument_that_measured_one_packing_is_waited_for_at_the_last_unless_it_left() {
        let foreign = NodePlan {
            name: "instrument".to_owned(),
            node: None,
            program: "python3".to_owned(),
            arguments: Vec::new(),
            respawn: false,
        };
        let ours = NodePlan { node: Some(NodeKind::FabricAnalyzer), ..foreign.clone() };
        let mut d = Debts::of(&[ours, foreign]);
        for step in [7, 9] {
            d.measured("moduli", step);
            d.inverted("moduli", step, 2);
        }
        d.measured("wave_speeds", 0);
        assert_eq!(d.standing(9), Standing::Complete, "speeds of no packing");
        d.measured("wave_speeds", 7);
        assert_eq!(d.standing(9), Standing::Open(Source::Instrument));
        d.measured("wave_speeds", 9);
        assert_eq!(d.standing(9), Standing::Measured(Source::Instrument));
        d.inverted("wave_speeds", 9, 2);
        assert_eq!(d.standing(9), Standing::Complete);
        assert_eq!(d.standing(11), Standing::Open(ANALYZER));
        d.measured("moduli", 11);
        d.inverted("moduli", 11, 2);
        d.instruments_left();
        assert_eq!(d.standing(11), Standing::Complete);
    }

    #[test]
    fn with_a_probe_both_kinds_of_data_must_be_inverted() {
        let mut d = debts(&[NodeKind::FabricAnalyzer, NodeKind::AcousticProbe]);
        assert_eq!(d.standing(7), Standing::Open(ANALYZER));
        d.measured("moduli", 7);
        d.inverted("moduli", 7, 2);
        assert_eq!(d.standing(7), Standing::Open(PROBE));
        d.measured("wave_speeds", 7);
        assert_eq!(d.standing(7), Standing::Measured(PROBE));
        d.inverted("wave_speeds", 6, 2);
        assert_eq!(d.standing(7), Standing::Measured(PROBE), "another packing");
        d.inverted("wave_speeds", 7, 2);
        assert_eq!(d.standing(7), Standing::Complete);
    }

    #[test]
    fn without_a_probe_wave_speeds_from_elsewhere_are_not_waited_for() {
        let mut d = debts(&[NodeKind::FabricAnalyzer]);
        d.inverted("wave_speeds", 7, 2);
        assert_eq!(d.standing(7), Standing::Open(ANALYZER));
        d.inverted("moduli", 7, 2);
        assert_eq!(d.standing(7), Standing::Complete);
        assert_eq!(debts(&[]).standing(7), Standing::Open(ANALYZER));
        let mut d = debts(&[NodeKind::AcousticProbe]);
        d.inverted("wave_speeds", 7, 2);
        assert_eq!(d.standing(7), Standing::Complete);
    }

    #[test]
    fn a_probe_that_declines_is_not_waited_for() {
        let mut d = debts(&[NodeKind::FabricAnalyzer, NodeKind::AcousticProbe]);
        d.declined("wave_speeds", 7);
        d.measured("moduli", 7);
        assert_eq!(d.standing(7), Standing::Measured(ANALYZER));
        d.inverted("moduli", 7, 2);
        assert_eq!(d.standing(7), Standing::Declined(PROBE));
    }
    #[test]
    fn every_inversion_of_the_run_is_waited_for() {
        let mut d = debts(&[NodeKind::FabricAnalyzer, NodeKind::EmtInversion, NodeKind::EmtInversion]);
        d.measured("moduli", 7);
        d.inverted("moduli", 7, 2);
        d.inverted("moduli", 7, 2);
        assert_eq!(d.standing(7), Standing::Measured(ANALYZER));
        d.inverted("moduli", 7, 3);
        assert_eq!(d.standing(7), Standing::Complete);
    }

    #[test]
    fn a_structure_without_moduli_is_not_waited_for_as_if_it_were_not_measured() {
        let mut d = debts(&[NodeKind::FabricAnalyzer]);
        d.structure(7);
        assert_eq!(d.standing(7), Standing::Bare(ANALYZER));
        d.measured("moduli", 7);
        assert_eq!(d.standing(7), Standing::Measured(ANALYZER));
    }
}
