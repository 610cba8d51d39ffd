//! Where the forces of contacts come together on grains.
//!
//! Chunks of grains make up parts, and a part is what one thread works on at a time. What acts on a grain is the sum over
//! the pairs of its own chunk, plus that over the pairs of earlier chunks of its part, plus those over the pairs of each
//! earlier part, all in the order of pairs. Nothing in that depends on how many threads there are.

use crate::lanes::{CHUNK, Lanes, Octad, Row};
use crate::simd::{Kernel, Simd};
use std::ops::Range;

/// Chunks in a part. Fewer would mean more rows for grains of other parts, more would leave threads without work.
pub(crate) const PART: usize = 8;

/// Grains in a part.
const GRAINS: usize = PART * CHUNK;

/// The row that is always zero.
const ZERO: u32 = 0;

/// Forces and torques on grains.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sums {
    /// A zero; then of each part: rows for its chunk at work, a row for each of its grains, a row for each grain of a later
    /// part that it acts on.
    rows: Vec<Octad>,
    /// First row of each part, and the end.
    start: Vec<u32>,
    /// Row that sums what earlier parts do to each grain.
    far: Vec<u32>,
    /// Rows to add to those: (row of `far`, row), chunk by chunk.
    more: Vec<(u32, u32)>,
    /// First of `more` of each chunk, and the end.
    more_start: Vec<u32>,
    /// What the part of each grain does to it, where it was not moved at once.
    total: Vec<Octad>,
}

/// The sums of one part.
pub(crate) struct PartSums<'a> {
    rows: &'a mut [Octad],
    total: &'a mut [Octad],
}

/// Rows of earlier parts that were all passed.
pub(crate) struct Earlier<'a> {
    rows: &'a mut [Octad],
    far: &'a [u32],
    more: &'a [(u32, u32)],
    more_start: &'a [u32],
}

impl PartSums<'_> {
    /// The rows that pairs of a chunk add to. Those of grains are zero.
    pub(crate) fn rows(&mut self) -> &mut [Octad] {
        self.rows
    }

    /// Zeroes the rows of later parts: before the first chunk.
    pub(crate) fn begin(&mut self) {
        self.rows[CHUNK + self.total.len()..].fill(Octad::default());
    }

    /// Ends the pass of chunk `c` of the part: what acts on its grains is put down.
    pub(crate) fn end(&mut self, c: usize, simd: Simd) {
        let range = self.grains(c);
        let (own, early) = self.rows.split_at_mut(CHUNK);
        let (own, early) = (&mut own[..range.len()], &mut early[range.clone()]);
        simd.run(Settle { own, early, total: &mut self.total[range] });
    }

    /// Ends the pass of chunk `c` of the part, where earlier parts were passed: what acts on its grains, to be taken once.
    pub(crate) fn take<'s>(&'s mut self, c: usize, earlier: &'s mut Earlier<'_>) -> Taken<'s> {
        let range = self.grains(c);
        let far = earlier.join(c, range.clone());
        let (own, early) = self.rows.split_at_mut(CHUNK);
        Taken { own: &mut own[..range.len()], early: &mut early[range], far }
    }

    /// The same for a chunk that was put down.
    pub(crate) fn ended<'s>(&'s self, c: usize, earlier: &'s mut Earlier<'_>) -> Put<'s> {
        let range = self.grains(c);
        Put { total: &self.total[range.clone()], far: earlier.join(c, range) }
    }

    /// Grains of chunk `c`, counted from the first of the part.
    fn grains(&self, c: usize) -> Range<usize> {
        c * CHUNK..((c + 1) * CHUNK).min(self.total.len())
    }
}

impl Earlier<'_> {
    fn join(&mut self, c: usize, grains: Range<usize>) -> Far<'_> {
        add(self.rows, &self.more[self.more_start[c] as usize..self.more_start[c + 1] as usize]);
        Far { rows: self.rows, of: &self.far[grains] }
    }
}

impl Sums {
    /// All parts, each to pass on its own.
    pub(crate) fn parts_mut(&mut self) -> impl Iterator<Item = PartSums<'_>> {
        let mut rows = &mut self.rows[1..];
        let totals = self.total.chunks_mut(GRAINS);
        self.start.windows(2).zip(totals).map(move |(s, total)| {
            let (first, after) = std::mem::take(&mut rows).split_at_mut((s[1] - s[0]) as usize);
            rows = after;
            PartSums { rows: first, total }
        })
    }

    /// One part, and what earlier ones did.
    pub(crate) fn part_mut(&mut self, part: usize) -> (PartSums<'_>, Earlier<'_>) {
        let grains = part * GRAINS..((part + 1) * GRAINS).min(self.total.len());
        let (lower, rows) = self.rows.split_at_mut(self.start[part] as usize);
        let count = (self.start[part + 1] - self.start[part]) as usize;
        let earlier = Earlier {
            rows: lower,
            far: &self.far[grains.clone()],
            more: &self.more,
            more_start: &self.more_start[part * PART..],
        };
        (PartSums { rows: &mut rows[..count], total: &mut self.total[grains] }, earlier)
    }

    /// Adds up what several parts did to one grain: once, when all were passed.
    pub(crate) fn join(&mut self) {
        add(&mut self.rows, &self.more);
    }

    /// What acts on each chunk, joined.
    pub(crate) fn chunks(&self) -> impl Iterator<Item = Put<'_>> {
        let chunks = self.total.chunks(CHUNK).zip(self.far.chunks(CHUNK));
        chunks.map(|(total, of)| Put { total, far: Far { rows: &self.rows, of } })
    }
}

/// Adds rows to others.
fn add(rows: &mut [Octad], more: &[(u32, u32)]) {
    for &(to, from) in more {
        let from = rows[from as usize].0;
        rows[to as usize].0.iter_mut().zip(from).for_each(|(to, from)| *to += from);
    }
}

/// What acts on the grains of a chunk.
pub(crate) trait Act {
    /// Force and torque on grain `k` of the chunk: once.
    fn on<R: Row>(&mut self, k: usize) -> [R; 2];
}

/// What earlier parts do to the grains of a chunk.
#[derive(Clone, Copy)]
struct Far<'a> {
    rows: &'a [Octad],
    of: &'a [u32],
}

impl Far<'_> {
    #[inline(always)]
    fn add<R: Row>(&self, k: usize, [force, torque]: [R; 2]) -> [R; 2] {
        let row = &self.rows[self.of[k] as usize].0;
        [force.add(R::load(row, 0)), torque.add(R::load(row, 4))]
    }
}

/// Still where pairs added to it, in two parts that are left zero.
pub(crate) struct Taken<'a> {
    own: &'a mut [Octad],
    early: &'a mut [Octad],
    far: Far<'a>,
}

impl Act for Taken<'_> {
    #[inline(always)]
    fn on<R: Row>(&mut self, k: usize) -> [R; 2] {
        self.far.add(k, settle(&mut self.own[k].0, &mut self.early[k].0))
    }
}

/// Put down.
#[derive(Clone, Copy)]
pub(crate) struct Put<'a> {
    total: &'a [Octad],
    far: Far<'a>,
}

impl Act for Put<'_> {
    #[inline(always)]
    fn on<R: Row>(&mut self, k: usize) -> [R; 2] {
        let row = &self.total[k].0;
        self.far.add(k, [R::load(row, 0), R::load(row, 4)])
    }
}

/// The sum of two rows, left zero.
#[inline(always)]
fn settle<R: Row>(own: &mut [f64; 8], early: &mut [f64; 8]) -> [R; 2] {
    let sum = [R::load(own, 0).add(R::load(early, 0)), R::load(own, 4).add(R::load(early, 4))];
    for at in [0, 4] {
        R::splat(0.0).store(own, at);
        R::splat(0.0).store(early, at);
    }
    sum
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
            let [force, torque] = settle::<L::Row>(&mut own.0, &mut early.0);
            force.store(&mut total.0, 0);
            torque.store(&mut total.0, 4);
        }
    }
}

/// Makes [`Sums`] as pairs come in order.
#[derive(Debug)]
pub(crate) struct Layout {
    sums: Sums,
    rows: u32,
    /// Row of each grain of a later part; below those of the present part if it has none yet.
    row_of: Vec<u32>,
    /// (chunk, grain, row).
    far: Vec<(u32, u32, u32)>,
}

impl Layout {
    pub(crate) fn new(grains: usize) -> Self {
        Self { sums: Sums::default(), rows: ZERO + 1, row_of: vec![ZERO; grains], far: Vec::new() }
    }

    /// Row, among those of its part, that sums what the next pair, of chunk `chunk`, does to grain `j`.
    pub(crate) fn row(&mut self, chunk: usize, j: usize) -> u32 {
        let part = chunk / PART;
        self.begin(part);
        let start = self.sums.start[part];
        if j / CHUNK == chunk {
            return (j % CHUNK) as u32;
        }
        if j / GRAINS == part {
            return (CHUNK + j % GRAINS) as u32;
        }
        if self.row_of[j] < start {
            self.row_of[j] = self.rows;
            self.far.push(((j / CHUNK) as u32, j as u32, self.rows));
            self.rows += 1;
        }
        self.row_of[j] - start
    }

    /// Begins parts up to this one.
    fn begin(&mut self, part: usize) {
        while self.sums.start.len() <= part {
            let first = self.sums.start.len() * GRAINS;
            self.sums.start.push(self.rows);
            self.rows += (CHUNK + GRAINS.min(self.row_of.len().saturating_sub(first))) as u32;
        }
    }

    /// The sums, all zero.
    pub(crate) fn finish(mut self) -> Sums {
        let grains = self.row_of.len();
        self.begin(grains.div_ceil(GRAINS).saturating_sub(1));
        let mut sums = self.sums;
        sums.start.push(self.rows);
        sums.far = vec![ZERO; grains];
        // Rows of a grain ascend with the parts that they are of.
        self.far.sort_unstable();
        for &(chunk, grain, row) in &self.far {
            sums.more_start.resize(chunk as usize + 1, sums.more.len() as u32);
            match &mut sums.far[grain as usize] {
                first if *first == ZERO => *first = row,
                first => sums.more.push((*first, row)),
            }
        }
        sums.more_start.resize(grains.div_ceil(CHUNK) + 1, sums.more.len() as u32);
        sums.rows = vec![Octad::default(); self.rows as usize];
        sums.total = vec![Octad::default(); grains];
        sums
    }
}
