//! How grains are divided: into chunks, chunks into parts, and parts among threads.
//!
//! Chunks and parts follow from the number of grains alone, since the order of sums hangs on them. Who has which parts is
//! free.

use crate::lanes::CHUNK;
use std::ops::Range;

/// Chunks in a part, at least. Fewer would mean more sums for grains of other parts.
const LEAST: usize = 4;

/// Some parts of the grains: what one thread has for its own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Own {
    parts: Range<usize>,
    /// Chunks in a part, and in all.
    part: usize,
    chunks: usize,
    /// Grains in all.
    grains: usize,
}

impl Own {
    /// All of so many grains.
    pub(crate) fn all(grains: usize) -> Self {
        let chunks = grains.div_ceil(CHUNK).max(1);
        // A power of two of them, so that two, four or eight threads have as much each.
        let parts = 1 << (chunks / LEAST).max(1).ilog2();
        let part = chunks.div_ceil(parts);
        Self { parts: 0..chunks.div_ceil(part), part, chunks, grains }
    }

    /// All of so many grains, for so many threads if there are parts enough.
    pub(crate) fn shares(grains: usize, threads: usize) -> impl ExactSizeIterator<Item = Self> {
        let all = Self::all(grains);
        let (parts, count) = (all.parts.end, threads.clamp(1, all.parts.end));
        (0..count).map(move |k| Self { parts: k * parts / count..(k + 1) * parts / count, ..all.clone() })
    }

    /// The parts.
    pub(crate) fn parts(&self) -> Range<usize> {
        self.parts.clone()
    }

    /// Their chunks.
    pub(crate) fn chunks(&self) -> Range<usize> {
        self.chunks_of(self.parts.start).start..self.chunks_of(self.parts.end).start
    }

    /// Their grains.
    pub(crate) fn grains(&self) -> Range<usize> {
        self.grains_of(self.parts.start).start..self.grains_of(self.parts.end).start
    }

    /// The part of a chunk.
    pub(crate) fn part_of(&self, chunk: usize) -> usize {
        chunk / self.part
    }

    /// The chunks of a part, be it one of these or not.
    pub(crate) fn chunks_of(&self, part: usize) -> Range<usize> {
        let chunk = |part: usize| (part * self.part).min(self.chunks);
        chunk(part)..chunk(part + 1)
    }

    /// The grains of a part, be it one of these or not.
    pub(crate) fn grains_of(&self, part: usize) -> Range<usize> {
        let grain = |part: usize| (part * self.part * CHUNK).min(self.grains);
        grain(part)..grain(part + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_grain_belongs_to_one_share_whatever_the_number_of_threads() {
        for grains in [1, 2, 256, 257, 2000, 4097, 16_000, 128_001] {
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
    fn two_threads_have_about_as_many_grains_each_from_two_thousand_on() {
        for grains in [2000, 3000, 5000, 10_000, 12_345, 16_000, 100_000] {
            let sizes: Vec<usize> = Own::shares(grains, 2).map(|own| own.grains().len()).collect();
            assert!(sizes.len() == 2 && sizes[0] < sizes[1] + sizes[1] / 2, "{sizes:?} of {grains}");
        }
    }
}
