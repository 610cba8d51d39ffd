//! The received sequence numbers of one writer.

use std::collections::BTreeMap;

/// Most ranges kept per writer: thousands of gaps mean a faulty or hostile writer, which must not exhaust the memory.
const MOST_GAPS: usize = 4096;

/// The received numbers of 1, 2, 3 …, kept as the missing ranges. If there are too many of these, the lowest
/// is dropped: its numbers stay missing, and count as redelivered if they arrive later.
#[derive(Clone, Debug, Default)]
pub(super) struct Sequence {
    /// Highest received number; 0 before the first.
    pub(super) highest: i64,
    pub(super) first: Option<i64>,
    /// Missing ranges below `highest`: first number → last number, both included.
    gaps: BTreeMap<i64, i64>,
    pub(super) held: u64,
    pub(super) redelivered: u64,
}

impl Sequence {
    pub(super) fn holds(&self, number: i64) -> bool {
        self.first.is_some() && number <= self.highest && self.gap_of(number).is_none()
    }

    /// Adds `number`; `false`, and counted as redelivered, if it was received before.
    pub(super) fn enter(&mut self, number: i64) -> bool {
        if self.holds(number) {
            self.redelivered += 1;
            return false;
        }
        if number > self.highest {
            // A first number below 1 implies no missing ones.
            if let Some(next) = self.highest.checked_add(1).filter(|next| *next < number) {
                self.open(next, number - 1);
            }
            self.highest = number;
        } else if let Some((start, end)) = self.gap_of(number) {
            self.gaps.remove(&start);
            if start < number {
                self.open(start, number - 1);
            }
            if number < end {
                self.open(number + 1, end);
            }
        }
        self.first = Some(self.first.map_or(number, |f| f.min(number)));
        self.held += 1;
        true
    }

    fn open(&mut self, start: i64, end: i64) {
        self.gaps.insert(start, end);
        if self.gaps.len() > MOST_GAPS {
            self.gaps.pop_first();
        }
    }

    fn gap_of(&self, number: i64) -> Option<(i64, i64)> {
        let (start, end) = self.gaps.range(..=number).next_back()?;
        (number <= *end).then_some((*start, *end))
    }

    pub(super) fn gaps(&self) -> impl Iterator<Item = (i64, i64)> + '_ {
        self.gaps.iter().map(|(a, b)| (*a, *b))
    }
}
