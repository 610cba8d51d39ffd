//! Contacts and overlaps by orientation, and A(d) fitted to them.

use super::strain_ratios::overlap_anisotropy_fit;
use grainlab_core::results::{ORIENTATION_BINS, OrientationFit, OrientationHistogram};
use grainlab_core::{Packing, Vec3};

/// Histogram over x = |n·`axis`| (a unit vector), mean overlaps by the same bins, and both fits.
pub fn orientation_histogram(packing: &Packing, axis: &Vec3) -> OrientationHistogram {
    let mut found = OrientationHistogram {
        overlap_fit: overlap_anisotropy_fit(packing, axis),
        contact_fit: orientation_fit(packing.contacts.iter().map(|c| c.normal.dot(axis))),
        ..OrientationHistogram::default()
    };
    for c in &packing.contacts {
        let bin = bin(c.normal.dot(axis));
        found.contacts[bin] += 1;
        found.overlap[bin] += c.overlap;
        found.sqrt_overlap[bin] += c.overlap.sqrt();
    }
    for bin in 0..ORIENTATION_BINS {
        let count = f64::from(found.contacts[bin].max(1));
        found.overlap[bin] /= count;
        found.sqrt_overlap[bin] /= count;
    }
    found
}

fn bin(x: f64) -> usize {
    ((x.abs() * ORIENTATION_BINS as f64) as usize).min(ORIENTATION_BINS - 1)
}

/// Maximum-likelihood ε of directions drawn from A(d) ∝ (1 − ε) + 3 ε x² (Eq. 6), from their cosines x = n·h.
///
/// The logarithm of the likelihood, Σ ln(1 + ε (3x² − 1)), is concave in ε: its one maximum on [−1/2, 1] is found by
/// Newton steps kept in a shrinking bracket. `None` without directions, or where ε changes no likelihood (x² = 1/3 for all).
/// The standard error means little if the maximum is on a bound.
pub fn orientation_fit(cosines: impl Iterator<Item = f64>) -> Option<OrientationFit> {
    let mut counts = [0u32; ORIENTATION_BINS];
    let leverage: Vec<f64> = cosines
        .inspect(|x| counts[bin(*x)] += 1)
        // A cosine of 1 + rounding must not make A negative.
        .map(|x| (3.0 * x * x - 1.0).min(2.0))
        .collect();
    // Both slopes of the logarithm of the likelihood: the score, and the observed information.
    let slopes = |eps: f64| {
        leverage.iter().fold((0.0, 0.0), |(score, information), s| {
            let share = s / (1.0 + eps * s);
            (score + share, information + share * share)
        })
    };
    if leverage.iter().map(|s| s * s).sum::<f64>() <= 1e-20 * leverage.len() as f64 {
        return None;
    }
    let (mut low, mut high) = (-0.5, 1.0);
    let mut eps = 0.0;
    if slopes(low).0 <= 0.0 {
        eps = low;
    } else if slopes(high).0 >= 0.0 {
        eps = high;
    } else {
        for _ in 0..100 {
            let (score, information) = slopes(eps);
            if score > 0.0 {
                low = eps
            } else {
                high = eps
            }
            let newton = eps + score / information;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let step = (next - eps).abs();
            eps = next;
            if step < 1e-15 {
                break;
            }
        }
    }
    let information = slopes(eps).1;
    let eps_stddev = 1.0 / information.sqrt();
    eps_stddev.is_finite().then(|| OrientationFit {
        eps,
        eps_stddev,
        chi2_per_dof: chi2_per_dof(&counts, eps),
    })
}

/// χ² of the counts against (1 − ε) Δx + ε Δ(x³) of all, over bins − 1 (the total) − 1 (ε).
fn chi2_per_dof(counts: &[u32; ORIENTATION_BINS], eps: f64) -> f64 {
    let total = f64::from(counts.iter().sum::<u32>());
    let cumulative = |x: f64| (1.0 - eps) * x + eps * x.powi(3);
    let edge = |b: usize| b as f64 / ORIENTATION_BINS as f64;
    let chi2: f64 = (0..ORIENTATION_BINS)
        .map(|b| {
            let expected = total * (cumulative(edge(b + 1)) - cumulative(edge(b)));
            (f64::from(counts[b]) - expected).powi(2) / expected
        })
        .sum();
    chi2 / (ORIENTATION_BINS - 2) as f64
}
