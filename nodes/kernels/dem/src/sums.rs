//! Where the forces of contacts come together on grains.
//!
//! Chunks of grains make up parts, and a thread has some parts for its own. What acts on a grain is the sum over
//! the pairs of its own chunk, plus that over the pairs of earlier chunks of its part, plus those over the pairs of each
//! earlier part, all in the order of pairs. Nothing in that depends on how parts are shared out among threads.

use crate::lanes::{CHUNK, Lanes, Octad, Row};
use crate::own::Own;
use crate::simd::{Kernel, Simd};
use std::ops::Range;

/// Forces and torques on the grains of some parts: its own.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sums {
    own: Own,
    /// Rows for the chunk at work; a row for each grain of the part at work; a zero; then of each part a row for each grain
    /// of a later part that it acts on.
    rows: Vec<Octad>,
    /// Which row is the zero.
    zero: u32,
    /// First row of each part up to the last own one, and the end.
    start: Vec<u32>,
    /// Row that sums what earlier parts do to each own grain.
    far: Vec<u32>,
    /// Rows to add to those: (row of `far`, row), chunk by chunk.
    more: Vec<(u32, u32)>,
    /// First of `more` of each own chunk, and the end.
    more_start: Vec<u32>,
    /// What the part of each own grain does to it, where it was not moved at once.
    total: Vec<Octad>,
}

/// The sums of one part.
pub(crate) struct PartSums<'a> {
    /// Of all parts.
    rows: &'a mut [Octad],
    /// Where the rows for grains of later parts are.
    later: Range<usize>,
    zero: usize,
    /// Empty if the part is not an own one.
    total: &'a mut [Octad],
    /// What earlier parts do to it.
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
        self.rows[self.later.clone()].fill(Octad::default());
    }

    /// Drops what acts on the grains of the part itself: after the last chunk of one that is not an own one.
    pub(crate) fn drop_own(&mut self) {
        self.rows[..CHUNK].fill(Octad::default());
    }

    /// Ends the pass of chunk `c` of the part: what acts on its grains is put down.
    pub(crate) fn end(&mut self, c: usize, simd: Simd) {
        let range = self.grains(c);
        let (own, early) = self.rows.split_at_mut(CHUNK);
        let (own, early) = (&mut own[..range.len()], &mut early[range.clone()]);
        simd.run(Settle { own, early, total: &mut self.total[range] });
    }

    /// Ends the pass of chunk `c` of the part, where earlier parts were passed: what acts on its grains, to be taken once.
    pub(crate) fn take(&mut self, c: usize) -> Taken<'_> {
        let range = self.grains(c);
        self.join(c);
        let (rows, far) = self.rows.split_at_mut(self.zero);
        let (own, early) = rows.split_at_mut(CHUNK);
        let far = Far { rows: far, zero: self.zero, of: &self.far[range.clone()] };
        Taken { own: &mut own[..range.len()], early: &mut early[range], far }
    }

    /// The same for a chunk that was put down.
    pub(crate) fn ended(&mut self, c: usize) -> Put<'_> {
        let range = self.grains(c);
        self.join(c);
        let far = Far { rows: &self.rows[self.zero..], zero: self.zero, of: &self.far[range.clone()] };
        Put { total: &self.total[range], far }
    }

    /// Adds up what earlier parts do to each grain of a chunk: once.
    fn join(&mut self, c: usize) {
        for &(to, from) in &self.more[self.more_start[c] as usize..self.more_start[c + 1] as usize] {
            let from = self.rows[from as usize].0;
            self.rows[to as usize].0.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        }
    }

    /// Grains of chunk `c`, counted from the first of the part.
    fn grains(&self, c: usize) -> Range<usize> {
        c * CHUNK..((c + 1) * CHUNK).min(self.total.len())
    }
}

impl Sums {
    /// One part; earlier ones must have been passed.
    pub(crate) fn part_mut(&mut self, part: usize) -> PartSums<'_> {
        // Of those that are not own ones nothing is put down.
        let own = self.own.parts().contains(&part);
        let (grains, chunk) = (self.own.grains_of(part), self.own.chunks_of(part).start);
        let (first, first_chunk) = (self.own.grains().start, self.own.chunks().start);
        let grains = if own { grains.start - first..grains.end - first } else { 0..0 };
        PartSums {
            rows: &mut self.rows,
            later: self.start[part] as usize..self.start[part + 1] as usize,
            zero: self.zero as usize,
            total: &mut self.total[grains.clone()],
            far: &self.far[grains],
            more: &self.more,
            more_start: if own { &self.more_start[chunk - first_chunk..] } else { &[] },
        }
    }

    /// What was put down for each own chunk.
    pub(crate) fn chunks(&self) -> impl Iterator<Item = Put<'_>> {
        let zero = self.zero as usize;
        let chunks = self.total.chunks(CHUNK).zip(self.far.chunks(CHUNK));
        chunks.map(move |(total, of)| Put { total, far: Far { rows: &self.rows[zero..], zero, of } })
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
    /// Rows from the zero on.
    rows: &'a [Octad],
    zero: usize,
    of: &'a [u32],
}

impl Far<'_> {
    #[inline(always)]
    fn add<R: Row>(&self, k: usize, [force, torque]: [R; 2]) -> [R; 2] {
        let row = &self.rows[self.of[k] as usize - self.zero].0;
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
    /// Own grains.
    grains: Range<usize>,
    /// Those of the present part.
    part: Range<usize>,
    rows: u32,
    /// Row of each grain of a later part; below those of the present part if it has none yet.
    row_of: Vec<u32>,
    /// (chunk, grain, row), of own grains.
    far: Vec<(u32, u32, u32)>,
}

impl Layout {
    /// For the parts `own` of so many grains.
    pub(crate) fn new(own: Own, grains: usize) -> Self {
        let largest = own.parts().map(|p| own.grains_of(p).len()).max().unwrap_or(0);
        let zero = (CHUNK + largest) as u32;
        let (row_of, far) = (vec![zero; grains], Vec::new());
        let grains = own.grains();
        Self { sums: Sums { own, zero, ..Sums::default() }, grains, part: 0..0, rows: zero + 1, row_of, far }
    }

    /// Own grains.
    pub(crate) fn grains(&self) -> Range<usize> {
        self.grains.clone()
    }

    /// Row that sums what the next pair, of chunk `chunk`, does to grain `j`.
    pub(crate) fn row(&mut self, chunk: usize, j: usize) -> u32 {
        let part = self.sums.own.part_of(chunk);
        self.begin(part);
        if j / CHUNK == chunk {
            return (j % CHUNK) as u32;
        }
        if self.part.contains(&j) {
            return (CHUNK + j - self.part.start) as u32;
        }
        if self.row_of[j] < self.sums.start[part] {
            self.row_of[j] = self.rows;
            if self.grains.contains(&j) {
                self.far.push(((j / CHUNK) as u32, j as u32, self.rows));
            }
            self.rows += 1;
        }
        self.row_of[j]
    }

    /// Begins parts up to this one.
    fn begin(&mut self, part: usize) {
        while self.sums.start.len() <= part {
            self.part = self.sums.own.grains_of(self.sums.start.len());
            self.sums.start.push(self.rows);
        }
    }

    /// The sums, all zero.
    pub(crate) fn finish(mut self) -> Sums {
        self.begin(self.sums.own.parts().end - 1);
        let mut sums = self.sums;
        sums.start.push(self.rows);
        sums.far = vec![sums.zero; self.grains.len()];
        let first = sums.own.chunks().start;
        // Rows of a grain ascend with the parts that they are of.
        self.far.sort_unstable();
        for &(chunk, grain, row) in &self.far {
            sums.more_start.resize(chunk as usize - first + 1, sums.more.len() as u32);
            match &mut sums.far[grain as usize - self.grains.start] {
                first if *first == sums.zero => *first = row,
                first => sums.more.push((*first, row)),
            }
        }
        sums.more_start.resize(sums.own.chunks().len() + 1, sums.more.len() as u32);
        sums.rows = vec![Octad::default(); self.rows as usize];
        sums.total = vec![Octad::default(); self.grains.len()];
        sums
    }
}
