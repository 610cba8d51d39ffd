//! Doubts about a recording: two processes of one name or one task, or packings of another scene.

use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::{Guid, from_cdr, msg};
use grainlab_node_kit::{Participant, Report, Sample};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of lines.
const MOST: usize = 64;

/// The part of the state of a run that is compared.
#[derive(Deserialize)]
struct RunState {
    /// Fingerprint of the scene of the simulator.
    scene: u64,
}

#[derive(Debug, Default)]
pub(crate) struct Disputes {
    pub(crate) lines: Vec<String>,
    /// Fingerprint of the scene that is stored.
    scene: Option<u64>,
    /// Writers of packings that were compared with it.
    compared: BTreeSet<Guid>,
    /// Processes that reported under each name of a node, in the order of their first report.
    named: BTreeMap<String, Vec<Participant>>,
    /// True if this recorder saw packings of another scene.
    pub(crate) of_scene: bool,
    /// True if this recorder saw two processes of one name or task.
    pub(crate) of_processes: bool,
}

impl Disputes {
    pub(crate) fn new(scene: Option<u64>) -> Self {
        Self { scene, ..Self::default() }
    }

    /// A process published about the run in addition to the first one.
    pub(crate) fn second(&mut self, topic: &str, who: &str) {
        self.of_processes = true;
        self.add(format!("{topic}: {who} publishes about this run in addition to the first process"));
    }

    /// Looks for two processes of one name: one that reports again after another has begun was not replaced by it.
    pub(crate) fn report(&mut self, sample: &Sample, describe: impl Fn(Guid) -> String) {
        let Ok(message) = from_cdr::<DiagnosticArray>(&sample.body) else { return };
        let who = sample.info.writer.participant();
        for report in Report::from_message(&message) {
            let known = self.named.entry(report.node.clone()).or_default();
            match known.last() {
                Some(last) if *last == who => {}
                Some(last) if known.contains(&who) => {
                    let both = [who, *last].map(|p| describe(Guid::of_participant(p)));
                    self.of_processes = true;
                    self.add(format!("two processes are named {}: {}", report.node, both.join(" and ")));
                }
                _ if known.len() < MOST => known.push(who),
                _ => {}
            }
        }
    }

    /// Compares the first packing of each simulator with the scene.
    pub(crate) fn packing(&mut self, sample: &Sample) {
        let Some(scene) = self.scene.filter(|_| self.compared.len() < MOST) else { return };
        if !self.compared.insert(sample.info.writer) {
            return;
        }
        let Ok(packing) = from_cdr::<msg::Packing>(&sample.body) else { return };
        // Versions before JSON have no fingerprint.
        let found = serde_json::from_slice::<RunState>(&packing.run_state);
        if found.is_ok_and(|found| found.scene != scene) {
            self.of_scene = true;
            self.add(format!(
                "the packings are not of the stored scene: they are of the scene {:?} with other keys or another seed. \
                 Give simulator and recorder the same scene and seed",
                packing.scene
            ));
        }
    }

    fn add(&mut self, line: String) {
        if self.lines.len() < MOST && !self.lines.contains(&line) {
            log::error!("{line}");
            self.lines.push(line);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::to_cdr;
    use grainlab_node_kit::{Health, SampleInfo};

    fn sample(who: u8, body: Vec<u8>) -> Sample {
        let info =
            SampleInfo { writer: Guid([who; 16]), sequence: 1, source_time: None, received: 0, about: None };
        Sample { body, info }
    }

    #[test]
    fn a_restarted_process_may_have_the_name_of_the_one_before_and_a_second_one_may_not() {
        let mut disputes = Disputes::new(None);
        let report = Report {
            node: "/emt_inversion".into(),
            pid: 1,
            health: Health::ok(""),
            exit: None,
            published: Vec::new(),
            received: Vec::new(),
        };
        let body = to_cdr(&report.to_message(0));
        let mut reports = |who| {
            disputes.report(&sample(who, body.clone()), |guid| guid.to_string());
            disputes.lines.len()
        };
        assert_eq!([1, 1, 2, 2, 3].map(&mut reports), [0; 5], "each replaces the one before");
        assert_eq!(reports(2), 1);
        assert!(disputes.of_processes && disputes.lines[0].contains("/emt_inversion"));
    }

    #[test]
    fn packings_of_another_seed_are_not_of_the_stored_scene() {
        let packing = |scene: u64| {
            let run_state = format!("{{\"version\":4,\"scene\":{scene}}}").into_bytes();
            to_cdr(&msg::Packing { run_state, ..msg::Packing::default() })
        };
        let mut disputes = Disputes::new(Some(u64::MAX));
        disputes.packing(&sample(1, packing(u64::MAX)));
        assert!(!disputes.of_scene);
        disputes.packing(&sample(2, packing(7)));
        assert!(disputes.of_scene && disputes.lines.len() == 1);
    }
}
