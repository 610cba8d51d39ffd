//! Names of several measurements of one packing: a laboratory may send the speeds of several shots.

use grainlab_console::escape_name;
use grainlab_msgs::builtin_interfaces::Time;
use serde::{Serialize, Serializer};
use std::collections::{BTreeMap, BTreeSet};

/// One of several sets of data about one packing on one topic.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Measurement {
    /// In the order of arrival, from 1.
    number: usize,
    /// Name, node or stamp that tells it from the others, for a reader.
    pub label: String,
}

impl Measurement {
    /// A measurement with a name of its own.
    pub fn named(name: &str) -> Self {
        Self { number: 0, label: name.to_owned() }
    }
}

impl Serialize for Measurement {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.label)
    }
}

/// Name and stamp, which an answer copies from its data.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Identity {
    name: String,
    stamp: (i32, u32),
}

impl Identity {
    pub(crate) fn new(name: &str, stamp: Time) -> Self {
        // A control character would break the line or the table that it is printed in.
        Self { name: escape_name(name).into_owned(), stamp: (stamp.sec, stamp.nanosec) }
    }

    pub(crate) fn stamp(&self) -> Time {
        Time { sec: self.stamp.0, nanosec: self.stamp.1 }
    }
}

#[derive(Debug)]
struct Sent {
    identity: Identity,
    /// The node that sent it, if it is known.
    by: Option<String>,
    content: Vec<u8>,
}

/// The sets of data about one packing on one topic, and their answers.
#[derive(Debug, Default)]
pub(crate) struct Measurements {
    /// In the order of arrival. A message that was sent again is one set.
    sent: Vec<Sent>,
    answers: BTreeMap<(Identity, Option<String>), usize>,
}

impl Measurements {
    /// Takes a message of a node; false if it was there before.
    pub(crate) fn sent(&mut self, identity: Identity, by: Option<&str>, content: &[u8]) -> bool {
        let new = !self.sent.iter().any(|known| known.identity == identity && known.content == content);
        if new {
            self.sent.push(Sent { identity, by: by.map(str::to_owned), content: content.to_vec() });
        }
        new
    }

    /// Takes an answer of an inversion; returns its number among those with its identity, from 0.
    pub(crate) fn answered(&mut self, identity: Identity, by: Option<String>) -> usize {
        let count = self.answers.entry((identity, by)).or_default();
        *count += 1;
        *count - 1
    }

    fn alike(&self, identity: &Identity) -> usize {
        self.sent.iter().filter(|known| known.identity == *identity).count()
    }

    fn several(&self) -> bool {
        let answered = self.answers.keys().map(|(identity, _)| identity);
        let mut all = self.sent.iter().map(|known| &known.identity).chain(answered);
        let first = all.next();
        self.sent.len() > 1 || all.any(|other| Some(other) != first)
    }

    /// The data with this identity, the `nth` of those alike; `None` if the packing has one measurement only.
    pub(crate) fn label(&self, identity: &Identity, nth: usize) -> Option<Measurement> {
        self.several().then(|| self.named(identity, nth, ""))
    }

    /// Name of an answer. One of data that nothing tells apart has a name of its own.
    pub(crate) fn label_of_answer(&self, identity: &Identity, nth: usize) -> Option<Measurement> {
        self.several().then(|| self.named(identity, nth, "answer "))
    }

    /// A measurement by its name, or else its stamp.
    pub(crate) fn named(&self, identity: &Identity, nth: usize, what: &str) -> Measurement {
        let place = self.sent.iter().position(|known| known.identity == *identity);
        let by = place.and_then(|place| self.sent[place].by.as_deref());
        let of_name = |known: &&Sent| known.identity.name == identity.name && known.identity != *identity;
        let namesakes = self.sent.iter().filter(of_name).count();
        let Identity { name, stamp: (seconds, nanos) } = identity;
        let mut label = match (name.as_str(), by, namesakes) {
            ("", Some(node), 0) => format!("by {node}"),
            ("", ..) => format!("stamp {seconds}.{nanos:09}"),
            (name, _, 0) => name.to_owned(),
            (name, ..) => format!("{name}, stamp {seconds}.{nanos:09}"),
        };
        let number = place.unwrap_or(self.sent.len()) + 1;
        let alike = self.alike(identity);
        // An answer that was sent again is none of another measurement.
        let nth = nth.min(alike.saturating_sub(1));
        if alike > 1 {
            label += &format!(", {what}{} of {alike}", nth + 1);
        }
        Measurement { number: number + nth, label }
    }

    /// A note if the answers of several measurements cannot be told apart.
    pub(crate) fn confusion(&self, topic: &str) -> Option<String> {
        let count = self.sent.iter().map(|known| self.alike(&known.identity)).max().filter(|n| *n > 1)?;
        Some(format!(
            "{count} of the {topic} of this packing have one name and one stamp: which estimate is from which of them is not known; \
             a name of its own for each tells them apart"
        ))
    }

    /// Number of sets of data, and of those that an inversion did not answer.
    pub(crate) fn unanswered(&self) -> (usize, usize) {
        let mut open = 0;
        let mut seen: Vec<&Identity> = Vec::new();
        for Sent { identity, .. } in &self.sent {
            if !seen.contains(&identity) {
                seen.push(identity);
                let most =
                    self.answers.iter().filter(|((known, _), _)| known == identity).map(|(_, n)| *n).max();
                open += self.alike(identity).saturating_sub(most.unwrap_or(0));
            }
        }
        (self.sent.len(), open)
    }

    /// Number of sets of data that were answered and not found.
    pub(crate) fn not_found(&self) -> usize {
        let answered: BTreeSet<&Identity> = self.answers.keys().map(|(identity, _)| identity).collect();
        answered.into_iter().filter(|identity| self.alike(identity) == 0).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shot(name: &str, nanosec: u32) -> Identity {
        Identity::new(name, Time { sec: 5, nanosec })
    }

    fn of(shots: &[Identity]) -> Measurements {
        let mut all = Measurements::default();
        for (n, identity) in shots.iter().enumerate() {
            assert!(all.sent(identity.clone(), None, &[n as u8]));
            assert_eq!(all.answered(identity.clone(), None), all.alike(identity) - 1);
        }
        all
    }

    fn labels(shots: &[Identity]) -> Vec<Option<String>> {
        let all = of(shots);
        shots.iter().map(|identity| all.label(identity, 0).map(|m| m.label)).collect()
    }

    #[test]
    fn a_single_measurement_needs_no_label_and_several_have_their_own() {
        assert_eq!(labels(&[shot("a", 1)]), [None]);
        let some = |texts: &[&str]| texts.iter().map(|t| Some((*t).to_owned())).collect::<Vec<_>>();
        assert_eq!(labels(&[shot("a", 1), shot("b", 1)]), some(&["a", "b"]));
        assert_eq!(labels(&[shot("", 1), shot("", 20)]), some(&["stamp 5.000000001", "stamp 5.000000020"]));
        assert_eq!(labels(&[shot("a\nb", 1), shot("b", 1)]), some(&["a\\nb", "b"]), "one line each");
        assert_eq!(
            labels(&[shot("a", 1), shot("a", 2)]),
            some(&["a, stamp 5.000000001", "a, stamp 5.000000002"])
        );
    }

    #[test]
    fn an_answer_without_its_data_shows_that_they_were_lost() {
        let mut all = of(&[shot("a", 1), shot("b", 1)]);
        assert_eq!(all.not_found(), 0);
        for inversion in ["one", "other"] {
            all.answered(shot("c", 1), Some(inversion.to_owned()));
        }
        assert_eq!(all.not_found(), 1);
    }

    #[test]
    fn measurements_that_nothing_tells_apart_are_said_to_be_so() {
        let all = of(&[shot("", 1), shot("", 1)]);
        let of = |found: Option<Measurement>| found.unwrap().label;
        assert_eq!(of(all.label(&shot("", 1), 1)), "stamp 5.000000001, 2 of 2");
        assert_eq!(of(all.label_of_answer(&shot("", 1), 1)), "stamp 5.000000001, answer 2 of 2");
        assert!(all.confusion("wave_speeds").unwrap().starts_with("2 of the wave_speeds"));
        assert_eq!(super::tests::of(&[shot("a", 1), shot("b", 1)]).confusion("wave_speeds"), None);
    }

    #[test]
    fn what_was_sent_and_not_answered_is_counted_and_what_was_sent_again_is_not() {
        let mut all = of(&[shot("a", 1), shot("b", 1)]);
        assert!(!all.sent(shot("a", 1), None, &[0]));
        assert_eq!(all.unanswered(), (2, 0));
        for n in 2..5 {
            all.sent(shot("b", 1), None, &[n]);
        }
        assert_eq!(all.unanswered(), (5, 3));
        // Another inversion answers all of them.
        (0..4).for_each(|_| _ = all.answered(shot("b", 1), Some("other".into())));
        assert_eq!(all.unanswered(), (5, 0));
    }
}
