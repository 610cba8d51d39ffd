//! The medium whose speeds are nearest to those measured: damped Gauss-Newton on relative speeds.
//!
//! Unknowns are the specific moduli, each over a scale of its own (the ρ v² of P or S waves), so that every number here
//! is of order one.

use super::ChristoffelError;
use super::ray::{Column, Ray, UNKNOWNS};
use nalgebra::{SMatrix, SymmetricEigen};

/// A combination of relative moduli that changes no speed by more than this part of its own change is left open: speeds
/// known to 0.1 % then say nothing about it.
const BLIND: f64 = 1e-3;

/// Mean relative misfit beyond which other starts are tried.
const POOR: f64 = 1e-4;

type Square = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// The nearest medium, and what is known of it.
pub(super) struct Fit {
    /// Specific moduli C11, C33, C13, C44, C66, m²/s²; those left open are a guess.
    pub(super) specific: Column,
    /// Of every speed: measured over fitted, less 1.
    pub(super) residuals: Vec<f64>,
    /// cos² of the angle between motion measured and fitted, of every speed.
    pub(super) shares: Vec<f64>,
    /// Share of the fit that every speed decides itself, from 0 to 1.
    pub(super) leverages: Vec<f64>,
    /// Covariance of the specific moduli for errors of one relative weight unit, m⁴/s⁴.
    pub(super) covariance: Square,
    /// Directions that are open, one a column, in specific moduli changed by the whole of their scale; zero columns
    /// otherwise.
    pub(super) open: Square,
    /// Number of combinations that the speeds determine.
    pub(super) rank: usize,
}

/// Fits `rays`, each with a weight (1 over the square of its relative error, to a common factor).
pub(super) fn fit(rays: &[Ray], weights: &[f64]) -> Result<Fit, ChristoffelError> {
    let problem = Problem::new(rays, weights);
    let mut best: Option<Point> = None;
    for start in problem.starts() {
        let Some(point) = problem.descend(start) else { continue };
        let better = best.as_ref().is_none_or(|b| point.cost < b.cost);
        if better {
            best = Some(point);
        }
        let mean = best.as_ref().map(|b| (b.cost / problem.weight).sqrt());
        if mean.is_some_and(|m| m < POOR) {
            break;
        }
    }
    let point = best.ok_or(ChristoffelError::NoMedium)?;
    Ok(problem.finish(&point))
}

struct Problem<'a> {
    rays: &'a [Ray],
    weights: &'a [f64],
    /// Sum of the weights.
    weight: f64,
    scale: Column,
    guess: Column,
}

/// A medium, and what it says to every ray.
struct Point {
    specific: Column,
    /// Relative residual and relative slopes (of ln v with each modulus over its scale), one a ray.
    rows: Vec<(f64, Column)>,
    shares: Vec<f64>,
    cost: f64,
}

impl<'a> Problem<'a> {
    fn new(rays: &'a [Ray], weights: &'a [f64]) -> Self {
        let mean_square = |compressional: bool| {
            let squares = rays.iter().filter(|r| r.is_compressional() == compressional);
            let (sum, count) = squares.fold((0.0, 0.0), |(s, n), r| (s + r.speed * r.speed, n + 1.0));
            (count > 0.0).then(|| sum / count)
        };
        // Where one kind is missing: the ratio in isotropic packings.
        let (p, s) = match (mean_square(true), mean_square(false)) {
            (Some(p), Some(s)) => (p, s),
            (Some(p), None) => (p, p / 3.0),
            (None, s) => (3.0 * s.unwrap_or(1.0), s.unwrap_or(1.0)),
        };
        let coupling = (p - s).max(0.2 * p);
        Self {
            rays,
            weights,
            weight: weights.iter().sum(),
            scale: Column::from([p, p, coupling, s, s]),
            guess: Column::from([p, p, coupling - s, s, s]),
        }
    }

    /// The medium that gives each speed to exactly the motion measured, which is linear; then isotropic ones.
    fn starts(&self) -> impl Iterator<Item = Column> + '_ {
        let rows: Vec<(f64, Column)> = (self.rays.iter())
            .map(|ray| {
                let square = ray.speed * ray.speed;
                let slopes = ray.slopes_of_motion();
                let row = slopes.component_mul(&self.scale) / (2.0 * square);
                (0.5 * (1.0 - slopes.dot(&self.guess) / square), row)
            })
            .collect();
        let (basis, rank) = seen(&rows);
        let step = self.step(&rows, &basis, rank, 0.0);
        let linear = step.map(|step| self.guess + step.component_mul(&self.scale));
        let isotropic = [1.0, 0.4, 1.6, 0.15].map(|ratio| {
            let [p, _, coupling, s, _] = self.guess.data.0[0];
            let s_tried = ratio * s;
            Column::from([p, p, coupling + s - s_tried, s_tried, s])
        });
        linear.into_iter().chain(isotropic)
    }

    fn at(&self, specific: Column) -> Option<Point> {
        if specific[2] + specific[3] <= 0.0 {
            return None;
        }
        let mut point = Point { specific, rows: Vec::new(), shares: Vec::new(), cost: 0.0 };
        for (ray, weight) in self.rays.iter().zip(self.weights) {
            let answer = ray.answer(&specific)?;
            let fitted = answer.square.sqrt();
            let residual = (ray.speed - fitted) / fitted;
            let slopes = answer.slopes.component_mul(&self.scale) / (2.0 * answer.square);
            point.cost += weight * residual * residual;
            point.rows.push((residual, slopes));
            point.shares.push(answer.share);
        }
        point.cost.is_finite().then_some(point)
    }

    fn descend(&self, start: Column) -> Option<Point> {
        let mut here = self.at(start)?;
        let mut damping = 1e-4;
        for _ in 0..100 {
            let (basis, rank) = seen(&here.rows);
            let step = self.step(&here.rows, &basis, rank, damping)?;
            if step.amax() < 1e-13 {
                break;
            }
            let mut specific = here.specific + step.component_mul(&self.scale);
            // C13 + C44 = 0 is a wall; a step through it goes most of the way there.
            let coupling = here.specific[2] + here.specific[3];
            if specific[2] + specific[3] <= 0.0 {
                specific[2] = 0.1 * coupling - specific[3];
            }
            match self.at(specific) {
                Some(next) if next.cost < here.cost => {
                    here = next;
                    damping *= 0.01;
                }
                _ if damping > 1e8 => break,
                _ => damping = 10.0 * damping.max(1e-8),
            }
        }
        Some(here)
    }

    /// Weighted least squares in the directions that are seen.
    fn step(&self, rows: &[(f64, Column)], basis: &Square, rank: usize, damping: f64) -> Option<Column> {
        let mut right = Column::zeros();
        for ((residual, row), weight) in rows.iter().zip(self.weights) {
            right += *weight * *residual * (basis.transpose() * row);
        }
        right.rows_range_mut(rank..).fill(0.0);
        let normal = self.normal(rows, basis, rank, damping);
        Some(basis * normal.cholesky()?.solve(&right))
    }

    /// Normal matrix in the basis, with ones for what is not seen.
    fn normal(&self, rows: &[(f64, Column)], basis: &Square, rank: usize, damping: f64) -> Square {
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

    fn finish(&self, point: &Point) -> Fit {
        let (basis, rank) = seen(&point.rows);
        let mut inverse = self
            .normal(&point.rows, &basis, rank, 0.0)
            .cholesky()
            .map_or_else(Square::zeros, |c| c.inverse());
        let mut open = basis;
        for i in 0..UNKNOWNS {
            if i < rank {
                open.column_mut(i).fill(0.0);
            } else {
                inverse[(i, i)] = 0.0;
            }
        }
        let relative = basis * inverse * basis.transpose();
        let scale = Square::from_diagonal(&self.scale);
        Fit {
            specific: point.specific,
            residuals: point.rows.iter().map(|(residual, _)| *residual).collect(),
            shares: point.shares.clone(),
            leverages: (point.rows.iter().zip(self.weights))
                .map(|((_, row), weight)| weight * (row.transpose() * relative * row)[0])
                .collect(),
            covariance: scale * relative * scale,
            open: scale * open,
            rank,
        }
    }
}

/// Orthonormal directions of relative moduli, those first that some speed sees, and how many those are.
fn seen(rows: &[(f64, Column)]) -> (Square, usize) {
    let mut normal = Square::zeros();
    for (_, row) in rows {
        normal += row * row.transpose();
    }
    let eigen = SymmetricEigen::new(normal);
    let is_seen = |i: &usize| eigen.eigenvalues[*i] > BLIND * BLIND;
    let first = (0..UNKNOWNS).filter(is_seen);
    let last = (0..UNKNOWNS).filter(|i| !is_seen(i));
    let mut basis = Square::zeros();
    for (to, from) in first.chain(last).enumerate() {
        basis.set_column(to, &eigen.eigenvectors.column(from));
    }
    (basis, (0..UNKNOWNS).filter(is_seen).count())
}
