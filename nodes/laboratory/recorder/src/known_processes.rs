//! The processes that a recorder has heard.

use grainlab_msgs::Guid;
use grainlab_node_kit::Participant;
use std::collections::BTreeSet;

/// The processes that published, and those that sent their last report, which counts all messages of the process.
#[derive(Debug, Default)]
pub(crate) struct KnownProcesses {
    pub(crate) own: Option<Participant>,
    heard: BTreeSet<Participant>,
    pub(crate) left: BTreeSet<Participant>,
}

impl KnownProcesses {
    pub(crate) fn note_writer(&mut self, writer: Guid) {
        self.heard.insert(writer.participant());
    }

    /// Number of processes that left without a last report.
    pub(crate) fn missing(&self, present: &[Guid]) -> usize {
        let there: BTreeSet<_> = present.iter().map(Guid::participant).chain(self.own).collect();
        self.heard.iter().filter(|p| !self.left.contains(*p) && !there.contains(*p)).count()
    }

    /// True if every process that published, or has a writer in `present`, has sent its last report.
    pub(crate) fn all_left(&self, present: &[Guid]) -> bool {
        let mut known = self.heard.iter().copied().chain(present.iter().map(Guid::participant));
        known.all(|p| Some(p) == self.own || self.left.contains(&p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everyone_has_left_after_the_last_report_of_each() {
        let writer = |who| Guid([who; 16]);
        let mut known_processes = KnownProcesses { own: Some([1; 12]), ..KnownProcesses::default() };
        assert!(known_processes.all_left(&[writer(1)]), "there is nobody but the recorder");
        known_processes.note_writer(writer(2));
        assert!(!known_processes.all_left(&[]), "gone without a word: it may have been killed");
        assert_eq!((known_processes.missing(&[]), known_processes.missing(&[writer(2)])), (1, 0));
        known_processes.left.insert([2; 12]);
        assert!(known_processes.all_left(&[writer(1), writer(2)]));
        assert!(
            !known_processes.all_left(&[writer(2), writer(3)]),
            "one that was never heard may still speak"
        );
    }
}
