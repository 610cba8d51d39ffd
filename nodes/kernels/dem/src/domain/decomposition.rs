//! Division of grains: into chunks, chunks into parts, and parts among the subdomains of the threads.
//!
//! Chunks and parts depend on the number of grains alone, because they fix the order of sums. How parts are divided among
//! subdomains is free.

use crate::simd::simd_f64::CHUNK_SIZE;
use std::ops::Range;

/// Smallest number of chunks in a part, where there is more than one part. Smaller parts would need more sums for grains of
/// other parts.
const MIN_CHUNKS_PER_PART: usize = 4;

/// The grains of one subdomain: some consecutive parts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Subdomain {
    parts: Range<usize>,
    total_parts: usize,
    total_chunks: usize,
    total_grains: usize,
}

impl Subdomain {
    pub(crate) fn whole(grains: usize) -> Self {
        let chunks = grains.div_ceil(CHUNK_SIZE);
        // Two, three, four or six threads get equal numbers of parts.
        let parts = match chunks / MIN_CHUNKS_PER_PART {
            0 | 1 => 1,
            2 | 3 => 2,
            4 | 5 => 4,
            6 | 7 => 6,
            8..12 => 8,
            many => many - many % 12,
        };
        Self { parts: 0..parts, total_parts: parts, total_chunks: chunks, total_grains: grains }
    }

    /// One subdomain per thread, if there are enough parts.
    pub(crate) fn split(grains: usize, threads: usize) -> impl ExactSizeIterator<Item = Self> {
        let whole = Self::whole(grains);
        let count = threads.clamp(1, whole.total_parts);
        let first = move |k, parts| k * parts / count;
        (0..count).map(move |k| Self {
            parts: first(k, whole.total_parts)..first(k + 1, whole.total_parts),
            ..whole.clone()
        })
    }

    pub(crate) fn parts(&self) -> Range<usize> {
        self.parts.clone()
    }

    pub(crate) fn chunks(&self) -> Range<usize> {
        self.chunks_of(self.parts.start).start..self.chunks_of(self.parts.end - 1).end
    }

    pub(crate) fn grains(&self) -> Range<usize> {
        self.grains_of(self.parts.start).start..self.grains_of(self.parts.end - 1).end
    }

    pub(crate) fn part_of(&self, chunk: usize) -> usize {
        ((chunk + 1) * self.total_parts - 1) / self.total_chunks
    }

    /// The chunks of any part, of this subdomain or another.
    pub(crate) fn chunks_of(&self, part: usize) -> Range<usize> {
        let first = |part| part * self.total_chunks / self.total_parts;
        first(part)..first(part + 1)
    }

    /// The grains of any part, of this subdomain or another.
    pub(crate) fn grains_of(&self, part: usize) -> Range<usize> {
        let chunks = self.chunks_of(part);
        (chunks.start * CHUNK_SIZE).min(self.total_grains)..(chunks.end * CHUNK_SIZE).min(self.total_grains)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_grain_belongs_to_one_subdomain_whatever_the_number_of_threads() {
        for grains in [0, 1, 2, 256, 257, 1279, 2000, 4097, 8448, 12_345, 16_000, 128_001] {
            for threads in [1, 2, 3, 4, 64] {
                let subdomains: Vec<Subdomain> = Subdomain::split(grains, threads).collect();
                let owned: Vec<usize> = subdomains.iter().flat_map(Subdomain::grains).collect();
                assert!(owned.iter().copied().eq(0..grains), "{grains} grains, {threads} threads");
                let chunks: Vec<usize> = subdomains.iter().flat_map(Subdomain::chunks).collect();
                assert!(chunks.iter().copied().eq(0..grains.div_ceil(CHUNK_SIZE)));
                let parts: Vec<usize> = subdomains.iter().flat_map(Subdomain::parts).collect();
                let of_parts = parts.iter().flat_map(|p| subdomains[0].chunks_of(*p));
                assert!(of_parts.eq(chunks.iter().copied()));
                let whole = &subdomains[0];
                assert!(parts.iter().all(|p| whole.chunks_of(*p).all(|c| whole.part_of(c) == *p)));
            }
        }
    }

    #[test]
    fn useful_threads_have_about_as_many_grains_each() {
        for grains in [4000, 5000, 6000, 8448, 10_000, 12_345, 16_000, 33_333, 100_000] {
            for threads in [2, 3, 4, 6].into_iter().filter(|t| grains / t >= 2000) {
                let sizes: Vec<usize> = Subdomain::split(grains, threads).map(|s| s.grains().len()).collect();
                let mean = grains / threads;
                let most = sizes.iter().copied().fold(0, usize::max);
                assert!(sizes.len() == threads && most <= mean + mean / 4, "{sizes:?} of {grains}");
            }
        }
    }
}
