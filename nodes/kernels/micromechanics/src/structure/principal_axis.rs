//! The principal axis of the contact fabric, and its uncertainty.
//!
//! Contacts of a jammed packing are not independent: among packings at the same stress, the fabric scatters
//! about half as much as that of as many independent contacts (with friction; less without). Blocks of a
//! packing overestimate the scatter, because stress fluctuates between blocks but not between packings.
//! [`fabric_stddev`] uses an exact consequence of equilibrium: a stress wave with wave vector k has no
//! components along k (k·σ = 0). The components of the fabric's longest waves that shear along k therefore
//! scatter as the mean fabric does among packings at one stress.

use super::deviator::from_tensor;
use crate::view::PackingView;
use grainlab_core::results::{PrincipalAxis, contact_anisotropy};
use grainlab_core::{Mat3, SymTensor, Vec3};

/// Least number of contacts for an estimate of the noise from one packing.
const FEWEST_CONTACTS: usize = 30;

/// Waves used, as integer multiples of the three reciprocal edge vectors: those with at most two of them; ±k
/// is one wave.
const WAVES: [[i32; 3]; 9] =
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]];

/// Square of |dev L| over the noise of one of its five components, above which it is an anisotropy: 5 F, with
/// F the 99 % point of an F distribution of 5 components over the 36 amplitudes that give the noise.
const SIGNIFICANT: f64 = 5.0 * 3.57;

/// Standard deviation of one component of the deviator of L (in an orthonormal basis, [`super::deviator`])
/// among packings with the same preparation and stress. `None` with fewer than 30 contacts.
///
/// Estimated over measured, for packings of 500 grains and 60 seeds: .94 ± .04 (isotropic, μ = .1), .91 ± .04
/// (the scene `demo`), 1.02 ± .04 (isotropic, frictionless), and 1.09 ± .07 for 24 isotropic ones of 2,000. A
/// single estimate has an error of 13 %. Independent contacts would give 1.8, 1.8, 2.2 and 1.9.
/// `cargo run --release -p grainlab_experiment --example fabric_noise` repeats it.
pub fn fabric_stddev(view: &PackingView<'_>, contact_fabric: &SymTensor) -> Option<f64> {
    let packing = view.packing;
    if packing.contacts.len() < FEWEST_CONTACTS {
        return None;
    }
    let mean = contact_fabric.matrix();
    let mut waves = [(Mat3::zeros(), Mat3::zeros()); WAVES.len()];
    for (c, branch) in packing.contacts.iter().zip(&view.branches) {
        let place = packing.positions[c.i as usize] + branch * 0.5;
        let fluctuation = c.normal * c.normal.transpose() - mean;
        let turns = packing.cell.fractional(&place) * std::f64::consts::TAU;
        let edges: [(f64, f64); 3] = [turns.x.sin_cos(), turns.y.sin_cos(), turns.z.sin_cos()];
        for (wave, counts) in waves.iter_mut().zip(WAVES) {
            let (sin, cos) = phase(&edges, counts);
            wave.0 += fluctuation * cos;
            wave.1 += fluctuation * sin;
        }
    }
    // Columns of the cell's matrix are the edges: reciprocal vectors are the rows of its inverse.
    let reciprocal = packing.cell.matrix().try_inverse()?.transpose();
    let mut sum = 0.0;
    for ((real, imaginary), counts) in waves.iter().zip(WAVES) {
        let k = (reciprocal * Vec3::from(counts.map(f64::from))).normalize();
        for part in [real, imaginary] {
            let along = part * k;
            sum += (along - k * k.dot(&along)).norm_squared();
        }
    }
    let contacts = packing.contacts.len() as f64;
    // Two shears of each wave, each √2 times smaller than its component in the orthonormal basis; E|wave|² = N s².
    Some((sum / WAVES.len() as f64).sqrt() / contacts)
}

/// sin and cos of the sum of edge phases times their counts of −1, 0 or 1.
fn phase(edges: &[(f64, f64); 3], counts: [i32; 3]) -> (f64, f64) {
    edges.iter().zip(counts).filter(|(_, n)| *n != 0).fold((0.0, 1.0), |(sin, cos), ((s, c), n)| {
        let s = s * f64::from(n);
        (sin * c + cos * s, cos * c - sin * s)
    })
}

/// The eigenvector of `contact_fabric` that differs most from the mean, and its uncertainty; without contacts
/// `fallback`.
pub fn principal_axis(view: &PackingView<'_>, contact_fabric: &SymTensor, fallback: &Vec3) -> PrincipalAxis {
    let axis = &most_distinct_eigenvector(contact_fabric).unwrap_or(*fallback);
    let found = PrincipalAxis {
        direction: *axis,
        contact_anisotropy: contact_anisotropy(contact_fabric, axis),
        ..PrincipalAxis::default()
    };
    let Some(noise) = fabric_stddev(view, contact_fabric) else { return found };
    let along = contact_fabric.along(axis);
    let mut eigenvalues: [f64; 3] = contact_fabric.matrix().symmetric_eigenvalues().into();
    eigenvalues.sort_by(|a, b| (a - along).abs().total_cmp(&(b - along).abs()));
    // To first order the axis tilts by δL_ha/(λ_h − λ_a) towards each of the others; δL_ha scatters by noise/√2.
    let tilt = |other: f64| 0.5 * (noise / (along - other)).powi(2);
    let angle = (tilt(eigenvalues[1]) + tilt(eigenvalues[2])).sqrt();
    // Another axis is equally distinct if the middle eigenvalue equals the mean.
    let mut sorted = eigenvalues;
    sorted.sort_by(f64::total_cmp);
    let margin = (sorted[1] - contact_fabric.mean()).abs();
    let of_diagonal = (2.0f64 / 3.0).sqrt() * noise;
    let anisotropy = from_tensor(contact_fabric).norm_squared();
    // 1e-18: smaller values are rounding in the fabric of a lattice.
    let significant = anisotropy > (SIGNIFICANT * noise * noise).max(1e-18);
    PrincipalAxis {
        // ε = (15/4)(L_hh − 1/3).
        contact_anisotropy_stddev: Some(3.75 * of_diagonal),
        angle_stddev: Some(angle).filter(|a| *a <= 1.0),
        determined: significant && margin > 2.0 * of_diagonal,
        ..found
    }
}

/// Eigenvector whose eigenvalue is furthest from a third of the trace, with a non-negative z component; `None` without a
/// trace.
fn most_distinct_eigenvector(fabric: &SymTensor) -> Option<Vec3> {
    let mean = fabric.mean();
    if mean <= 0.0 {
        return None;
    }
    let eigen = fabric.matrix().symmetric_eigen();
    let distance = |k: usize| (eigen.eigenvalues[k] - mean).abs();
    let best = (1..3).fold(0, |best, k| if distance(k) > distance(best) { k } else { best });
    let v: Vec3 = eigen.eigenvectors.column(best).into_owned().normalize();
    // The first component that is not zero, from z down, decides the sign.
    let sign = [v.z, v.y, v.x].into_iter().find(|c| *c != 0.0).unwrap_or(1.0).signum();
    Some(v * sign)
}
