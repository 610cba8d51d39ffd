//! Messages of two recordings, compared topic by topic in one pass over both.
//!
//! To read a recording once for each topic would take a time that grows with the square of the number of topics. So all topics are
//! read together, and a message waits until its counterpart in the other recording comes. If too many bytes wait, because the
//! recordings have their topics in another order, each half of the topics is read for itself.

use super::messages::{by_source, difference, is_same};
use grainlab_console::Failure;
use grainlab_msgs::{Topic, topics};
use grainlab_recordings::{ChannelInfo, Message, Recording, Selection};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};
use std::hash::{BuildHasher, RandomState};
use std::sync::Arc;

const MAX_WAITING_BYTES: usize = 256 << 20;

#[derive(Serialize)]
pub(super) struct Compared {
    pub(super) topic: String,
    /// Numbers of messages, without repeats.
    pub(super) messages: [usize; 2],
    /// `same`, `differ`, `only in A`, `only in B`, `no messages`, or `not compared`.
    pub(super) payload: &'static str,
    pub(super) same_times: bool,
    pub(super) first_difference: Option<String>,
}

/// A topic of one recording or both.
#[derive(Default)]
pub(super) struct Pair {
    name: String,
    /// Its channel in A and in B.
    pub(super) channels: [Option<Arc<ChannelInfo>>; 2],
}

pub(super) fn pairs(both: &[Recording; 2], wanted: impl Fn(&ChannelInfo) -> bool) -> Vec<Pair> {
    let mut pairs = BTreeMap::<String, Pair>::new();
    for (side, recording) in both.iter().enumerate() {
        for channel in recording.channels().into_iter().filter(|channel| wanted(channel)) {
            let pair = pairs.entry(channel.topic.clone()).or_default();
            pair.name.clone_from(&channel.topic);
            pair.channels[side] = Some(channel);
        }
    }
    pairs.into_values().collect()
}

impl Pair {
    /// Returns the topic of the laboratory, if it is one.
    pub(super) fn contract(&self) -> Option<&'static Topic> {
        self.channels.iter().flatten().find_map(|c| Topic::of_channel(&c.topic, &c.ros_type))
    }

    fn is_estimates(&self) -> bool {
        self.contract() == Some(&topics::MICROSTRUCTURE)
    }
}

struct Waiting {
    channel: Arc<ChannelInfo>,
    publish_time: u64,
    payload: Vec<u8>,
}

struct Progress {
    row: Compared,
    /// Hashes of the messages so far, for topics on which repeats are left out.
    seen: Option<[HashSet<[u64; 2]>; 2]>,
    /// Messages of the recording that is ahead on this topic.
    waiting: VecDeque<Waiting>,
    ahead: usize,
}

/// Errors if a recording lacks a topic that it was said to have.
pub(super) fn compare(both: &[Recording; 2], pairs: &[Pair]) -> Result<Vec<Compared>, Failure> {
    compare_within(both, pairs, MAX_WAITING_BYTES)
}

fn compare_within(both: &[Recording; 2], pairs: &[Pair], most: usize) -> Result<Vec<Compared>, Failure> {
    // Estimates are sorted first, all of a topic.
    let alone = pairs.len() > 1 && pairs.iter().any(Pair::is_estimates);
    if !alone && let Some(rows) = one_pass(both, pairs, most)? {
        return Ok(rows);
    }
    let (first, second) = pairs.split_at(pairs.len() / 2);
    let mut rows = compare_within(both, first, most)?;
    rows.extend(compare_within(both, second, most)?);
    Ok(rows)
}

/// Compares in one pass; returns `None` if more than `most` bytes of several topics would wait.
fn one_pass(both: &[Recording; 2], pairs: &[Pair], most: usize) -> Result<Option<Vec<Compared>>, Failure> {
    let messages = |side: usize| {
        let here = pairs.iter().filter(|pair| pair.channels[side].is_some()).map(|pair| &pair.name);
        let all = both[side].messages(&Selection::topics(here)).map_err(Failure::failed)?;
        Ok::<Box<dyn Iterator<Item = Message>>, Failure>(match pairs {
            [one] if one.is_estimates() => Box::new(by_source(all.collect())),
            _ => Box::new(all),
        })
    };
    let mut sources = [messages(0)?, messages(1)?];
    let hashes = [RandomState::new(), RandomState::new()];
    let places: HashMap<&str, usize> = pairs.iter().enumerate().map(|(n, pair)| (&*pair.name, n)).collect();
    let mut all: Vec<Progress> = pairs.iter().map(Progress::new).collect();
    // Bytes that wait, and the number of messages of each recording that do.
    let (mut bytes, mut waiting, mut ended) = (0usize, [0usize; 2], [false; 2]);
    while ended != [true; 2] {
        let behind = usize::from(ended[0] || !ended[1] && waiting[1] < waiting[0]);
        let Some(message) = sources[behind].next() else {
            ended[behind] = true;
            continue;
        };
        let Some(place) = places.get(message.channel.topic.as_str()) else { continue };
        let topic = &mut all[*place];
        let hash = || hashes.each_ref().map(|hash| hash.hash_one(&message.payload[..]));
        if topic.seen.as_mut().is_some_and(|seen| !seen[behind].insert(hash())) {
            continue;
        }
        topic.row.messages[behind] += 1;
        let other = 1 - behind;
        if topic.ahead == other
            && let Some(earlier) = topic.waiting.pop_front()
        {
            bytes -= earlier.payload.len();
            waiting[other] -= 1;
            topic.compare(behind, &message, &earlier);
        } else if pairs[*place].channels[other].is_some() && !ended[other] {
            topic.ahead = behind;
            // Behind the first difference, only times are compared.
            let is_compared = topic.row.first_difference.is_none();
            let payload = if is_compared { message.payload.to_vec() } else { Vec::new() };
            bytes += payload.len();
            waiting[behind] += 1;
            let Message { channel, publish_time, .. } = message;
            topic.waiting.push_back(Waiting { channel, publish_time, payload });
            if bytes > most && pairs.len() > 1 {
                return Ok(None);
            }
        }
    }
    Ok(Some(all.into_iter().map(Progress::finish).collect()))
}

impl Progress {
    fn new(pair: &Pair) -> Self {
        let row = Compared {
            topic: pair.name.clone(),
            messages: [0; 2],
            payload: "same",
            same_times: true,
            first_difference: None,
        };
        let is_reproducible = pair.contract().is_some_and(|topic| topic.reproducible);
        let seen = is_reproducible.then(Default::default);
        Self { row, seen, waiting: VecDeque::new(), ahead: 0 }
    }

    /// Compares a message of the recording `behind` with the one that waited for it.
    fn compare(&mut self, behind: usize, message: &Message, earlier: &Waiting) {
        self.row.same_times &= message.publish_time == earlier.publish_time;
        let mut sides =
            [(&*message.channel, &message.payload[..]), (&*earlier.channel, &earlier.payload[..])];
        if behind == 1 {
            sides.reverse();
        }
        let [a, b] = sides;
        if self.row.first_difference.is_none() && !is_same(a, b) {
            let number = self.row.messages[behind];
            self.row.first_difference = Some(format!("message {number}: {}", difference(a, b)));
        }
    }

    fn finish(self) -> Compared {
        let same_times = self.row.same_times && self.row.messages[0] == self.row.messages[1];
        Compared { same_times, ..self.row }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    /// A recording of messages: topic and payload.
    fn recording(messages: impl IntoIterator<Item = (String, Vec<u8>)>) -> Recording {
        crate::testing::recording(
            messages.into_iter().map(|(topic, payload)| (topic, "json", [""; 2], payload)),
        )
    }

    /// The number of messages, the first difference, and whether times are the same, for each topic.
    fn compared(both: &[Recording; 2], most: usize) -> Vec<(String, [usize; 2], Option<String>, bool)> {
        let rows = compare_within(both, &pairs(both, |_| true), most).unwrap();
        rows.into_iter().map(|r| (r.topic, r.messages, r.first_difference, r.same_times)).collect()
    }

    #[test]
    fn topics_in_another_order_are_compared_to_the_same_result_with_little_memory() {
        let messages = |topic: &str, values: &[u8]| {
            values.iter().map(|v| (topic.to_owned(), vec![*v; 9])).collect::<Vec<_>>()
        };
        let a = [messages("/a", &[1, 2, 3]), messages("/b", &[4, 5]), messages("/c", &[6, 7, 8])].concat();
        let b = [
            messages("/d", &[1]),
            messages("/c", &[6, 9]),
            messages("/b", &[4, 5]),
            messages("/a", &[1, 2, 3]),
        ];
        let both = [recording(a), recording(b.concat())];
        let expected = [
            ("/a".to_owned(), [3, 3], None, true),
            ("/b".to_owned(), [2, 2], None, true),
            ("/c".to_owned(), [3, 2], Some("message 2: byte 0 of 9 and 9".to_owned()), false),
            ("/d".to_owned(), [0, 1], None, false),
        ];
        for most in [0, 9, 20, MAX_WAITING_BYTES] {
            assert_eq!(compared(&both, most), expected, "{most}");
        }
        assert!(one_pass(&both, &pairs(&both, |_| true), 9).unwrap().is_none(), "more than 9 bytes wait");
    }

    /// A time that is proportional to the number of topics is a second of computing; one that grows with its square is minutes.
    #[test]
    fn ten_thousand_topics_are_compared_in_seconds() {
        let all = || (0..10_000).map(|n| (format!("/t{n}"), b"1".to_vec()));
        let both = [recording(all()), recording(all())];
        let begin = Instant::now();
        let rows = compare(&both, &pairs(&both, |_| true)).unwrap();
        assert!(
            rows.len() == 10_000 && rows.iter().all(|r| r.messages == [1, 1] && r.first_difference.is_none())
        );
        let taken = begin.elapsed();
        assert!(taken < Duration::from_secs(60), "{taken:?}");
    }
}
