//! The content of a recording, topic by topic, without repeats.

use grainlab_msgs::msg::Microstructure;
use grainlab_msgs::{Message, from_cdr};
use grainlab_recordings::{Recording, Selection};
use std::path::Path;

/// The reproducible topics of every run: they must not depend on timing.
pub const REPRODUCIBLE: [&str; 5] =
    ["/stress", "/strain_rate", "/packing", "/packing_report", "/microstructure"];

/// Distinct message bodies of one topic, in the order of their first appearance. A request repeated because
/// its answer was late, or a result published again by a restarted node, has the same bytes; one of them
/// remains. Estimates of one source follow those of the other: their order among each other depends on timing.
pub fn distinct(run: &Path, topic: &str) -> Vec<Vec<u8>> {
    let recording = Recording::open(run).unwrap_or_else(|e| panic!("{}: {e}", run.display()));
    let messages = recording.messages(&Selection::topics([topic]));
    let messages = messages.unwrap_or_else(|e| panic!("{topic} of {}: {e}", run.display()));
    let mut messages: Vec<_> = messages.collect();
    if topic.ends_with("/microstructure") {
        messages.sort_by_cached_key(|m| m.decoded::<Microstructure>().map(|m| m.source).unwrap_or_default());
    }
    let mut seen = std::collections::HashSet::new();
    messages.iter().map(|m| m.payload.to_vec()).filter(|b| seen.insert(b.clone())).collect()
}

/// Number of recorded messages of a topic so far; 0 without a recording.
pub fn recorded(run: &Path, topic: &str) -> usize {
    let Ok(recording) = Recording::open(run) else { return 0 };
    recording.messages(&Selection::topics([topic])).map_or(0, Iterator::count)
}

/// The distinct messages of a topic, decoded.
pub fn decoded<T: Message>(run: &Path, topic: &str) -> Vec<T> {
    let message =
        |body: Vec<u8>| from_cdr(&body).unwrap_or_else(|e| panic!("{topic} of {}: {e}", run.display()));
    distinct(run, topic).into_iter().map(message).collect()
}

/// Fails the test unless both runs are equal, byte for byte, on every reproducible topic.
pub fn assert_same(first: &Path, second: &Path) {
    assert_same_under(first, second, "");
}

/// Compares with a second run whose topics are in a ROS namespace, as in `/left`.
pub fn assert_same_under(first: &Path, second: &Path, namespace: &str) {
    assert_same_named(first, second, |topic| format!("{namespace}{topic}"));
}

/// Compares with a second run whose topics have other names.
pub fn assert_same_named(first: &Path, second: &Path, name: impl Fn(&str) -> String) {
    for topic in REPRODUCIBLE {
        let (a, b) = (distinct(first, topic), distinct(second, &name(topic)));
        assert!(!a.is_empty(), "{topic}: nothing recorded");
        assert_eq!(a.len(), b.len(), "{topic}: {} and {} distinct messages", a.len(), b.len());
        let difference = a.iter().zip(&b).position(|(x, y)| x != y);
        assert_eq!(difference, None, "{topic}: the first difference is in message {difference:?}");
    }
}
