//! The sequence numbers of one writer that have come.

use std::collections::BTreeMap;

/// Which numbers of 1, 2, 3 … have come, kept as the ranges that have not.
#[derive(Clone, Debug, Default)]
pub(super) struct Sequence {
    /// Highest number that has come; 0 before the first.
    highest: i64,
    first: Option<i64>,
    /// Missing ranges below `highest`: first number → last number, both included.
    gaps: BTreeMap<i64, i64>,
    held: u64,
    repeated: u64,
}

impl Sequence {
    /// Whether `number` has come.
    pub(super) fn holds(&self, number: i64) -> bool {
        self.first.is_some() && number <= self.highest && self.gap_of(number).is_none()
    }

    /// Enters `number`; `false`, and counted, if it came before.
    pub(super) fn enter(&mut self, number: i64) -> bool {
        if self.holds(number) {
            self.repeated += 1;
            return false;
        }
        if number > self.highest {
            if number > self.highest + 1 {
                self.gaps.insert(self.highest + 1, number - 1);
            }
            self.highest = number;
        } else if let Some((start, end)) = self.gap_of(number) {
            self.gaps.remove(&start);
            if start < number {
                self.gaps.insert(start, number - 1);
            }
            if number < end {
                self.gaps.insert(number + 1, end);
            }
        }
        self.first = Some(self.first.map_or(number, |f| f.min(number)));
        self.held += 1;
        true
    }

    fn gap_of(&self, number: i64) -> Option<(i64, i64)> {
        let (start, end) = self.gaps.range(..=number).next_back()?;
        (number <= *end).then_some((*start, *end))
    }

    pub(super) fn highest(&self) -> i64 {
        self.highest
    }

    pub(super) fn first(&self) -> Option<i64> {
        self.first
    }

    pub(super) fn held(&self) -> u64 {
        self.held
    }

    pub(super) fn repeated(&self) -> u64 {
        self.repeated
    }

    pub(super) fn gaps(&self) -> impl Iterator<Item = (i64, i64)> + '_ {
        self.gaps.iter().map(|(a, b)| (*a, *b))
    }
}
