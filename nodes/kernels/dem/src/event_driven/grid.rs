//! Which grains are near: a periodic grid of cells, each with a row of the grains anchored in it.

use grainlab_core::Vec3;

/// No grain.
pub(super) const NONE: u32 = u32::MAX;

/// Number of an image among the 27 around: 9(a + 1) + 3(b + 1) + c + 1 for the cell vectors a, b, c. That of the
/// opposite image is 26 less it.
pub(super) type Image = u32;

/// Cell vectors of an image.
pub(super) fn cell_vectors(image: Image) -> [i32; 3] {
    let image = image as i32;
    [image / 9 - 1, image / 3 % 3 - 1, image % 3 - 1]
}

/// A grain, in one of its images.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Near {
    pub(super) grain: u32,
    pub(super) image: Image,
}

/// Grains copied at once, however many there are in a cell.
const COPIED: usize = 4;

#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Cells along each axis.
    count: [usize; 3],
    width: [f64; 3],
    /// Room for grains in a cell, a multiple of [`COPIED`].
    room: usize,
    /// As many a cell as there is room for.
    members: Vec<u32>,
    /// Grains in each cell.
    filled: Vec<u32>,
    home: Vec<u32>,
}

impl Grid {
    /// Cells at least `reach` wide (m), at least one along each axis, and not many more than grains.
    pub(super) fn new(edges: Vec3, reach: f64, grains: usize) -> Self {
        let most = (grains as f64).cbrt().ceil().max(1.0);
        let count: [usize; 3] = std::array::from_fn(|k| (edges[k] / reach).floor().clamp(1.0, most) as usize);
        let cells = count.iter().product();
        Self {
            width: std::array::from_fn(|k| edges[k] / count[k] as f64),
            room: COPIED,
            members: vec![NONE; cells * COPIED],
            filled: vec![0; cells],
            home: vec![NONE; grains],
            count,
        }
    }

    /// The cell that holds `x`, a place folded into the periodic cell.
    pub(super) fn cell(&self, x: &[f64; 3]) -> u32 {
        self.flat(self.indices(x)) as u32
    }

    fn indices(&self, x: &[f64; 3]) -> [usize; 3] {
        std::array::from_fn(|k| ((x[k] / self.width[k]) as usize).min(self.count[k] - 1))
    }

    fn flat(&self, cell: [usize; 3]) -> usize {
        (cell[0] * self.count[1] + cell[1]) * self.count[2] + cell[2]
    }

    /// Lists a grain in the cell that holds `x`, and nowhere else.
    pub(super) fn place(&mut self, grain: usize, x: &[f64; 3]) {
        let cell = self.cell(x);
        if self.home[grain] == cell {
            return;
        }
        if self.home[grain] != NONE {
            self.remove(grain);
        }
        self.home[grain] = cell;
        let cell = cell as usize;
        if self.filled[cell] as usize == self.room {
            self.widen();
        }
        self.members[cell * self.room + self.filled[cell] as usize] = grain as u32;
        self.filled[cell] += 1;
    }

    fn remove(&mut self, grain: usize) {
        let cell = self.home[grain] as usize;
        let last = self.filled[cell] as usize - 1;
        let row = &mut self.members[cell * self.room..][..=last];
        if let Some(at) = row.iter().position(|member| *member == grain as u32) {
            row[at] = row[last];
        }
        self.filled[cell] = last as u32;
    }

    /// Makes room for twice as many grains in each cell.
    fn widen(&mut self) {
        let mut members = vec![NONE; 2 * self.members.len()];
        for (new, old) in members.chunks_exact_mut(2 * self.room).zip(self.members.chunks_exact(self.room)) {
            new[..self.room].copy_from_slice(old);
        }
        (self.members, self.room) = (members, 2 * self.room);
    }

    /// Every grain listed in the 27 cells around `x`, with the image in which it is near; a small grid shows the same
    /// grain in several.
    pub(super) fn around(&self, x: &[f64; 3], near: &mut Vec<Near>) {
        let home = self.indices(x);
        // Index and place among the images (0, 1, 2) of the cell before, this, and the one after.
        let along = |k: usize| {
            let (at, n) = (home[k], self.count[k]);
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
                    let row = &self.members[cell * self.room..][..self.room];
                    // Some too many are copied, which is quicker than as many as there are.
                    let (groups, _) = row.as_chunks::<COPIED>();
                    near.extend_from_slice(&groups[0].map(|grain| Near { grain, image }));
                    for group in groups.iter().take(filled.div_ceil(COPIED)).skip(1) {
                        near.extend_from_slice(&group.map(|grain| Near { grain, image }));
                    }
                    near.truncate(before + filled);
                }
            }
        }
    }
}
