//! The medium whose speeds are nearest to the measured ones, and which combinations of its moduli are determined.

use super::error::ChristoffelError;
use super::ray::{Column, Ray, UNKNOWNS, is_clear};
use super::search::{Point, Problem, Square, seen};

/// Relative error of speeds assumed in comparing media if no error is known.
const TYPICAL: f64 = 1e-3;

/// Difference of χ² up to which another medium fits as well as the nearest: two standard deviations.
const ALLOWED: f64 = 4.0;

/// C13 + C44 over its scale below which it cannot be distinguished from zero: speeds depend on its square.
const UNCOUPLED: f64 = 1e-2;

/// The nearest medium.
pub(super) struct Fit {
    /// Specific moduli C11, C33, C13, C44, C66, m²/s². Undetermined ones have arbitrary values.
    pub(super) specific: Column,
    /// Per speed: measured minus fitted over measured.
    pub(super) residuals: Vec<f64>,
    /// Per speed: cos² of the angle between measured and fitted polarization.
    pub(super) shares: Vec<f64>,
    /// Per speed: its leverage on the fit, from 0 to 1.
    pub(super) leverages: Vec<f64>,
    /// Per speed: change of the specific moduli by its relative error, m²/s².
    pub(super) gains: Vec<Column>,
    /// Covariance of the specific moduli for relative errors of 1 at weight 1, m⁴/s⁴.
    pub(super) covariance: Square,
    /// Changes of the specific moduli, m²/s², that the speeds do not determine: one scale along each undetermined
    /// direction, and the differences to other media that fit as well.
    pub(super) open: Vec<Column>,
    /// Scale of each specific modulus, m²/s².
    pub(super) scale: Column,
    /// Number of combinations of moduli that the speeds determine.
    pub(super) rank: usize,
}

/// Fits `rays`, each with a weight: the square of `unit` over its relative error, or 1 if no error is known.
pub(super) fn fit(rays: &[Ray], weights: &[f64], unit: Option<f64>) -> Result<Fit, ChristoffelError> {
    let problem = Problem::new(rays, weights);
    let descend = |start| problem.descend(start);
    let one_minimum = problem.has_one_minimum();
    let mut points: Vec<Point> = if one_minimum {
        problem.starts().find_map(descend).into_iter().collect()
    } else {
        problem.starts().filter_map(descend).collect()
    };
    let lowest = points.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).ok_or(ChristoffelError::NoMedium)?;
    if !one_minimum {
        let around = problem.around(lowest);
        points.extend(around.into_iter().filter_map(descend));
    }
    points.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let limit = points[0].cost + ALLOWED * unit.unwrap_or(TYPICAL).powi(2);
    points.retain(|point| point.cost <= limit);
    // Among media that fit equally well, those whose modes have the measured polarizations.
    let is_clear = |point: &Point| point.shares.iter().all(|share| is_clear(*share));
    if points.iter().any(is_clear) {
        points.retain(is_clear);
    }
    let open = points[1..].iter().map(|rival| rival.specific - points[0].specific).collect();
    Ok(finish(&problem, &points[0], open, weights))
}

fn finish(problem: &Problem<'_>, point: &Point, mut open: Vec<Column>, weights: &[f64]) -> Fit {
    let (basis, rank) = seen(&point.rows);
    let normal = problem.normal(&point.rows, &basis, rank, 0.0);
    let mut inverse = normal.cholesky().map_or_else(Square::zeros, |c| c.inverse());
    for i in rank..UNKNOWNS {
        inverse[(i, i)] = 0.0;
    }
    let relative = basis * inverse * basis.transpose();
    let scale = Square::from_diagonal(&problem.scale);
    open.extend((rank..UNKNOWNS).map(|i| scale * basis.column(i)));
    if point.specific[2] + point.specific[3] < UNCOUPLED * problem.scale[2] {
        open.push(scale * Column::ith(2, 1.0));
    }
    let leverage = |((_, row), weight): (&(f64, Column), &f64)| weight * row.dot(&(relative * row));
    let gain = |((_, row), weight): (&(f64, Column), &f64)| scale * (relative * row) * *weight;
    Fit {
        specific: point.specific,
        residuals: point.rows.iter().map(|(residual, _)| *residual).collect(),
        shares: point.shares.clone(),
        leverages: point.rows.iter().zip(weights).map(leverage).collect(),
        gains: point.rows.iter().zip(weights).map(gain).collect(),
        covariance: scale * relative * scale,
        open,
        scale: problem.scale,
        rank,
    }
}
