//! Where the forces of contacts come together on grains.
//!
//! What acts on a grain is the sum over the pairs of its own chunk, in their order, plus the sum over pairs of earlier
//! chunks, in their order. On one thread each sum has a row that all add to. Several threads must not share rows: each
//! chunk has one of its own for every pair with another chunk, and the sum is made when all are done. The bits are the
//! same.

use crate::lanes::{CHUNK, Lanes, Octad, Row};
use crate::simd::{Kernel, Simd};
use std::ops::Range;

/// Forces and torques on grains.
#[derive(Clone, Debug)]
pub(crate) enum Sums {
    /// For one thread.
    Serial(Serial),
    /// For several.
    Parallel(Parallel),
}

/// Rows for the chunk at work, then one a grain for what earlier chunks do to it: zero wherever no pass is under way.
#[derive(Clone, Debug)]
pub(crate) struct Serial {
    pub(crate) rows: Vec<Octad>,
    /// The whole, where grains were not moved at once.
    pub(crate) total: Vec<Octad>,
}

/// Rows of each chunk: its grains, then the second grain of each of its pairs with another chunk.
#[derive(Clone, Debug, Default)]
pub(crate) struct Parallel {
    pub(crate) rows: Vec<Octad>,
    /// First row of each chunk, and the end.
    pub(crate) start: Vec<u32>,
    /// What each chunk has to add from others: (row, grain within the chunk), ascending in rows.
    far: Vec<(u32, u32)>,
    /// First of `far` of each chunk, and the end.
    far_start: Vec<u32>,
    /// (chunk, row, grain), while pairs are still coming.
    coming: Vec<(u32, u32, u32)>,
}

impl Sums {
    pub(crate) fn new(grains: usize, shared: bool) -> Self {
        if shared {
            let rows = vec![Octad::default(); CHUNK.min(grains)];
            Self::Parallel(Parallel { rows, start: vec![0], ..Parallel::default() })
        } else {
            let zero = Octad::default();
            Self::Serial(Serial { rows: vec![zero; CHUNK + grains], total: vec![zero; grains] })
        }
    }

    /// Whether several threads can add at once.
    pub(crate) fn shared(&self) -> bool {
        matches!(self, Self::Parallel(_))
    }

    /// Row, among those that the chunk at work sees, that sums what its next pair does to grain `j`.
    pub(crate) fn row(&mut self, chunk: usize, j: usize) -> u32 {
        match self {
            _ if j / CHUNK == chunk => (j % CHUNK) as u32,
            Self::Serial(_) => (CHUNK + j) as u32,
            Self::Parallel(p) => {
                let row = p.rows.len() as u32;
                p.coming.push(((j / CHUNK) as u32, row, (j % CHUNK) as u32));
                p.rows.push(Octad::default());
                row - p.start[chunk]
            }
        }
    }

    /// No more pairs come from the last chunk; the next has `grains` grains.
    pub(crate) fn end_chunk(&mut self, grains: usize) {
        if let Self::Parallel(p) = self {
            p.start.push(p.rows.len() as u32);
            p.rows.resize(p.rows.len() + grains, Octad::default());
        }
    }

    /// No more pairs come.
    pub(crate) fn finish(&mut self, chunks: usize) {
        if let Self::Parallel(p) = self {
            p.coming.sort_unstable();
            p.far_start = (0..=chunks as u32).map(|c| p.coming.partition_point(|f| f.0 < c) as u32).collect();
            p.far = p.coming.drain(..).map(|f| (f.1, f.2)).collect();
        }
    }

    /// What acts on the grains `range` of chunk `c`, once all were passed; `room` is used where it has to be summed.
    pub(crate) fn total<'a>(
        &'a self,
        c: usize,
        range: Range<usize>,
        room: &'a mut Room,
        simd: Simd,
    ) -> &'a [Octad] {
        match self {
            Self::Serial(s) => &s.total[range],
            Self::Parallel(p) => {
                let total = &mut room[..range.len()];
                simd.run(Join { sums: p, chunk: c, total });
                total
            }
        }
    }
}

/// Room for a chunk.
pub(crate) type Room = [Octad; CHUNK];

impl Serial {
    /// What the chunk at work, with the grains `range`, did to itself and what earlier ones did to it: their sum is all.
    pub(crate) fn parts(&mut self, range: Range<usize>) -> (&mut [Octad], &mut [Octad]) {
        let (own, early) = self.rows.split_at_mut(CHUNK);
        (&mut own[..range.len()], &mut early[range])
    }

    /// Sums what acts on the grains `range`, when their chunk and all earlier ones were passed; leaves their rows zero.
    pub(crate) fn settle(&mut self, range: Range<usize>, simd: Simd) -> &[Octad] {
        let (own, early) = self.rows.split_at_mut(CHUNK);
        let total = &mut self.total[range.clone()];
        simd.run(Settle { own: &mut own[..range.len()], early: &mut early[range], total });
        total
    }
}

struct Settle<'a> {
    own: &'a mut [Octad],
    early: &'a mut [Octad],
    total: &'a mut [Octad],
}

impl Kernel for Settle<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        for ((own, early), total) in self.own.iter_mut().zip(self.early).zip(self.total) {
            for at in [0, 4] {
                L::Row::load(&own.0, at).add(L::Row::load(&early.0, at)).store(&mut total.0, at);
                L::Row::splat(0.0).store(&mut own.0, at);
                L::Row::splat(0.0).store(&mut early.0, at);
            }
        }
    }
}

struct Join<'a> {
    sums: &'a Parallel,
    chunk: usize,
    total: &'a mut [Octad],
}

impl Kernel for Join<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { sums, chunk, total } = self;
        total.fill(Octad::default());
        for &(row, grain) in &sums.far[sums.far_start[chunk] as usize..sums.far_start[chunk + 1] as usize] {
            let (sum, row) = (&mut total[grain as usize].0, &sums.rows[row as usize].0);
            for at in [0, 4] {
                L::Row::load(sum, at).add(L::Row::load(row, at)).store(sum, at);
            }
        }
        let start = sums.start[chunk] as usize;
        for (total, own) in total.iter_mut().zip(&sums.rows[start..]) {
            for at in [0, 4] {
                L::Row::load(&own.0, at).add(L::Row::load(&total.0, at)).store(&mut total.0, at);
            }
        }
    }
}
