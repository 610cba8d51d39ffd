//! Sums of contact forces on grains, in an order that the number of threads does not change.
//!
//! The force on a grain is the sum over the pairs of its own chunk, plus that over the pairs of earlier chunks of its part,
//! plus those over the pairs of each earlier part. Each sum runs in the order of pairs. Chunks and parts follow from the
//! number of grains alone, so no sum depends on how parts are divided among subdomains.

use super::decomposition::Subdomain;
use crate::simd::instruction_set::Simd;
use crate::simd::kernel::Kernel;
use crate::simd::simd_f64::{CHUNK_SIZE, F64x8, SimdF64, SimdRow};
use std::ops::Range;

/// Forces and torques on the grains of one subdomain.
#[derive(Clone, Debug, Default)]
pub(crate) struct ForceAccumulator {
    subdomain: Subdomain,
    /// In this order: one row for each grain of the present chunk; one for each grain of the present part; a row of zeros;
    /// then, part by part, one row for each grain of a later part that the part acts on.
    rows: Vec<F64x8>,
    /// Index of the row of zeros.
    zero: u32,
    /// First row for later parts of each part up to the last owned one, and the end.
    start: Vec<u32>,
    /// Row with the sum over earlier parts, for each owned grain.
    remote: Vec<u32>,
    /// Rows to add to those, as (row of `remote`, row), chunk by chunk.
    remote_extra: Vec<(u32, u32)>,
    /// First of `remote_extra` for each owned chunk, and the end.
    remote_extra_start: Vec<u32>,
    /// Sum over the grain's own part for each owned grain, where the grain is not moved at once.
    stored: Vec<F64x8>,
}

pub(crate) struct PartAccumulator<'a> {
    /// Rows that the pairs of a chunk add to. Those of grains are zero at the start of a chunk.
    pub(crate) rows: &'a mut [F64x8],
    /// The rows for grains of later parts.
    later: Range<usize>,
    zero: usize,
    /// Empty if the part is not owned.
    stored: &'a mut [F64x8],
    /// Row with the sum over earlier parts, for each grain of the part.
    remote: &'a [u32],
    remote_extra: &'a [(u32, u32)],
    remote_extra_start: &'a [u32],
}

impl PartAccumulator<'_> {
    /// Zeroes the rows of later parts. Call it before the first chunk.
    pub(crate) fn begin(&mut self) {
        self.rows[self.later.clone()].fill(F64x8::default());
    }

    /// Discards the forces on the grains of the part itself. Call it after the last chunk of a part that is not owned.
    pub(crate) fn discard_own(&mut self) {
        self.rows[..CHUNK_SIZE].fill(F64x8::default());
    }

    /// Ends chunk `c` of the part: stores the forces on its grains.
    pub(crate) fn store(&mut self, c: usize, simd: Simd) {
        let range = self.grains(c);
        let (chunk, part) = self.rows.split_at_mut(CHUNK_SIZE);
        let (chunk, part) = (&mut chunk[..range.len()], &mut part[range.clone()]);
        simd.run(StoreChunk { chunk, part, stored: &mut self.stored[range] });
    }

    /// Ends chunk `c` of the part: the forces on its grains, to be read once. Earlier parts must be complete.
    pub(crate) fn take(&mut self, c: usize) -> TakenForces<'_> {
        let range = self.grains(c);
        self.add_remote(c);
        let (rows, remote) = self.rows.split_at_mut(self.zero);
        let (chunk, part) = rows.split_at_mut(CHUNK_SIZE);
        let remote = RemoteSums { rows: remote, zero: self.zero, index: &self.remote[range.clone()] };
        TakenForces { chunk: &mut chunk[..range.len()], part: &mut part[range], remote }
    }

    /// Earlier parts must be complete.
    pub(crate) fn load(&mut self, c: usize) -> StoredForces<'_> {
        let range = self.grains(c);
        self.add_remote(c);
        let remote =
            RemoteSums { rows: &self.rows[self.zero..], zero: self.zero, index: &self.remote[range.clone()] };
        StoredForces { stored: &self.stored[range], remote }
    }

    /// Adds up the sums over earlier parts for each grain of a chunk. Call it once.
    fn add_remote(&mut self, c: usize) {
        let extra = self.remote_extra_start[c] as usize..self.remote_extra_start[c + 1] as usize;
        for &(to, from) in &self.remote_extra[extra] {
            let from = self.rows[from as usize].0;
            self.rows[to as usize].0.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        }
    }

    /// Grains of chunk `c`, counted from the first of the part.
    fn grains(&self, c: usize) -> Range<usize> {
        c * CHUNK_SIZE..((c + 1) * CHUNK_SIZE).min(self.stored.len())
    }
}

impl ForceAccumulator {
    /// Earlier parts must be complete.
    pub(crate) fn part_mut(&mut self, part: usize) -> PartAccumulator<'_> {
        // Nothing is stored for parts that are not owned.
        let owned = self.subdomain.parts().contains(&part);
        let (grains, chunk) = (self.subdomain.grains_of(part), self.subdomain.chunks_of(part).start);
        let (first, first_chunk) = (self.subdomain.grains().start, self.subdomain.chunks().start);
        let grains = if owned { grains.start - first..grains.end - first } else { 0..0 };
        PartAccumulator {
            rows: &mut self.rows,
            later: self.start[part] as usize..self.start[part + 1] as usize,
            zero: self.zero as usize,
            stored: &mut self.stored[grains.clone()],
            remote: &self.remote[grains],
            remote_extra: &self.remote_extra,
            remote_extra_start: if owned { &self.remote_extra_start[chunk - first_chunk..] } else { &[] },
        }
    }

    pub(crate) fn chunks(&self) -> impl Iterator<Item = StoredForces<'_>> {
        let zero = self.zero as usize;
        let chunks = self.stored.chunks(CHUNK_SIZE).zip(self.remote.chunks(CHUNK_SIZE));
        chunks.map(move |(stored, index)| StoredForces {
            stored,
            remote: RemoteSums { rows: &self.rows[zero..], zero, index },
        })
    }
}

pub(crate) trait ChunkForces {
    /// Force and torque on grain `k` of the chunk. Each grain is asked for once.
    fn on<R: SimdRow>(&mut self, k: usize) -> [R; 2];
}

/// The sums over earlier parts, for the grains of a chunk.
#[derive(Clone, Copy)]
struct RemoteSums<'a> {
    /// Rows from the zero on.
    rows: &'a [F64x8],
    zero: usize,
    index: &'a [u32],
}

impl RemoteSums<'_> {
    #[inline(always)]
    fn add<R: SimdRow>(&self, k: usize, [force, torque]: [R; 2]) -> [R; 2] {
        let row = &self.rows[self.index[k] as usize - self.zero].0;
        [force.add(R::load(row, 0)), torque.add(R::load(row, 4))]
    }
}

/// Forces still in the rows that pairs added to. Reading leaves these rows zero.
pub(crate) struct TakenForces<'a> {
    chunk: &'a mut [F64x8],
    part: &'a mut [F64x8],
    remote: RemoteSums<'a>,
}

impl ChunkForces for TakenForces<'_> {
    #[inline(always)]
    fn on<R: SimdRow>(&mut self, k: usize) -> [R; 2] {
        self.remote.add(k, take_sum(&mut self.chunk[k].0, &mut self.part[k].0))
    }
}

#[derive(Clone, Copy)]
pub(crate) struct StoredForces<'a> {
    stored: &'a [F64x8],
    remote: RemoteSums<'a>,
}

impl ChunkForces for StoredForces<'_> {
    #[inline(always)]
    fn on<R: SimdRow>(&mut self, k: usize) -> [R; 2] {
        let row = &self.stored[k].0;
        self.remote.add(k, [R::load(row, 0), R::load(row, 4)])
    }
}

/// The sum of two rows, which are left zero.
#[inline(always)]
fn take_sum<R: SimdRow>(chunk: &mut [f64; 8], part: &mut [f64; 8]) -> [R; 2] {
    let sum = [R::load(chunk, 0).add(R::load(part, 0)), R::load(chunk, 4).add(R::load(part, 4))];
    for at in [0, 4] {
        R::splat(0.0).store(chunk, at);
        R::splat(0.0).store(part, at);
    }
    sum
}

struct StoreChunk<'a> {
    chunk: &'a mut [F64x8],
    part: &'a mut [F64x8],
    stored: &'a mut [F64x8],
}

impl Kernel for StoreChunk<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: SimdF64>(self) {
        for ((chunk, part), stored) in self.chunk.iter_mut().zip(self.part).zip(self.stored) {
            let [force, torque] = take_sum::<L::Row>(&mut chunk.0, &mut part.0);
            force.store(&mut stored.0, 0);
            torque.store(&mut stored.0, 4);
        }
    }
}

/// Builds a [`ForceAccumulator`] as pairs come in order.
#[derive(Debug)]
pub(crate) struct AccumulatorBuilder {
    accumulator: ForceAccumulator,
    pub(crate) grains: Range<usize>,
    /// Grains of the present part.
    part: Range<usize>,
    rows: u32,
    /// Row of each grain of a later part; below the rows of the present part while the grain has no row of that part.
    row_of: Vec<u32>,
    /// (chunk, grain, row) of owned grains that earlier parts act on.
    remote: Vec<(u32, u32, u32)>,
}

impl AccumulatorBuilder {
    /// For a subdomain of so many grains in all.
    pub(crate) fn new(subdomain: Subdomain, grains: usize) -> Self {
        let largest = subdomain.parts().map(|p| subdomain.grains_of(p).len()).max().unwrap_or(0);
        let zero = (CHUNK_SIZE + largest) as u32;
        let row_of = vec![zero; grains];
        Self {
            grains: subdomain.grains(),
            accumulator: ForceAccumulator { subdomain, zero, ..ForceAccumulator::default() },
            part: 0..0,
            rows: zero + 1,
            row_of,
            remote: Vec::new(),
        }
    }

    /// Row that sums the forces of the next pair, of chunk `chunk`, on grain `j`.
    pub(crate) fn row(&mut self, chunk: usize, j: usize) -> u32 {
        let part = self.accumulator.subdomain.part_of(chunk);
        self.begin_parts(part);
        if j / CHUNK_SIZE == chunk {
            return (j % CHUNK_SIZE) as u32;
        }
        if self.part.contains(&j) {
            return (CHUNK_SIZE + j - self.part.start) as u32;
        }
        if self.row_of[j] < self.accumulator.start[part] {
            self.row_of[j] = self.rows;
            if self.grains.contains(&j) {
                self.remote.push(((j / CHUNK_SIZE) as u32, j as u32, self.rows));
            }
            self.rows += 1;
        }
        self.row_of[j]
    }

    /// Begins all parts up to this one.
    fn begin_parts(&mut self, part: usize) {
        while self.accumulator.start.len() <= part {
            self.part = self.accumulator.subdomain.grains_of(self.accumulator.start.len());
            self.accumulator.start.push(self.rows);
        }
    }

    pub(crate) fn finish(mut self) -> ForceAccumulator {
        self.begin_parts(self.accumulator.subdomain.parts().end - 1);
        let mut accumulator = self.accumulator;
        accumulator.start.push(self.rows);
        accumulator.remote = vec![accumulator.zero; self.grains.len()];
        let first = accumulator.subdomain.chunks().start;
        // The rows of a grain ascend with the parts that they sum over.
        self.remote.sort_unstable();
        for &(chunk, grain, row) in &self.remote {
            let extra = accumulator.remote_extra.len() as u32;
            accumulator.remote_extra_start.resize(chunk as usize - first + 1, extra);
            match &mut accumulator.remote[grain as usize - self.grains.start] {
                first if *first == accumulator.zero => *first = row,
                first => accumulator.remote_extra.push((*first, row)),
            }
        }
        let extra = accumulator.remote_extra.len() as u32;
        accumulator.remote_extra_start.resize(accumulator.subdomain.chunks().len() + 1, extra);
        accumulator.rows = vec![F64x8::default(); self.rows as usize];
        accumulator.stored = vec![F64x8::default(); self.grains.len()];
        accumulator
    }
}
