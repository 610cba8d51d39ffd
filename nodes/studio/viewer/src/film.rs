//! The states of a run, few enough for a page.

use crate::encode::size;
use crate::view::View;

/// Most bytes of all states in a page.
const BYTES: usize = 2_600_000;

/// States of a run in order of time. When they become too many, every second one is left out; the last one always stays.
#[derive(Clone, Debug)]
pub struct Film {
    states: Vec<View>,
    last: Option<View>,
    /// Every state whose number is a multiple is kept.
    every: usize,
    count: usize,
    bytes: usize,
    most: usize,
}

impl Default for Film {
    fn default() -> Self {
        Self::within(BYTES)
    }
}

impl Film {
    /// Without states, for this number of bytes in a page.
    pub fn within(bytes: usize) -> Self {
        Self { states: Vec::new(), last: None, every: 1, count: 0, bytes: 0, most: bytes }
    }

    /// Adds a state.
    pub fn push(&mut self, view: View) {
        let kept = self.count.is_multiple_of(self.every);
        self.count += 1;
        if !kept {
            self.last = Some(view);
            return;
        }
        self.last = None;
        self.bytes += size(&view);
        self.states.push(view);
        while self.bytes > self.most && self.states.len() > 2 {
            self.every *= 2;
            // The newest state remains the last one of the run so far.
            if self.states.len().is_multiple_of(2) {
                self.last = self.states.pop();
            }
            self.states = self.states.drain(..).step_by(2).collect();
            self.bytes = self.states.iter().map(size).sum();
        }
    }

    /// The states for a page: those with as many grains as the last one.
    pub fn states(&self) -> Vec<&View> {
        let all: Vec<&View> = self.states.iter().chain(&self.last).collect();
        let grains = all.last().map_or(0, |v| v.grains());
        all.into_iter().filter(|v| v.grains() == grains).collect()
    }

    /// Number of states that were added.
    pub fn count(&self) -> usize {
        self.count
    }
}
