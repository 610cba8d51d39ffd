//! Grains sorted into boxes, so that only those nearby are compared.

use grainlab_core::{Cell, Vec3, sorted_into_bins};

use super::error::SearchError;

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

/// Grains sorted into boxes of the cell.
pub(super) struct Grid {
    /// Number of boxes along each edge vector.
    boxes: [i64; 3],
    /// Distance in boxes, along each edge vector, at which a touching grain may be.
    reach: [i64; 3],
    /// Image of the cell that contains each grain's position.
    pub(super) cells: Vec<[i64; 3]>,
    /// Box of each grain.
    homes: Vec<[i64; 3]>,
    /// Grains by box, and the start of each box.
    sorted: Vec<u32>,
    starts: Vec<u32>,
}

impl Grid {
    pub(super) fn new(cell: &Cell, positions: &[Vec3], radii: &[f64]) -> Result<Self, SearchError> {
        // Slightly more than two radii, so that rounding cannot move touching grains out of range.
        let cutoff = 2.0 * radii.iter().copied().fold(0.0, f64::max) * (1.0 + 1e-9);
        let edge = cutoff.max(least_edge(cell, positions.len()));
        let boxes: [i64; 3] =
            std::array::from_fn(|k| ((cell.width(k) / edge).floor() as i64).clamp(1, MOST_BOXES));
        let reach: [i64; 3] =
            std::array::from_fn(|k| (cutoff * boxes[k] as f64 / cell.width(k)).ceil() as i64);
        let volume: f64 = radii.iter().map(|r| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)).sum();
        let solid_fraction = volume / cell.volume();
        let width = (0..3).map(|k| cell.width(k)).fold(f64::INFINITY, f64::min);
        let product = |n: [i64; 3]| n.iter().map(|n| *n as f64).product::<f64>();
        let grains = positions.len() as f64;
        let pairs =
            grains * grains * product(reach.map(|r| r.saturating_mul(2).saturating_add(1))) / product(boxes);
        if !(solid_fraction <= MOST_FULL && cutoff <= MOST_CELLS * width && pairs <= MOST_PAIRS) {
            return Err(SearchError::Crowded { solid_fraction, diameter: cutoff, width });
        }
        let mut cells = Vec::with_capacity(positions.len());
        let mut homes = Vec::with_capacity(positions.len());
        for x in positions {
            let f = cell.fractional(x);
            let copy = [f.x.floor(), f.y.floor(), f.z.floor()];
            homes.push(std::array::from_fn(|k| {
                let inside = (f[k] - copy[k]) * boxes[k] as f64;
                (inside.floor() as i64).clamp(0, boxes[k] - 1)
            }));
            cells.push(copy.map(|c| c as i64));
        }
        let mut grid = Self { boxes, reach, cells, homes, sorted: Vec::new(), starts: Vec::new() };
        let boxes = (boxes[0] * boxes[1] * boxes[2]) as usize;
        (grid.starts, grid.sorted) = sorted_into_bins(boxes, grid.homes.iter().map(|home| grid.number(home)));
        grid.require_end()?;
        Ok(grid)
    }

    /// Refuses a search that would take too long: the estimate above assumes a uniform distribution.
    fn require_end(&self) -> Result<(), SearchError> {
        let together = self.starts.windows(2).map(|w| w[1] - w[0]).max().unwrap_or(0) as usize;
        let neighbours: f64 = self.reach.iter().map(|r| (2 * r + 1) as f64).product();
        let squares: f64 = self.starts.windows(2).map(|w| f64::from(w[1] - w[0]).powi(2)).sum();
        let pairs = squares * neighbours;
        // Uniform distributions were checked above; here many boxes are empty.
        if pairs > MOST_PAIRS && together > CLUSTER {
            return Err(SearchError::Clustered { together, pairs });
        }
        Ok(())
    }

    fn number(&self, home: &[i64; 3]) -> usize {
        ((home[0] * self.boxes[1] + home[1]) * self.boxes[2] + home[2]) as usize
    }

    /// Calls `each` with every grain in range of grain `i`, and its image of the cell relative to that of
    /// `i`.
    pub(super) fn visit<E>(
        &self,
        i: usize,
        mut each: impl FnMut(usize, [i64; 3]) -> Result<(), E>,
    ) -> Result<(), E> {
        let (home, r) = (self.homes[i], self.reach);
        for a in -r[0]..=r[0] {
            for b in -r[1]..=r[1] {
                for c in -r[2]..=r[2] {
                    let at = [home[0] + a, home[1] + b, home[2] + c];
                    let lattice = std::array::from_fn(|k| at[k].div_euclid(self.boxes[k]));
                    let number = self.number(&std::array::from_fn(|k| at[k].rem_euclid(self.boxes[k])));
                    let range = self.starts[number] as usize..self.starts[number + 1] as usize;
                    for &j in &self.sorted[range] {
                        each(j as usize, lattice)?;
                    }
                }
            }
        }
        Ok(())
    }
}
