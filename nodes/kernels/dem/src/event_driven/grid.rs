//! Which grains are near: cells of at least one diameter, each with a chain of the grains in it.

use super::pair::Grain;
use grains::Vec3;

/// The end of a chain.
pub(super) const NONE: u32 = u32::MAX;

/// A cell next to another along one axis: its index there, and the cell vectors to add to what is in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    pub(super) index: u32,
    pub(super) shift: i8,
}

#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Cells along each axis.
    count: [usize; 3],
    width: [f64; 3],
    /// Per axis and index: the cell before, itself, the cell after.
    around: [Vec<[Neighbour; 3]>; 3],
    head: Vec<u32>,
    next: Vec<u32>,
    previous: Vec<u32>,
    /// Index of each grain's cell along each axis.
    home: Vec<[u32; 3]>,
}

impl Grid {
    /// Cells at least `reach` wide, and no more of them than grains.
    pub(super) fn new(edges: Vec3, reach: f64, grains: usize) -> Self {
        let most = (grains as f64).cbrt().ceil().max(1.0);
        let count: [usize; 3] = std::array::from_fn(|k| (edges[k] / reach).floor().clamp(1.0, most) as usize);
        let around = count.map(|n| {
            let wrap = |index: usize| {
                let before = if index == 0 { (n - 1, -1) } else { (index - 1, 0) };
                let after = if index + 1 == n { (0, 1) } else { (index + 1, 0) };
                [before, (index, 0), after].map(|(i, shift)| Neighbour { index: i as u32, shift })
            };
            (0..n).map(wrap).collect()
        });
        Self {
            width: std::array::from_fn(|k| edges[k] / count[k] as f64),
            head: vec![NONE; count.iter().product()],
            next: vec![NONE; grains],
            previous: vec![NONE; grains],
            home: vec![[0; 3]; grains],
            count,
            around,
        }
    }

    /// The cell that holds `x`, a place folded into the periodic cell.
    pub(super) fn cell_of(&self, x: &[f64; 3]) -> [u32; 3] {
        std::array::from_fn(|k| ((x[k] / self.width[k]) as usize).min(self.count[k] - 1) as u32)
    }

    #[inline(always)]
    pub(super) fn flat(&self, cell: [u32; 3]) -> usize {
        (cell[0] as usize * self.count[1] + cell[1] as usize) * self.count[2] + cell[2] as usize
    }

    pub(super) fn insert(&mut self, grain: usize, cell: [u32; 3]) {
        let flat = self.flat(cell);
        let head = self.head[flat];
        self.home[grain] = cell;
        self.next[grain] = head;
        self.previous[grain] = NONE;
        if head != NONE {
            self.previous[head as usize] = grain as u32;
        }
        self.head[flat] = grain as u32;
    }

    fn remove(&mut self, grain: usize) {
        let (previous, next) = (self.previous[grain], self.next[grain]);
        if previous == NONE {
            let flat = self.flat(self.home[grain]);
            self.head[flat] = next;
        } else {
            self.next[previous as usize] = next;
        }
        if next != NONE {
            self.previous[next as usize] = previous;
        }
    }

    /// Moves a grain into the next cell along `axis`; returns the cell vector it crossed, if it left the periodic cell.
    pub(super) fn cross(&mut self, grain: usize, axis: usize, forward: bool) -> i8 {
        self.remove(grain);
        let mut cell = self.home[grain];
        let to = self.around[axis][cell[axis] as usize][if forward { 2 } else { 0 }];
        cell[axis] = to.index;
        self.insert(grain, cell);
        to.shift
    }

    /// When a grain leaves its cell, along which axis, and whether forwards.
    #[inline]
    pub(super) fn leaving(&self, grain: usize, g: &Grain) -> (f64, usize, bool) {
        let mut first = (f64::INFINITY, 0, false);
        for k in 0..3 {
            let v = g.v[k];
            if v == 0.0 {
                continue;
            }
            let index = self.home[grain][k] as f64 + if v > 0.0 { 1.0 } else { 0.0 };
            let time = g.time + ((index * self.width[k] - g.x[k]) / v).max(0.0);
            if time < first.0 {
                first = (time, k, v > 0.0);
            }
        }
        first
    }

    /// The cells around a grain's along one axis.
    #[inline(always)]
    pub(super) fn around(&self, grain: usize, axis: usize) -> &[Neighbour; 3] {
        &self.around[axis][self.home[grain][axis] as usize]
    }

    /// The first grain of a cell's chain.
    #[inline(always)]
    pub(super) fn first(&self, flat: usize) -> u32 {
        self.head[flat]
    }

    /// The grain after `grain` in its chain.
    #[inline(always)]
    pub(super) fn next(&self, grain: u32) -> u32 {
        self.next[grain as usize]
    }
}
