//! Fit of the five moduli to measured speeds by the method of Levenberg and Marquardt.
//!
//! Unknowns are the specific moduli, each divided by its scale, so that they are of order one.

use super::ray::{Column, Ray, UNKNOWNS};
use nalgebra::{Const, SMatrix, SymmetricEigen};

/// Combinations of scaled moduli whose singular value is less are undetermined: speeds with errors of 0.1 % contain no
/// information about them.
const UNDETERMINED: f64 = 1e-3;

/// Singular value below which the fit is repeated from other starting points: other media may have the same speeds.
const WEAK: f64 = 0.1;

/// Distances of these starting points from the first medium, in scales of its moduli.
const OFFSETS: [f64; 4] = [-0.6, -0.3, 0.3, 0.6];

/// A 5 × 5 matrix over the scaled moduli.
pub(super) type Square = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

pub(super) struct Problem<'a> {
    rays: &'a [Ray],
    weights: &'a [f64],
    /// Scale of each specific modulus, m²/s²: the v² of P or S waves, for C13 their difference, at least 0.2 v_P².
    pub(super) scale: Column,
    guess: Column,
}

/// A medium and its response to every ray.
#[derive(Clone)]
pub(super) struct Point {
    pub(super) specific: Column,
    /// Per ray: measured minus fitted speed over the measured one, and the derivatives of fitted over measured speed
    /// with respect to each scaled modulus.
    pub(super) rows: Vec<(f64, Column)>,
    /// Per ray: cos² of the angle between the measured polarization and that of the mode.
    pub(super) shares: Vec<f64>,
    /// Weighted sum of squares.
    pub(super) cost: f64,
}

impl<'a> Problem<'a> {
    pub(super) fn new(rays: &'a [Ray], weights: &'a [f64]) -> Self {
        let mean_square = |compressional: bool| {
            let squares = rays.iter().filter(|r| r.is_compressional() == compressional);
            let (sum, count) = squares.fold((0.0, 0.0), |(s, n), r| (s + r.speed * r.speed, n + 1.0));
            (count > 0.0).then(|| sum / count)
        };
        // If there are no speeds of one kind: the ratio in isotropic packings.
        let (p, s) = match (mean_square(true), mean_square(false)) {
            (Some(p), Some(s)) => (p, s),
            (Some(p), None) => (p, p / 3.0),
            (None, s) => (3.0 * s.unwrap_or(1.0), s.unwrap_or(1.0)),
        };
        let coupling = (p - s).max(0.2 * p);
        Self {
            rays,
            weights,
            scale: Column::from([p, p, coupling, s, s]),
            guess: Column::from([p, p, coupling - s, s, s]),
        }
    }

    /// True if the sum of squares has one minimum: if the rays whose polarization does not depend on the medium determine
    /// C11, C33 and C44, or if there are no other rays. The v² of these rays is linear in the moduli, and that of the others
    /// is monotone in C13.
    pub(super) fn has_one_minimum(&self) -> bool {
        let uncoupled: Vec<(f64, Column)> =
            self.rays.iter().filter(|r| !r.is_coupled()).map(|r| (0.0, self.row_of_motion(r))).collect();
        let (basis, rank) = seen(&uncoupled);
        let is_determined =
            |modulus: usize| (rank..UNKNOWNS).all(|k| basis[(modulus, k)].abs() < UNDETERMINED);
        uncoupled.len() == self.rays.len() || [0, 1, 3].into_iter().all(is_determined)
    }

    /// Relative derivatives of a ray's speed for exactly the measured polarization.
    fn row_of_motion(&self, ray: &Ray) -> Column {
        ray.slopes_of_motion().component_mul(&self.scale) / (2.0 * ray.speed * ray.speed)
    }

    /// The solution of the linear problem, in which every mode has exactly the measured polarization, and its weighted sum
    /// of squares.
    pub(super) fn linear(&self) -> Option<(Column, f64)> {
        let rows: Vec<(f64, Column)> = (self.rays.iter())
            .map(|ray| {
                let square = ray.speed * ray.speed;
                (0.5 * (1.0 - ray.slopes_of_motion().dot(&self.guess) / square), self.row_of_motion(ray))
            })
            .collect();
        let (basis, rank) = seen(&rows);
        let step = self.step(&rows, &basis, rank, 0.0)?;
        let left = rows.iter().map(|(residual, row)| residual - row.dot(&step));
        let cost = left.zip(self.weights).map(|(left, weight)| weight * left * left).sum();
        Some((self.guess + step.component_mul(&self.scale), cost))
    }

    /// Starting points: the solution of the linear problem, then media with C11 = C33 and three values of C44.
    pub(super) fn starts(&self) -> impl Iterator<Item = Column> + '_ {
        let linear = self.linear().map(|(medium, _)| medium);
        let shears = [1.0, 0.4, 1.6].map(|shear| {
            let [p, _, coupling, s, _] = self.scale.data.0[0];
            Column::from([p, p, coupling - shear * s, shear * s, s])
        });
        linear.into_iter().chain(shears)
    }

    /// Media at some distance from `point` along the combinations of moduli that the speeds determine least: starting
    /// points for the search for other media that fit as well.
    pub(super) fn around(&self, point: &Point) -> Vec<Column> {
        let Some(eigen) = directions(&point.rows) else { return Vec::new() };
        let weak = (0..UNKNOWNS).filter(|i| eigen.eigenvalues[*i] < WEAK * WEAK);
        let combinations = weak.map(|i| eigen.eigenvectors.column(i).component_mul(&self.scale));
        combinations.flat_map(|of| OFFSETS.map(|offset| point.specific + offset * of)).collect()
    }

    fn at(&self, specific: Column) -> Option<Point> {
        if specific[2] + specific[3] <= 0.0 {
            return None;
        }
        let mut point = Point { specific, rows: Vec::new(), shares: Vec::new(), cost: 0.0 };
        for (ray, weight) in self.rays.iter().zip(self.weights) {
            let response = ray.response(&specific)?;
            let fitted = response.square.sqrt();
            let residual = 1.0 - fitted / ray.speed;
            let slopes = response.slopes.component_mul(&self.scale) / (2.0 * fitted * ray.speed);
            point.cost += weight * residual * residual;
            point.rows.push((residual, slopes));
            point.shares.push(response.share);
        }
        point.cost.is_finite().then_some(point)
    }

    /// The local minimum, searched from `start` in at most 100 iterations; `None` if `start` gives no real speed along a ray,
    /// or if the normal matrix is singular.
    pub(super) fn descend(&self, start: Column) -> Option<Point> {
        let mut here = self.at(start)?;
        let mut damping = 1e-4;
        for _ in 0..100 {
            let (basis, rank) = seen(&here.rows);
            let step = self.step(&here.rows, &basis, rank, damping)?;
            if step.amax() < 1e-13 {
                break;
            }
            let mut specific = here.specific + step.component_mul(&self.scale);
            // C13 + C44 must stay positive: a change of C13 beyond that leaves a tenth of the sum.
            let coupling = here.specific[2] + here.specific[3];
            if specific[2] + specific[3] <= 0.0 {
                specific[2] = 0.1 * coupling - specific[3];
            }
            match self.at(specific) {
                Some(next) if next.cost < here.cost => {
                    here = next;
                    damping *= 0.01;
                }
                // The step is too short, or no damping reduces the cost: its changes are due to rounding.
                _ if damping > 1e8 || step.amax() < 1e-9 => break,
                _ => damping = 10.0 * damping.max(1e-8),
            }
        }
        Some(self.refined(here))
    }

    /// At most two last steps without damping, each too short to change the cost.
    fn refined(&self, mut point: Point) -> Point {
        for _ in 0..2 {
            let (basis, rank) = seen(&point.rows);
            let step = self.step(&point.rows, &basis, rank, 0.0).filter(|step| step.amax() < 1e-6);
            let next = step.and_then(|step| self.at(point.specific + step.component_mul(&self.scale)));
            let Some(next) = next else { break };
            point = next;
        }
        point
    }

    /// Weighted least-squares step in the determined directions.
    fn step(&self, rows: &[(f64, Column)], basis: &Square, rank: usize, damping: f64) -> Option<Column> {
        let mut right = Column::zeros();
        for ((residual, row), weight) in rows.iter().zip(self.weights) {
            right += *weight * *residual * (basis.transpose() * row);
        }
        right.rows_range_mut(rank..).fill(0.0);
        let normal = self.normal(rows, basis, rank, damping);
        Some(basis * normal.cholesky()?.solve(&right))
    }

    /// Normal matrix in the basis, with ones for the undetermined directions.
    pub(super) fn normal(&self, rows: &[(f64, Column)], basis: &Square, rank: usize, damping: f64) -> Square {
        let mut normal = Square::zeros();
        for ((_, row), weight) in rows.iter().zip(self.weights) {
            let row = basis.transpose() * row;
            normal += *weight * row * row.transpose();
        }
        let damping = damping * normal.trace();
        for i in 0..UNKNOWNS {
            normal[(i, i)] += damping;
            if i >= rank {
                normal.row_mut(i).fill(0.0);
                normal.column_mut(i).fill(0.0);
                normal[(i, i)] = 1.0;
            }
        }
        normal
    }
}

/// Orthonormal directions in the space of scaled moduli, the determined ones first, and the number of those.
pub(super) fn seen(rows: &[(f64, Column)]) -> (Square, usize) {
    let Some(eigen) = directions(rows) else { return (Square::identity(), 0) };
    let is_seen = |i: &usize| eigen.eigenvalues[*i] > UNDETERMINED * UNDETERMINED;
    let first = (0..UNKNOWNS).filter(is_seen);
    let last = (0..UNKNOWNS).filter(|i| !is_seen(i));
    let mut basis = Square::zeros();
    for (to, from) in first.chain(last).enumerate() {
        basis.set_column(to, &eigen.eigenvectors.column(from));
    }
    (basis, (0..UNKNOWNS).filter(is_seen).count())
}

/// Principal directions of scaled moduli and their squared effect on the speeds; `None` if numbers overflow.
fn directions(rows: &[(f64, Column)]) -> Option<SymmetricEigen<f64, Const<UNKNOWNS>>> {
    let normal: Square = rows.iter().map(|(_, row)| row * row.transpose()).sum();
    normal.iter().all(|v| v.is_finite()).then(|| SymmetricEigen::new(normal))
}
