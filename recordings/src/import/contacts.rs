//! Contacts found from positions, in a time proportional to the number of grains.

use grains::material::effective_radius;
use grains::{Cell, Contact, Material, Vec3};

/// Why contacts cannot be found. Grains are named by index.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SearchError {
    /// Two grains have the same centre.
    #[error("grains {0} and {1} have the same centre")]
    Coincident(usize, usize),
    /// The image index does not fit its 8 bits.
    #[error("grains {0} and {1} touch across more than 127 cells")]
    FarImage(usize, usize),
    /// The cell is so small, or the grains so large, that a search would not end.
    #[error(
        "the cell is too small for its grains: they fill it {solid_fraction:.3e} times over, or one is many times as wide"
    )]
    Crowded {
        /// Volume of the spheres over volume of the cell.
        solid_fraction: f64,
        /// Largest diameter, m.
        diameter: f64,
        /// Narrowest width of the cell, m.
        width: f64,
    },
}

/// Spheres of a packing fill less than the cell; overlapping ones that fill it this often are in the wrong units.
const MOST_FULL: f64 = 20.0;

/// Cells that a grain may span.
const MOST_CELLS: f64 = 16.0;

/// Pairs that may have to be looked at: about a minute.
const MOST_PAIRS: f64 = 2e10;

/// Every contact (positive overlap) of spheres of `radii` (m) at `positions` (m, folded or not) in `cell`,
/// sorted by `(i, j, image)`: Hertz normal force from the overlap, no tangential force. Contacts across
/// periodic images are found in any cell, also one so small that a grain touches an image of itself or
/// several images of another. Positions and radii must be finite and radii positive.
///
/// # Errors
/// If two centres coincide, an image is too far away to be named, or grains fill the cell many times over.
///
/// ```
/// use grains::{Cell, Material, Vec3};
/// let (cell, r) = (Cell::cube(1.0).unwrap(), [0.11, 0.11]);
/// let found = recordings::import::contacts::find(&cell, &[Vec3::zeros(), Vec3::new(0.0, 0.0, 0.8)], &r, &Material::GLASS);
/// let found = found.unwrap();
/// assert_eq!((found.len(), found[0].image), (1, [0, 0, -1]));
/// assert!((found[0].overlap - 0.02).abs() < 1e-15);
/// ```
pub fn find(
    cell: &Cell,
    positions: &[Vec3],
    radii: &[f64],
    material: &Material,
) -> Result<Vec<Contact>, SearchError> {
    let grid = Grid::new(cell, positions, radii)?;
    let mut contacts = Vec::new();
    for i in 0..positions.len() {
        grid.visit(i, |j, lattice| {
            // Each pair once; of a grain and its own images, one of each opposite two.
            if j < i || (j == i && lattice <= [0, 0, 0]) {
                return Ok(());
            }
            // Measured from positions as they are, so that `Packing::branch` gives the same number.
            let steps: [i64; 3] = std::array::from_fn(|k| lattice[k] + grid.cells[i][k] - grid.cells[j][k]);
            let image = steps.map(i8::try_from);
            let [Ok(a), Ok(b), Ok(c)] = image else {
                // Too far to be named, but only an error if the two touch.
                let shift = cell.matrix() * Vec3::new(steps[0] as f64, steps[1] as f64, steps[2] as f64);
                let touch = (positions[j] - positions[i] + shift).norm() < radii[i] + radii[j];
                return if touch { Err(SearchError::FarImage(i, j)) } else { Ok(()) };
            };
            let branch = positions[j] - positions[i] + cell.shift([a, b, c]);
            let distance = branch.norm();
            let overlap = radii[i] + radii[j] - distance;
            if overlap <= 0.0 {
                return Ok(());
            }
            if distance == 0.0 {
                return Err(SearchError::Coincident(i, j));
            }
            let r_eff = effective_radius(radii[i], radii[j]);
            contacts.push(Contact {
                i: i as u32,
                j: j as u32,
                image: [a, b, c],
                overlap,
                normal: branch / distance,
                normal_force: material.normal_force(r_eff, overlap),
                tangential_force: Vec3::zeros(),
            });
            Ok(())
        })?;
    }
    contacts.sort_by_key(|c| (c.i, c.j, c.image));
    Ok(contacts)
}

/// Grains sorted into boxes of the cell.
struct Grid {
    /// Boxes along each edge vector.
    boxes: [i64; 3],
    /// How many boxes away, along each edge vector, a touching grain may be.
    reach: [i64; 3],
    /// Which copy of the cell each grain's position lies in.
    cells: Vec<[i64; 3]>,
    /// Which box.
    homes: Vec<[i64; 3]>,
    /// Grains by box, and where each box starts.
    sorted: Vec<usize>,
    starts: Vec<usize>,
}

impl Grid {
    fn new(cell: &Cell, positions: &[Vec3], radii: &[f64]) -> Result<Self, SearchError> {
        // A little more than two radii, so that rounding cannot put touching grains out of reach.
        let cutoff = 2.0 * radii.iter().copied().fold(0.0, f64::max) * (1.0 + 1e-9);
        // No more than about four boxes a grain, however large the cell.
        let edge = cutoff.max((cell.volume() / (4.0 * positions.len().max(1) as f64)).cbrt());
        let boxes: [i64; 3] = std::array::from_fn(|k| ((cell.width(k) / edge).floor() as i64).max(1));
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
        // Counting sort: grains of a box stay in order of index.
        let mut starts = vec![0; (boxes[0] * boxes[1] * boxes[2]) as usize + 1];
        for home in &grid.homes {
            starts[grid.number(home) + 1] += 1;
        }
        for b in 1..starts.len() {
            starts[b] += starts[b - 1];
        }
        let mut next = starts.clone();
        grid.sorted = vec![0; positions.len()];
        for i in 0..positions.len() {
            let b = grid.number(&grid.homes[i]);
            grid.sorted[next[b]] = i;
            next[b] += 1;
        }
        grid.starts = starts;
        Ok(grid)
    }

    fn number(&self, home: &[i64; 3]) -> usize {
        ((home[0] * self.boxes[1] + home[1]) * self.boxes[2] + home[2]) as usize
    }

    /// Calls `each` with every grain in reach of grain `i`, and the copy of the cell in which it is seen from
    /// the home of `i`.
    fn visit<E>(&self, i: usize, mut each: impl FnMut(usize, [i64; 3]) -> Result<(), E>) -> Result<(), E> {
        let (home, r) = (self.homes[i], self.reach);
        for a in -r[0]..=r[0] {
            for b in -r[1]..=r[1] {
                for c in -r[2]..=r[2] {
                    let at = [home[0] + a, home[1] + b, home[2] + c];
                    let lattice = std::array::from_fn(|k| at[k].div_euclid(self.boxes[k]));
                    let number = self.number(&std::array::from_fn(|k| at[k].rem_euclid(self.boxes[k])));
                    for &j in &self.sorted[self.starts[number]..self.starts[number + 1]] {
                        each(j, lattice)?;
                    }
                }
            }
        }
        Ok(())
    }
}
