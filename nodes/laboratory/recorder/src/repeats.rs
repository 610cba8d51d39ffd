//! Detects repetitions of recorded messages.
//!
//! A request without an answer is published again, a servo that replaces another answers again, and a simulator that
//! resumes from a packing repeats its requests: all with the same bytes. The recording holds each of them once.

use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::{Topic, from_cdr, topics};
use grainlab_recordings::{ChannelInfo, ReadError, Recording, Selection};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Number of exchanges whose bytes are compared, 2 MB: a run that resumes from its last packing repeats at most the
/// exchanges after it.
const WINDOW: usize = 1 << 17;

/// Relation of a message to earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Novelty {
    /// It is new.
    New,
    /// An equal message was recorded before, byte for byte.
    Repeat,
    /// Another message with this number was recorded before.
    Contradiction {
        /// Its sequence number in the lockstep.
        sequence: u64,
    },
}

/// Recorded sequence numbers of the lockstep, with a fingerprint of each body.
#[derive(Debug, Default)]
struct Window {
    /// Number and fingerprint, sorted by number.
    recent: VecDeque<(u64, u64)>,
    /// Numbers below this were recorded and are no longer kept.
    settled: u64,
}

impl Window {
    fn enter(&mut self, sequence: u64, fingerprint: u64) -> Novelty {
        if sequence < self.settled {
            return Novelty::Repeat;
        }
        match self.recent.binary_search_by_key(&sequence, |(known, _)| *known) {
            Ok(place) if self.recent[place].1 == fingerprint => Novelty::Repeat,
            Ok(_) => Novelty::Contradiction { sequence },
            Err(place) => {
                self.recent.insert(place, (sequence, fingerprint));
                if self.recent.len() > WINDOW
                    && let Some((oldest, _)) = self.recent.pop_front()
                {
                    self.settled = oldest + 1;
                }
                Novelty::New
            }
        }
    }
}

/// The recorded messages that may be repeated.
#[derive(Debug, Default)]
pub struct Repeats {
    lockstep: BTreeMap<&'static str, Window>,
    /// Fingerprints of results, by topic and author.
    results: BTreeMap<&'static str, BTreeSet<(u64, u64)>>,
    /// Fingerprints of the results of recorders before this one, by topic.
    before: BTreeMap<&'static str, BTreeSet<u64>>,
}

impl Repeats {
    /// Reads the messages of earlier recorders.
    pub fn remember(&mut self, recording: &Recording) -> Result<(), ReadError> {
        let contract = |c: &ChannelInfo| Topic::of_channel(&c.topic, &c.ros_type).filter(|t| t.reproducible);
        let channels = recording.channels();
        let names = channels.iter().filter(|c| contract(c).is_some()).map(|c| c.topic.clone());
        for message in recording.messages(&Selection::topics(names))? {
            let Some(topic) = contract(&message.channel) else { continue };
            // A message of another definition is sent again as one of this: the same bytes then.
            let Ok(body) = message.own_bytes() else { continue };
            if [topics::STRESS.name, topics::STRAIN_RATE.name].contains(&topic.name) {
                self.enter(topic, 0, &body);
            } else {
                self.before.entry(topic.name).or_default().insert(fingerprint(&body));
            }
        }
        Ok(())
    }

    /// Classifies one message of a topic; `author` is the same for a process and its restarted successor. A message
    /// that does not decode counts as new.
    pub fn enter(&mut self, topic: &Topic, author: u64, body: &[u8]) -> Novelty {
        if !topic.reproducible {
            return Novelty::New;
        }
        let fingerprint = fingerprint(body);
        let sequence = match topic.name {
            name if name == topics::STRESS.name => from_cdr::<Stress>(body).map(|m| m.sequence),
            name if name == topics::STRAIN_RATE.name => from_cdr::<StrainRate>(body).map(|m| m.sequence),
            _ => {
                let known = self.before.get(topic.name).is_some_and(|known| known.contains(&fingerprint));
                let new = !known && self.results.entry(topic.name).or_default().insert((author, fingerprint));
                return if new { Novelty::New } else { Novelty::Repeat };
            }
        };
        match sequence {
            Ok(sequence) => self.lockstep.entry(topic.name).or_default().enter(sequence, fingerprint),
            Err(_) => Novelty::New,
        }
    }
}

fn fingerprint(body: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    body.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::to_cdr;

    fn stress(sequence: u64, step: u64) -> Vec<u8> {
        to_cdr(&Stress { sequence, step, ..Stress::default() })
    }

    #[test]
    fn a_request_is_new_once_and_another_of_its_number_is_a_contradiction() {
        let mut repeats = Repeats::default();
        let mut enter = |sequence, step| repeats.enter(&topics::STRESS, 1, &stress(sequence, step));
        assert_eq!(
            [enter(0, 0), enter(1, 5), enter(0, 0), enter(1, 5)].map(|n| n == Novelty::New),
            [true, true, false, false]
        );
        assert_eq!(enter(1, 6), Novelty::Contradiction { sequence: 1 });
        assert_eq!(enter(2, 10), Novelty::New);
    }

    #[test]
    fn what_left_the_window_is_a_repeat_and_takes_no_memory() {
        let mut window = Window::default();
        let numbers = 3 * WINDOW as u64;
        assert!((0..numbers).all(|n| window.enter(n, n) == Novelty::New));
        assert_eq!(window.recent.len(), WINDOW);
        assert_eq!(window.enter(5, 99), Novelty::Repeat);
        assert_eq!(window.enter(numbers - 1, 99), Novelty::Contradiction { sequence: numbers - 1 });
    }

    #[test]
    fn two_writers_may_send_the_same_and_a_heartbeat_is_always_new() {
        let mut repeats = Repeats::default();
        let body = [0, 1, 0, 0, 7];
        let new = [1, 2, 1].map(|author| repeats.enter(&topics::MICROSTRUCTURE, author, &body));
        assert_eq!(new, [Novelty::New, Novelty::New, Novelty::Repeat]);
        assert!((0..3).all(|_| repeats.enter(&topics::DIAGNOSTICS, 1, &body) == Novelty::New));
    }
}
