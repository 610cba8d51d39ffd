//! Effect of the departure of a sample from a transversely isotropic medium on the moduli fitted to its speeds.
//!
//! The departure is a stiffness whose transversely isotropic projection is zero. To first order ρ v² of a polarization p
//! along n changes by p·Γ(departure)·p, so that the errors of several speeds are not independent: over enough
//! azimuths they cancel, and three rays see each part of the departure once. Its components are taken as independent
//! and of equal variance in the space of stiffnesses with the norm of the tensor, which prefers no direction.

use super::fit::Fit;
use super::ray::{Column, UNKNOWNS};
use super::search::Square;
use grainlab_core::{Stiffness, Vec3, WaveSpeed};
use nalgebra::{DMatrix, Matrix6};

/// Second-order change of ρ v² over the square of the relative scatter: turned polarizations.
const SECOND_ORDER: f64 = 2.0;

/// Covariance of the specific moduli, m⁴/s⁴, if the departure changes v of the speeds by the root mean square `scatter`, and the
/// speeds have these relative `errors` of their own.
pub(super) fn covariance(
    speeds: &[WaveSpeed],
    axis: &Vec3,
    fit: &Fit,
    errors: &[f64],
    scatter: f64,
) -> Square {
    let seen = seen(speeds, axis);
    let total = seen.norm_squared() / speeds.len() as f64;
    let scale = if total > 0.0 { scatter / total.sqrt() } else { 0.0 };
    let mut covariance = Square::zeros();
    for (gain, error) in fit.gains.iter().zip(errors) {
        covariance += gain * gain.transpose() * error.powi(2);
    }
    for part in seen.column_iter() {
        let moved: Column = fit.gains.iter().zip(part.iter()).map(|(gain, d)| gain * (scale * *d)).sum();
        covariance += moved * moved.transpose();
    }
    // Second order in the relative scatter of v², 2 × scatter.
    let second = SECOND_ORDER * (2.0 * scatter).powi(2);
    for k in 0..UNKNOWNS {
        covariance[(k, k)] += (second * fit.specific[k]).powi(2);
    }
    covariance
}

/// Relative change of v of each speed (row) by each unit departure (column), up to a common factor.
fn seen(speeds: &[WaveSpeed], axis: &Vec3) -> DMatrix<f64> {
    let departures: Vec<Stiffness> = units().map(|unit| departure(&unit, axis)).collect();
    DMatrix::from_fn(speeds.len(), departures.len(), |i, k| {
        let wave = &speeds[i];
        let change = wave.polarization.dot(&(departures[k].christoffel(&wave.direction) * wave.polarization));
        0.5 * change / wave.speed.powi(2)
    })
}

/// Part that the projection on media isotropic about `axis` discards.
fn departure(stiffness: &Stiffness, axis: &Vec3) -> Stiffness {
    let turn = nalgebra::Rotation3::rotation_between(axis, &Vec3::z());
    // Opposite to e3: any half turn across it.
    let turn =
        turn.unwrap_or_else(|| nalgebra::Rotation3::from_axis_angle(&Vec3::x_axis(), std::f64::consts::PI));
    let there = stiffness.rotated(turn.matrix());
    let rest = Stiffness(there.0 - there.transverse_isotropy().stiffness().0);
    rest.rotated(&turn.matrix().transpose())
}

/// The 21 unit stiffnesses of the norm of the tensor.
fn units() -> impl Iterator<Item = Stiffness> {
    let weight = |i: usize| if i < 3 { 1.0 } else { std::f64::consts::FRAC_1_SQRT_2 };
    let pairs = (0..6).flat_map(|i| (i..6).map(move |j| (i, j)));
    pairs.map(move |(i, j)| {
        let value = weight(i) * weight(j) * if i == j { 1.0 } else { std::f64::consts::FRAC_1_SQRT_2 };
        let mut unit = Matrix6::zeros();
        (unit[(i, j)], unit[(j, i)]) = (value, value);
        Stiffness(unit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_departure_has_no_projection_and_does_not_depend_on_the_sign_of_the_axis() {
        let axis = Vec3::new(1.0, 2.0, -2.0) / 3.0;
        for unit in units() {
            assert!((unit.mandel().norm() - 1.0).abs() < 1e-12);
            let left = departure(&unit, &axis);
            let again = departure(&left, &axis);
            assert!((left.0 - again.0).amax() < 1e-12);
            assert!((left.0 - departure(&unit, &-axis).0).amax() < 1e-12);
        }
    }

    #[test]
    fn the_wave_along_the_axis_sees_no_azimuth() {
        let wave = |direction: Vec3, polarization: Vec3| WaveSpeed {
            direction,
            polarization,
            speed: 1.0,
            stddev: None,
        };
        let seen = seen(&[wave(Vec3::z(), Vec3::z()), wave(Vec3::x(), Vec3::x())], &Vec3::z());
        assert!(seen.row(0).norm() < 1e-12 && seen.row(1).norm() > 0.1);
    }
}
