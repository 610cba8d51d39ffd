//! Moduli that the fit determines, with their covariance.

use super::fit::Fit;
use super::ray::UNKNOWNS;
use crate::conditions::Measured;
use crate::moduli::{MODULI, Moduli, ModuliCovariance};
use nalgebra::{SMatrix, SVector};

/// Relative undetermined part of a modulus up to which it counts as known.
const OPEN: f64 = 3e-3;

/// The moduli, in the order of [`crate::Modulus::ALL`], as linear combinations of C11, C33, C13, C44 and C66.
/// 9 Θ = 4 C11 + C33 + 4 C13 − 4 C66.
#[rustfmt::skip]
const ROWS: [[f64; UNKNOWNS]; MODULI] = [
    [0.0, 0.0, 0.0, 0.0, 1.0],
    [0.0, 0.0, 0.0, 1.0, 0.0],
    [4.0 / 9.0, 1.0 / 9.0, 4.0 / 9.0, 0.0, -4.0 / 9.0],
    [1.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0, 0.0],
];

/// The determined moduli, Pa, and their covariance, Pa², if a speed of weight 1 has the relative error `unit`.
pub(super) fn moduli(fit: &Fit, density: Measured, unit: Option<f64>) -> (Moduli, Option<ModuliCovariance>) {
    let rows = SMatrix::<f64, MODULI, UNKNOWNS>::from_fn(|i, j| ROWS[i][j]);
    let specific = rows * fit.specific;
    // An undetermined combination may be wrong by its whole scale; its effect on a modulus that counts as known is
    // small.
    let open: Vec<SVector<f64, MODULI>> = fit.open.iter().map(|change| rows * change).collect();
    let scale = rows.abs() * fit.scale;
    let known: [bool; MODULI] =
        std::array::from_fn(|i| open.iter().all(|change| change[i].abs() <= OPEN * scale[i]));
    let values = std::array::from_fn(|i| known[i].then_some(density.value * specific[i]));
    let covariance = unit.map(|unit| {
        let of_speeds = rows * fit.covariance * rows.transpose() * unit.powi(2);
        let of_open: ModuliCovariance = open.iter().map(|change| change * change.transpose()).sum();
        let of_density = specific * specific.transpose() * density.stddev.powi(2);
        let full = (of_speeds + of_open) * density.value.powi(2) + of_density;
        ModuliCovariance::from_fn(|i, j| if known[i] && known[j] { full[(i, j)] } else { 0.0 })
    });
    (Moduli::of_values(values), covariance)
}
