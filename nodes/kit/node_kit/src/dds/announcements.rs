//! What writers announced to the readers of this process, as RustDDS reports it.

use crate::announced::{Announced, TooLarge};
use grainlab_msgs::Guid;
use rustdds::ReceptionEvent as Event;
use std::collections::BTreeMap;

/// Maximum number of writers kept for one reader: short-lived processes must not fill the memory.
const MOST_WRITERS: usize = 4096;

/// By reader and writer. A writer stays after it left, because its messages stay missing.
#[derive(Debug, Default)]
pub(super) struct Announcements(BTreeMap<Guid, BTreeMap<Guid, Announced>>);

impl Announcements {
    /// Enters what a reader learnt of a writer. Returns the messages that were too large so far if this is one more.
    pub(super) fn enter(&mut self, writer: Guid, reader: Guid, event: Event) -> Option<TooLarge> {
        let writers = self.0.entry(reader).or_default();
        if writers.len() >= MOST_WRITERS && !writers.contains_key(&writer) {
            return None;
        }
        let known =
            writers.entry(writer).or_insert(Announced { writer, first: None, last: 0, too_large: None });
        match event {
            Event::Announced { first, last } => {
                offer(known, i64::from(first));
                // The writer knows better than what others claimed for it.
                known.last = i64::from(last);
                None
            }
            Event::Begun { sequence_number } => {
                offer(known, i64::from(sequence_number));
                known.last = known.last.max(i64::from(sequence_number));
                None
            }
            Event::TooLarge { sequence_number, size, limit } => {
                let number = i64::from(sequence_number);
                let none = TooLarge { first: number, last: number, count: 0, largest: size, limit };
                let all = known.too_large.get_or_insert(none);
                all.first = all.first.min(number);
                all.last = all.last.max(number);
                all.count += 1;
                all.largest = all.largest.max(size);
                Some(*all)
            }
        }
    }

    /// What the writers of a reader announced. Only a latched reader is owed what was offered when it joined.
    pub(super) fn of(&self, reader: &Guid, latched: bool) -> Vec<Announced> {
        let writers = self.0.get(reader).into_iter().flat_map(BTreeMap::values);
        writers.map(|a| Announced { first: a.first.filter(|_| latched), ..*a }).collect()
    }
}

fn offer(known: &mut Announced, number: i64) {
    known.first = Some(known.first.map_or(number, |first| first.min(number)).max(1));
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustdds::SequenceNumber;

    const WRITER: Guid = Guid([1; 16]);
    const READER: Guid = Guid([2; 16]);

    fn heartbeat(first: i64, last: i64) -> Event {
        Event::Announced { first: SequenceNumber::from(first), last: SequenceNumber::from(last) }
    }

    #[test]
    fn the_last_heartbeat_counts_and_a_volatile_reader_is_owed_nothing_from_before() {
        let mut announcements = Announcements::default();
        for event in [
            heartbeat(5, 7),
            heartbeat(6, 900),
            heartbeat(6, 9),
            Event::Begun { sequence_number: SequenceNumber::from(10) },
        ] {
            assert_eq!(announcements.enter(WRITER, READER, event), None);
        }
        let expected = Announced { writer: WRITER, first: Some(5), last: 10, too_large: None };
        assert_eq!(announcements.of(&READER, true), [expected]);
        assert_eq!(announcements.of(&READER, false), [Announced { first: None, ..expected }]);
    }

    #[test]
    fn messages_that_are_too_large_are_counted_and_the_writers_of_a_reader_are_bounded() {
        let mut announcements = Announcements::default();
        for (number, size) in [(4, 30), (2, 50)] {
            let sequence_number = SequenceNumber::from(number);
            announcements.enter(WRITER, READER, Event::TooLarge { sequence_number, size, limit: 20 });
        }
        let expected = TooLarge { first: 2, last: 4, count: 2, largest: 50, limit: 20 };
        assert_eq!(announcements.of(&READER, false)[0].too_large, Some(expected));
        for n in 0..2 * MOST_WRITERS as u64 {
            let mut writer = [7; 16];
            writer[..8].copy_from_slice(&n.to_le_bytes());
            announcements.enter(Guid(writer), READER, heartbeat(1, 1));
        }
        assert_eq!(announcements.of(&READER, false).len(), MOST_WRITERS);
    }
}
