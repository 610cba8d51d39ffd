//! How grains are divided: into chunks, chunks into parts, and parts among threads.
//!
//! Chunks and parts follow from the number of grains alone, since the order of sums hangs on them. Who has which parts is
//! free.

use crate::lanes::CHUNK;
use std::ops::Range;

/// Chunks in a part, at least, where there is more than one. Fewer would mean more sums for grains of other parts.
const LEAST: usize = 4;

/// Some parts of the grains: what one thread has for its own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Own {
    parts: Range<usize>,
    /// Parts, chunks and grains in all.
    count: usize,
    chunks: usize,
    grains: usize,
}

impl Own {
    /// All of so many grains.
    pub(crate) fn all(grains: usize) -> Self {
        let chunks = grains.div_ceil(CHUNK);
        // So that two, three, four or six threads have as much each.
        let count = match chunks / LEAST {
            0 | 1 => 1,
            2 | 3 => 2,
            4 | 5 => 4,
            6 | 7 => 6,
            8..12 => 8,
            many => many - many % 12,
        };
        Self { parts: 0..count, count, chunks, grains }
    }

    /// All of so many grains, for so many threads if there are parts enough.
    pub(crate) fn shares(grains: usize, threads: usize) -> impl ExactSizeIterator<Item = Self> {
        let all = Self::all(grains);
        let shares = threads.clamp(1, all.count);
        let first = move |k, parts| k * parts / shares;
        (0..shares).map(move |k| Self { parts: first(k, all.count)..first(k + 1, all.count), ..all.clone() })
    }

    /// The parts.
    pub(crate) fn parts(&self) -> Range<usize> {
        self.parts.clone()
    }

    /// Their chunks.
    pub(crate) fn chunks(&self) -> Range<usize> {
        self.chunks_of(self.parts.start).start..self.chunks_of(self.parts.end - 1).end
    }

    /// Their grains.
    pub(crate) fn grains(&self) -> Range<usize> {
        self.grains_of(self.parts.start).start..self.grains_of(self.parts.end - 1).end
    }

    /// The part of a chunk.
    pub(crate) fn part_of(&self, chunk: usize) -> usize {
        ((chunk + 1) * self.count - 1) / self.chunks
    }

    /// The chunks of a part, be it one of these or not.
    pub(crate) fn chunks_of(&self, part: usize) -> Range<usize> {
        let first = |part| part * self.chunks / self.count;
        first(part)..first(part + 1)
    }

    /// The grains of a part, be it one of these or not.
    pub(crate) fn grains_of(&self, part: usize) -> Range<usize> {
        let chunks = self.chunks_of(part);
        (chunks.start * CHUNK).min(self.grains)..(chunks.end * CHUNK).min(self.grains)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_grain_belongs_to_one_share_whatever_the_number_of_threads() {
        for grains in [0, 1, 2, 256, 257, 1279, 2000, 4097, 8448, 12_345, 16_000, 128_001] {
            for threads in [1, 2, 3, 4, 64] {
                let shares: Vec<Own> = Own::shares(grains, threads).collect();
                let owned: Vec<usize> = shares.iter().flat_map(Own::grains).collect();
                assert!(owned.iter().copied().eq(0..grains), "{grains} grains, {threads} threads");
                let chunks: Vec<usize> = shares.iter().flat_map(Own::chunks).collect();
                assert!(chunks.iter().copied().eq(0..grains.div_ceil(CHUNK)));
                let parts: Vec<usize> = shares.iter().flat_map(Own::parts).collect();
                let within = parts.iter().flat_map(|p| shares[0].chunks_of(*p));
                assert!(within.eq(chunks.iter().copied()));
                assert!(parts.iter().all(|p| shares[0].chunks_of(*p).all(|c| shares[0].part_of(c) == *p)));
            }
        }
    }

    #[test]
    fn threads_that_pay_have_about_as_many_grains_each() {
        for grains in [4000, 5000, 6000, 8448, 10_000, 12_345, 16_000, 33_333, 100_000] {
            for threads in [2, 3, 4, 6].into_iter().filter(|t| grains / t >= 2000) {
                let sizes: Vec<usize> = Own::shares(grains, threads).map(|own| own.grains().len()).collect();
                let mean = grains / threads;
                let most = sizes.iter().copied().fold(0, usize::max);
                assert!(sizes.len() == threads && most <= mean + mean / 4, "{sizes:?} of {grains}");
            }
        }
    }
}
