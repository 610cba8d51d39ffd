//! Messages missing in a recording, and its table of counts.

use grainlab_console::Table;
use grainlab_recordings::TopicTally;

/// Messages missing before the first one recorded of each writer, and those missing after it.
pub fn losses(tallies: &[TopicTally]) -> (u64, u64) {
    tallies.iter().flat_map(|t| &t.writers).fold((0, 0), |(before, after), w| {
        // A writer without recorded messages has no first message: all messages that it reported are missing. Where the counts
        // begin with the first message, no gap is before it.
        let due = w.first.map_or(0, |first| w.failed.map_or(first, |failed| failed.min(first)));
        let early: u64 =
            w.gaps.iter().map(|(start, end)| (due.min(end.saturating_add(1)) - start).max(0) as u64).sum();
        let early = early.min(w.lost);
        (before + early, after + w.lost - early)
    })
}

/// The counts of a recording as a table.
pub fn counts(tallies: &[TopicTally]) -> String {
    let mut t = Table::new(["topic", "published", "recorded", "lost", "repeated"]);
    for topic in tallies.iter().filter(|t| t.published > 0) {
        let numbers = [topic.published, topic.recorded, topic.lost, topic.repeated];
        t.row([topic.name.clone()].into_iter().chain(numbers.map(|n| n.to_string())));
    }
    t.text()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::Guid;
    use grainlab_recordings::Ledger;

    const WRITER: Guid = Guid([1; 16]);

    fn ledger(from_first: bool, numbers: &[i64]) -> Ledger {
        let mut ledger = Ledger::default();
        if from_first {
            ledger.count_from_first("/t");
        }
        numbers.iter().for_each(|number| _ = ledger.enter("/t", WRITER, *number));
        ledger
    }

    #[test]
    fn messages_lost_after_a_late_first_one_are_not_those_from_before_the_recording() {
        assert_eq!(losses(&ledger(false, &[5, 6, 9]).tallies()), (4, 2));
        assert_eq!(losses(&ledger(true, &[5, 6, 9]).tallies()), (0, 2));
    }

    #[test]
    fn messages_that_could_not_be_received_before_the_first_one_are_lost() {
        for (from_first, early) in [(false, 2), (true, 0)] {
            let mut ledger = ledger(from_first, &[5, 6]);
            ledger.fail("/t", WRITER, 3, 4);
            assert_eq!(losses(&ledger.tallies()), (early, 2));
        }
    }
}
