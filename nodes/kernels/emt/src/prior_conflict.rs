//! Contradictions of data and prior.

use crate::normal::chi_square_above;
use crate::prior::{Density, Prior};
use grainlab_core::notes::{Note, Status};
use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};
use nalgebra::{DMatrix, DVector};

/// Distance of a prior from the data, in standard deviations, that chance exceeds once in a thousand times.
const CONFLICT: f64 = 3.3;

/// The probability of that distance, for several quantities together.
const CHANCE: f64 = 1e-3;

/// The contradictions of a prior and the structure that the data alone give, of this covariance, and the priors of quantities
/// that the data do not determine.
pub(crate) fn notes(
    structure: &Microstructure,
    before: &MicrostructureCovariance,
    prior: &Prior,
) -> Vec<Note> {
    let mut notes = Vec::new();
    let mut known = Vec::new();
    for quantity in prior.quantities() {
        let Some(density) = prior.get(quantity) else { continue };
        let Some(value) = structure.get(quantity) else {
            notes.push(Note::prior_unused(quantity.name()));
            continue;
        };
        notes.extend(of_one(quantity, value, before[(quantity as usize, quantity as usize)], density));
        known.push((quantity as usize, value, density));
    }
    if known.len() > 1 && Status::of(&notes) != Status::Contradictory {
        notes.extend(of_all(&known, before));
    }
    notes
}

/// By the moments of both or, for a wide prior with limits, by the distance beyond the nearest limit.
fn of_one(quantity: InferredQuantity, value: f64, variance: f64, density: &Density) -> Option<Note> {
    let [mean, of_prior] = density.moments();
    let sigma = (value - mean).abs() / (variance + of_prior).sqrt();
    if sigma > CONFLICT {
        return Some(Note::prior_conflict(quantity.name(), value, mean, sigma));
    }
    let [low, high] = density.range();
    let limit = if value < low { low } else { high };
    let beyond = (low - value).max(value - high);
    // Data without an error conflict with any limit that they are beyond.
    let sigma = if beyond > 0.0 { beyond / variance.sqrt() } else { 0.0 };
    (sigma > CONFLICT).then(|| Note::prior_excludes(quantity.name(), value, limit, sigma))
}

/// Priors that are each near the data may contradict what the data say of their quantities together: k - z, for instance.
fn of_all(known: &[(usize, f64, &Density)], before: &MicrostructureCovariance) -> Option<Note> {
    let moments: Vec<[f64; 2]> = known.iter().map(|(_, _, density)| density.moments()).collect();
    let n = known.len();
    let off = DVector::from_fn(n, |i, _| known[i].1 - moments[i][0]);
    let of_prior = |i: usize, j: usize| if i == j { moments[i][1] } else { 0.0 };
    let both = DMatrix::from_fn(n, n, |i, j| before[(known[i].0, known[j].0)] + of_prior(i, j));
    let chi_square = off.dot(&both.cholesky()?.solve(&off));
    (chi_square_above(chi_square, n) < CHANCE).then(|| Note::priors_conflict(chi_square, n as f64))
}
