//! Contacts that open or close while a wave passes.

use grainlab_core::{Contact, Mat3};
use grainlab_dem::Engine;
use std::collections::BTreeSet;

type Key = (u32, u32, [i8; 3]);

/// Contacts that differ from those at the start, over all comparisons.
#[derive(Clone, Debug)]
pub(crate) struct ContactChanges {
    start: BTreeSet<Key>,
    opened: BTreeSet<Key>,
    closed: BTreeSet<Key>,
}

impl ContactChanges {
    /// Takes the present contacts as the start.
    pub(crate) fn since(engine: &Engine) -> Self {
        Self { start: keys(engine), opened: BTreeSet::new(), closed: BTreeSet::new() }
    }

    /// Compares the present contacts with those at the start.
    pub(crate) fn look(&mut self, engine: &Engine) {
        let now = keys(engine);
        self.opened.extend(self.start.difference(&now));
        self.closed.extend(now.difference(&self.start));
    }

    /// Number of contacts that were missing in at least one comparison.
    pub(crate) fn opened(&self) -> u32 {
        self.opened.len() as u32
    }

    /// Number of contacts that were new in at least one comparison.
    pub(crate) fn closed(&self) -> u32 {
        self.closed.len() as u32
    }
}

fn keys(engine: &Engine) -> BTreeSet<Key> {
    let key = |c: &Contact| (c.i, c.j, c.image);
    engine.packing(Mat3::identity()).contacts.iter().map(key).collect()
}
