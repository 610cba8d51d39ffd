//! Values by handles that are never used again.

use std::collections::BTreeMap;

/// Values by their handles, in the order in which they were added.
pub(super) struct Handles<T> {
    values: BTreeMap<usize, T>,
    next: usize,
}

impl<T> Default for Handles<T> {
    fn default() -> Self {
        Self { values: BTreeMap::new(), next: 0 }
    }
}

impl<T> Handles<T> {
    /// The handle of the next value.
    pub(super) fn next(&self) -> usize {
        self.next
    }

    /// Adds a value; returns its handle.
    pub(super) fn add(&mut self, value: T) -> usize {
        self.values.insert(self.next, value);
        self.next += 1;
        self.next - 1
    }

    pub(super) fn get(&self, handle: usize) -> Option<&T> {
        self.values.get(&handle)
    }

    pub(super) fn get_mut(&mut self, handle: usize) -> Option<&mut T> {
        self.values.get_mut(&handle)
    }

    pub(super) fn remove(&mut self, handle: usize) -> Option<T> {
        self.values.remove(&handle)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, &T)> {
        self.values.iter().map(|(handle, value)| (*handle, value))
    }

    pub(super) fn values(&self) -> impl Iterator<Item = &T> {
        self.values.values()
    }
}
