//! Grains sorted into boxes, so that only those nearby are compared. The size of a box follows the median
//! grain, as boxes of the largest one would contain all others.

use super::error::SearchError;
use crate::{Cell, Vec3, sorted_into_bins};

/// Maximum ratio of the volume of the spheres to that of the cell; more indicates wrong units.
const MOST_FULL: f64 = 20.0;

/// Maximum number of cells that a grain may span.
const MOST_CELLS: f64 = 16.0;

/// Maximum number of pairs to check: about a minute.
const MOST_PAIRS: f64 = 2e10;

/// Approximate number of boxes per grain, which limits the memory for empty parts of the cell.
const BOXES_A_GRAIN: f64 = 4.0;

/// Maximum number of boxes along one edge. With more, rounding of a position within the cell could exceed the
/// margin of the cutoff.
const MOST_BOXES: i64 = 1 << 20;

/// Number of grains in one box up to which there is no check for clusters.
const CLUSTER: usize = 1000;

/// Maximum edge of a box, in diameters of the median grain: most grains need only look into adjacent boxes.
const MEDIAN_DIAMETERS: f64 = 1.5;

/// Slightly more than a diameter, so that rounding cannot move touching grains out of range.
const DIAMETER: f64 = 2.0 * (1.0 + 1e-9);

/// The least edge of a box (m) for at most about four boxes per grain, in a cell of any shape: an edge
/// shorter than a box has one box, and the other edges share the allowed number.
fn least_edge(cell: &Cell, grains: usize) -> f64 {
    let mut widths: [f64; 3] = std::array::from_fn(|k| cell.width(k));
    widths.sort_by(f64::total_cmp);
    let [small, middle, large] = widths;
    let allowed = BOXES_A_GRAIN * grains.max(1) as f64;
    let one = large / allowed;
    // Roots before products: products of extreme widths overflow.
    let two = one.sqrt() * middle.sqrt();
    let three = one.cbrt() * middle.cbrt() * small.cbrt();
    one.max(two).max(three)
}

pub(super) struct Grid<'a> {
    /// Number of boxes along each edge vector.
    boxes: [i64; 3],
    /// Number of boxes in a metre, along each edge vector.
    boxes_per_m: [f64; 3],
    radii: &'a [f64],
    /// Image of the cell that contains each grain's position.
    pub(super) cells: Vec<[i64; 3]>,
    /// Box of each grain.
    homes: Vec<[i64; 3]>,
    /// Grains by box, and the start of each box.
    sorted: Vec<u32>,
    starts: Vec<u32>,
}

fn median(radii: &[f64]) -> f64 {
    let mut radii = radii.to_vec();
    let half = radii.len() / 2;
    if radii.is_empty() { 0.0 } else { *radii.select_nth_unstable_by(half, f64::total_cmp).1 }
}

impl<'a> Grid<'a> {
    pub(super) fn new(cell: &Cell, positions: &[Vec3], radii: &'a [f64]) -> Result<Self, SearchError> {
        let cutoff = DIAMETER * radii.iter().copied().fold(0.0, f64::max);
        let edge = (MEDIAN_DIAMETERS * DIAMETER * median(radii)).min(cutoff);
        let edge = edge.max(least_edge(cell, positions.len()));
        let boxes: [i64; 3] =
            std::array::from_fn(|k| ((cell.width(k) / edge).floor() as i64).clamp(1, MOST_BOXES));
        let boxes_per_m = std::array::from_fn(|k| boxes[k] as f64 / cell.width(k));
        let volume: f64 = radii.iter().map(|r| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)).sum();
        let solid_fraction = volume / cell.volume();
        let width = (0..3).map(|k| cell.width(k)).fold(f64::INFINITY, f64::min);
        let mut grid = Self {
            boxes,
            boxes_per_m,
            radii,
            cells: Vec::new(),
            homes: Vec::new(),
            sorted: Vec::new(),
            starts: Vec::new(),
        };
        let looked_into: f64 = (0..radii.len()).map(|i| grid.neighbours(i)).sum();
        let pairs = looked_into * positions.len() as f64 / boxes.iter().map(|n| *n as f64).product::<f64>();
        if !(solid_fraction <= MOST_FULL && cutoff <= MOST_CELLS * width && pairs <= MOST_PAIRS) {
            return Err(SearchError::Crowded { solid_fraction, diameter: cutoff, width });
        }
        for x in positions {
            let f = cell.fractional(x);
            let copy = [f.x.floor(), f.y.floor(), f.z.floor()];
            grid.homes.push(std::array::from_fn(|k| {
                let inside = (f[k] - copy[k]) * boxes[k] as f64;
                (inside.floor() as i64).clamp(0, boxes[k] - 1)
            }));
            grid.cells.push(copy.map(|c| c as i64));
        }
        let boxes = (boxes[0] * boxes[1] * boxes[2]) as usize;
        (grid.starts, grid.sorted) = sorted_into_bins(boxes, grid.homes.iter().map(|home| grid.number(home)));
        grid.require_end()?;
        Ok(grid)
    }

    /// Refuses a search that would take too long: the estimate above assumes a uniform distribution.
    fn require_end(&self) -> Result<(), SearchError> {
        let together = self.starts.windows(2).map(|w| w[1] - w[0]).max().unwrap_or(0) as usize;
        let in_box = |number: usize| f64::from(self.starts[number + 1] - self.starts[number]);
        let of_grain = |(i, home)| self.neighbours(i) * in_box(self.number(home));
        let pairs: f64 = self.homes.iter().enumerate().map(of_grain).sum();
        // Uniform distributions were checked above; here many boxes are empty.
        if pairs > MOST_PAIRS && together > CLUSTER {
            return Err(SearchError::Clustered { together, pairs });
        }
        Ok(())
    }

    /// Distance in boxes, along each edge vector, at which a grain that touches grain `i` and is no larger may
    /// be.
    fn reach(&self, i: usize) -> [i64; 3] {
        self.boxes_per_m.map(|boxes| (DIAMETER * self.radii[i] * boxes).ceil() as i64)
    }

    /// Number of boxes that are looked into for grain `i`.
    fn neighbours(&self, i: usize) -> f64 {
        self.reach(i).map(|r| 2.0 * r as f64 + 1.0).iter().product()
    }

    fn number(&self, home: &[i64; 3]) -> usize {
        ((home[0] * self.boxes[1] + home[1]) * self.boxes[2] + home[2]) as usize
    }

    /// Calls `each` with every grain in range of grain `i` that is smaller, or as large and not before it, and
    /// its image of the cell relative to that of `i`: so each pair is visited once.
    pub(super) fn visit<E>(
        &self,
        i: usize,
        mut each: impl FnMut(usize, [i64; 3]) -> Result<(), E>,
    ) -> Result<(), E> {
        let (home, r) = (self.homes[i], self.reach(i));
        let once = |j: usize, lattice| {
            self.radii[j] < self.radii[i] || (self.radii[j] == self.radii[i] && (j, lattice) > (i, [0; 3]))
        };
        for a in -r[0]..=r[0] {
            for b in -r[1]..=r[1] {
                for c in -r[2]..=r[2] {
                    let at = [home[0] + a, home[1] + b, home[2] + c];
                    let lattice = std::array::from_fn(|k| at[k].div_euclid(self.boxes[k]));
                    let number = self.number(&std::array::from_fn(|k| at[k].rem_euclid(self.boxes[k])));
                    let range = self.starts[number] as usize..self.starts[number + 1] as usize;
                    for &j in &self.sorted[range] {
                        if once(j as usize, lattice) {
                            each(j as usize, lattice)?;
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
