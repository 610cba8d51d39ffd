//! A periodic grid of cells, to find near grains.

use grainlab_core::Vec3;

pub(super) const NO_GRAIN: u32 = u32::MAX;

/// Index of one of the 27 nearest images: 9(a + 1) + 3(b + 1) + c + 1 for the cell vectors a, b, c. The opposite image has
/// index 26 − this.
pub(super) type Image = u32;

pub(super) fn cell_vectors(image: Image) -> [i32; 3] {
    let image = image as i32;
    [image / 9 - 1, image / 3 % 3 - 1, image % 3 - 1]
}

/// A grain, in one of its periodic images.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Neighbour {
    pub(super) grain: u32,
    pub(super) image: Image,
}

/// Grains copied at once, however many a cell has.
const COPY_GROUP: usize = 4;

#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Cells along each axis.
    count: [usize; 3],
    width: [f64; 3],
    /// Capacity of a cell, a multiple of [`COPY_GROUP`].
    capacity: usize,
    /// Grains, `capacity` per cell.
    members: Vec<u32>,
    /// Number of grains in each cell.
    filled: Vec<u32>,
    cell_of: Vec<u32>,
}

impl Grid {
    /// Cells at least `reach` wide (m), at least one along each axis, and not many more cells than grains.
    pub(super) fn new(edges: Vec3, reach: f64, grains: usize) -> Self {
        let limit = (grains as f64).cbrt().ceil().max(1.0);
        let count: [usize; 3] =
            std::array::from_fn(|k| (edges[k] / reach).floor().clamp(1.0, limit) as usize);
        let cells = count.iter().product();
        Self {
            width: std::array::from_fn(|k| edges[k] / count[k] as f64),
            capacity: COPY_GROUP,
            members: vec![NO_GRAIN; cells * COPY_GROUP],
            filled: vec![0; cells],
            cell_of: vec![NO_GRAIN; grains],
            count,
        }
    }

    /// The cell that contains `x`, a position folded into the periodic cell.
    pub(super) fn cell(&self, x: &[f64; 3]) -> u32 {
        self.flat(self.indices(x)) as u32
    }

    fn indices(&self, x: &[f64; 3]) -> [usize; 3] {
        std::array::from_fn(|k| ((x[k] / self.width[k]) as usize).min(self.count[k] - 1))
    }

    fn flat(&self, cell: [usize; 3]) -> usize {
        (cell[0] * self.count[1] + cell[1]) * self.count[2] + cell[2]
    }

    pub(super) fn place(&mut self, grain: usize, x: &[f64; 3]) {
        let cell = self.cell(x);
        if self.cell_of[grain] == cell {
            return;
        }
        if self.cell_of[grain] != NO_GRAIN {
            self.remove(grain);
        }
        self.cell_of[grain] = cell;
        let cell = cell as usize;
        if self.filled[cell] as usize == self.capacity {
            self.grow();
        }
        self.members[cell * self.capacity + self.filled[cell] as usize] = grain as u32;
        self.filled[cell] += 1;
    }

    fn remove(&mut self, grain: usize) {
        let cell = self.cell_of[grain] as usize;
        let last = self.filled[cell] as usize - 1;
        let row = &mut self.members[cell * self.capacity..][..=last];
        if let Some(at) = row.iter().position(|member| *member == grain as u32) {
            row[at] = row[last];
        }
        self.filled[cell] = last as u32;
    }

    /// Doubles the capacity of each cell.
    fn grow(&mut self) {
        let mut members = vec![NO_GRAIN; 2 * self.members.len()];
        for (new, old) in
            members.chunks_exact_mut(2 * self.capacity).zip(self.members.chunks_exact(self.capacity))
        {
            new[..self.capacity].copy_from_slice(old);
        }
        (self.members, self.capacity) = (members, 2 * self.capacity);
    }

    /// Every grain in the 27 cells around `x`, with the image in which it is near. In a small grid a grain may appear in several
    /// images.
    pub(super) fn around(&self, x: &[f64; 3], near: &mut Vec<Neighbour>) {
        let cell_of = self.indices(x);
        // Index and image (0, 1, 2) of the cell before, this cell, and the cell after.
        let along = |k: usize| {
            let (at, n) = (cell_of[k], self.count[k]);
            let before = if at == 0 { (n - 1, 0) } else { (at - 1, 1) };
            let after = if at + 1 == n { (0, 2) } else { (at + 1, 1) };
            [before, (at, 1), after]
        };
        let [xs, ys, zs] = [along(0), along(1), along(2)];
        near.clear();
        for (a, ia) in xs {
            for (b, ib) in ys {
                for (c, ic) in zs {
                    let (cell, image) = (self.flat([a, b, c]), 9 * ia + 3 * ib + ic);
                    let (before, filled) = (near.len(), self.filled[cell] as usize);
                    let row = &self.members[cell * self.capacity..][..self.capacity];
                    // Copying whole groups and truncating is faster than copying the exact number.
                    let (groups, _) = row.as_chunks::<COPY_GROUP>();
                    near.extend_from_slice(&groups[0].map(|grain| Neighbour { grain, image }));
                    for group in groups.iter().take(filled.div_ceil(COPY_GROUP)).skip(1) {
                        near.extend_from_slice(&group.map(|grain| Neighbour { grain, image }));
                    }
                    near.truncate(before + filled);
                }
            }
        }
    }
}
