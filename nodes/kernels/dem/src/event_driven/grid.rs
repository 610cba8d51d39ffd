//! Which grains are near: a periodic grid of cells, each with a chain of the grains anchored in it.

use grains::Vec3;

/// No grain: the end of a chain.
pub(super) const NONE: u32 = u32::MAX;

/// Number of an image among the 27 around: 9(a + 1) + 3(b + 1) + c + 1 for the cell vectors a, b, c. That of the
/// opposite image is 26 less it.
pub(super) type Image = u8;

/// Cell vectors of an image.
pub(super) fn cell_vectors(image: Image) -> [i32; 3] {
    let image = i32::from(image);
    [image / 9 - 1, image / 3 % 3 - 1, image % 3 - 1]
}

#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Cells along each axis.
    count: [usize; 3],
    width: [f64; 3],
    head: Vec<u32>,
    next: Vec<u32>,
    previous: Vec<u32>,
    home: Vec<u32>,
}

impl Grid {
    /// Cells at least `reach` wide (m), at least one along each axis, and not many more than grains.
    pub(super) fn new(edges: Vec3, reach: f64, grains: usize) -> Self {
        let most = (grains as f64).cbrt().ceil().max(1.0);
        let count: [usize; 3] = std::array::from_fn(|k| (edges[k] / reach).floor().clamp(1.0, most) as usize);
        Self {
            width: std::array::from_fn(|k| edges[k] / count[k] as f64),
            head: vec![NONE; count.iter().product()],
            next: vec![NONE; grains],
            previous: vec![NONE; grains],
            home: vec![NONE; grains],
            count,
        }
    }

    /// The cell that holds `x`, a place folded into the periodic cell.
    pub(super) fn cell(&self, x: &[f64; 3]) -> u32 {
        self.flat(self.indices(x))
    }

    fn indices(&self, x: &[f64; 3]) -> [usize; 3] {
        std::array::from_fn(|k| ((x[k] / self.width[k]) as usize).min(self.count[k] - 1))
    }

    fn flat(&self, cell: [usize; 3]) -> u32 {
        ((cell[0] * self.count[1] + cell[1]) * self.count[2] + cell[2]) as u32
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
        let head = self.head[cell as usize];
        self.home[grain] = cell;
        self.next[grain] = head;
        self.previous[grain] = NONE;
        if head != NONE {
            self.previous[head as usize] = grain as u32;
        }
        self.head[cell as usize] = grain as u32;
    }

    fn remove(&mut self, grain: usize) {
        let (previous, next) = (self.previous[grain], self.next[grain]);
        if previous == NONE {
            self.head[self.home[grain] as usize] = next;
        } else {
            self.next[previous as usize] = next;
        }
        if next != NONE {
            self.previous[next as usize] = previous;
        }
    }

    /// Every grain listed in the 27 cells around `x`, with the image in which it is near; a small grid shows the same
    /// grain in several.
    #[inline]
    pub(super) fn around(&self, x: &[f64; 3], mut visit: impl FnMut(usize, Image)) {
        let home = self.indices(x);
        // Index and place among the images (0, 1, 2) of the cell before, this, and the one after.
        let along = |k: usize| {
            let (at, n) = (home[k], self.count[k]);
            let before = if at == 0 { (n - 1, 0) } else { (at - 1, 1) };
            let after = if at + 1 == n { (0, 2) } else { (at + 1, 1) };
            [before, (at, 1), after]
        };
        let [xs, ys, zs] = [along(0), along(1), along(2)];
        for (a, ia) in xs {
            for (b, ib) in ys {
                for (c, ic) in zs {
                    let mut grain = self.head[self.flat([a, b, c]) as usize];
                    while grain != NONE {
                        visit(grain as usize, 9 * ia + 3 * ib + ic);
                        grain = self.next[grain as usize];
                    }
                }
            }
        }
    }
}
