//! Detects repetitions of recorded messages.
//!
//! A request without an answer is published again, a servo that replaces another answers again, and a simulator that
//! resumes from a packing repeats its requests: all with the same bytes. The recording holds each of them once. Other bytes
//! in the place of a recorded message contradict it.

use grainlab_console::Failure;
use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::{Guid, Topic, from_cdr, topics};
use grainlab_node_kit::{member_of, run_of};
use grainlab_recordings::{ChannelInfo, Recording, Selection};
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
        /// Sequence number in the lockstep, or step of the packing.
        number: u64,
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
            Ok(_) => Novelty::Contradiction { number: sequence },
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
    /// Writer and fingerprint of the first result of each step, on the topics of which a step has one.
    of_steps: BTreeMap<(&'static str, u64), (Guid, u64)>,
    /// Fingerprints of the results of recorders before this one, by topic.
    before: BTreeMap<&'static str, BTreeSet<u64>>,
}

impl Repeats {
    /// Reads the messages of earlier recorders.
    pub fn remember(&mut self, recording: &Recording) -> Result<(), Failure> {
        let contract = |c: &ChannelInfo| Topic::of_channel(&c.topic, &c.ros_type).filter(|t| t.reproducible);
        let channels = recording.channels();
        let names = channels.iter().filter(|c| contract(c).is_some()).map(|c| c.topic.clone());
        for message in recording.messages(&Selection::topics(names))? {
            let Some(topic) = contract(&message.channel) else { continue };
            // A message of another definition is sent again as one of this: the same bytes then.
            let Ok(body) = message.own_bytes() else { continue };
            if [topics::STRESS.name, topics::STRAIN_RATE.name].contains(&topic.name) {
                self.enter(topic, Guid([0; 16]), &body, |_| false);
            } else {
                self.before.entry(topic.name).or_default().insert(fingerprint(&body));
            }
        }
        Ok(())
    }

    /// Classifies one message of a topic; `present` says whether a writer is there. A message that does not decode
    /// counts as new.
    pub fn enter(
        &mut self,
        topic: &Topic,
        writer: Guid,
        body: &[u8],
        present: impl Fn(&Guid) -> bool,
    ) -> Novelty {
        if !topic.reproducible {
            return Novelty::New;
        }
        let fingerprint = fingerprint(body);
        let sequence = match topic.name {
            name if name == topics::STRESS.name => from_cdr::<Stress>(body).map(|m| m.sequence),
            name if name == topics::STRAIN_RATE.name => from_cdr::<StrainRate>(body).map(|m| m.sequence),
            _ => {
                if OF_A_STEP.contains(&topic.name)
                    && let Some(number) = step(body)
                {
                    let first = self.of_steps.entry((topic.name, number)).or_insert((writer, fingerprint));
                    // A process that was started again by hand has another number, and the one before it is gone.
                    let is_other =
                        author(first.0) != author(writer) && (is_member(first.0) || present(&first.0));
                    if is_other && first.1 != fingerprint {
                        return Novelty::Contradiction { number };
                    }
                }
                let known = self.before.get(topic.name).is_some_and(|known| known.contains(&fingerprint));
                let new = !known
                    && self.results.entry(topic.name).or_default().insert((author(writer), fingerprint));
                return if new { Novelty::New } else { Novelty::Repeat };
            }
        };
        match sequence {
            Ok(sequence) => self.lockstep.entry(topic.name).or_default().enter(sequence, fingerprint),
            Err(_) => Novelty::New,
        }
    }
}

/// Results of which a step has one.
const OF_A_STEP: [&str; 2] = [topics::PACKING.name, topics::PACKING_REPORT.name];

/// The step of a message that begins with a header and a step. The rest, which may be large, is not decoded.
fn step(body: &[u8]) -> Option<u64> {
    let (header, body) = body.split_at_checked(4)?;
    let big = header[1] == 0;
    let length: [u8; 4] = body.get(8..12)?.try_into().ok()?;
    let length = if big { u32::from_be_bytes(length) } else { u32::from_le_bytes(length) };
    let at = 12usize.checked_add(length as usize)?.checked_next_multiple_of(8)?;
    let step: [u8; 8] = body.get(at..at.checked_add(8)?)?.try_into().ok()?;
    Some(if big { u64::from_be_bytes(step) } else { u64::from_le_bytes(step) })
}

/// True for a process with a number in its run that it keeps when it is started again.
fn is_member(writer: Guid) -> bool {
    let participant = writer.participant();
    run_of(&participant).is_some() && member_of(&participant) > 0
}

/// Value that a process of a launched run and its restarted successor have in common.
pub(crate) fn author(writer: Guid) -> u64 {
    let participant = writer.participant();
    match is_member(writer) {
        true => u64::from(member_of(&participant)),
        false => participant[4..].iter().fold(0, |bits, byte| bits << 8 | u64::from(*byte)),
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
    use grainlab_msgs::msg::PackingReport;
    use grainlab_msgs::std_msgs::Header;
    use grainlab_msgs::to_cdr;

    fn stress(sequence: u64, step: u64) -> Vec<u8> {
        to_cdr(&Stress { sequence, step, ..Stress::default() })
    }

    #[test]
    fn a_request_is_new_once_and_another_of_its_number_is_a_contradiction() {
        let mut repeats = Repeats::default();
        let mut enter = |sequence, step| {
            repeats.enter(&topics::STRESS, Guid([1; 16]), &stress(sequence, step), |_| false)
        };
        assert_eq!(
            [enter(0, 0), enter(1, 5), enter(0, 0), enter(1, 5)].map(|n| n == Novelty::New),
            [true, true, false, false]
        );
        assert_eq!(enter(1, 6), Novelty::Contradiction { number: 1 });
        assert_eq!(enter(2, 10), Novelty::New);
    }

    #[test]
    fn what_left_the_window_is_a_repeat_and_takes_no_memory() {
        let mut window = Window::default();
        let numbers = 3 * WINDOW as u64;
        assert!((0..numbers).all(|n| window.enter(n, n) == Novelty::New));
        assert_eq!(window.recent.len(), WINDOW);
        assert_eq!(window.enter(5, 99), Novelty::Repeat);
        assert_eq!(window.enter(numbers - 1, 99), Novelty::Contradiction { number: numbers - 1 });
    }

    #[test]
    fn two_writers_may_send_the_same_and_a_heartbeat_is_always_new() {
        let mut repeats = Repeats::default();
        let body = [0, 1, 0, 0, 7];
        let mut enter = |topic, who| repeats.enter(topic, Guid([who; 16]), &body, |_| true);
        let new = [1, 2, 1].map(|who| enter(&topics::MICROSTRUCTURE, who));
        assert_eq!(new, [Novelty::New, Novelty::New, Novelty::Repeat]);
        assert!((0..3).all(|_| enter(&topics::DIAGNOSTICS, 1) == Novelty::New));
    }

    #[test]
    fn two_processes_contradict_each_other_about_a_step_and_a_process_does_not_contradict_itself() {
        let report = |axis: f64| {
            let header = Header { frame_id: "cell".into(), ..Header::default() };
            to_cdr(&PackingReport {
                header,
                source_step: 77,
                solid_fraction: axis,
                ..PackingReport::default()
            })
        };
        assert_eq!(step(&report(0.5)), Some(77));
        assert_eq!(step(&report(0.5)[..20]), None);
        let mut repeats = Repeats::default();
        let mut enter = |who, axis, there| {
            repeats.enter(&topics::PACKING_REPORT, Guid([who; 16]), &report(axis), |_| there)
        };
        assert_eq!(enter(1, 0.5, true), Novelty::New);
        assert_eq!(enter(2, 0.5, true), Novelty::New, "two that agree");
        assert_eq!(enter(2, 0.6, true), Novelty::Contradiction { number: 77 });
        assert_eq!(enter(1, 0.6, true), Novelty::New, "with other parameters");
        assert_eq!(enter(3, 0.7, false), Novelty::New, "the first one has left");
    }
}
