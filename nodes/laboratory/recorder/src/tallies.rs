//! Messages missing in a recording, and its table of counts.

use grainlab_console::Table;
use grainlab_recordings::TopicTally;

/// Messages missing before the first one recorded of each writer, and those missing after it.
pub fn losses(tallies: &[TopicTally]) -> (u64, u64) {
    tallies.iter().flat_map(|t| &t.writers).fold((0, 0), |(before, after), w| {
        // A writer without recorded messages has no first message: all messages that it reported are missing.
        let early = w.first.map_or(0, |first| (first - 1).max(0) as u64).min(w.lost);
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
