//! Corrections of the laws of `relaxed` for contacts that are not those of its calibration.

use crate::calibration::ISOSTATIC;

/// Corrections of ln of the bulk and of the shear modulus, in this order, learned from `tests/golden/ensembles/contacts.csv`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactCorrections {
    /// Factors of κ², κ³ and κ² ln(z/5), κ = k_t/k_n − 8/9. The laws were learned for k_t/k_n near Mindlin's; from .27.
    pub by_low_ratio: [[f64; 3]; 2],
    /// Factor of (α^1.5 − 3^−1.5) e^(−.65 (z − 4)), for k_n ∝ F^α: the spread of the stiffness of the contacts.
    pub by_spread: [f64; 2],
}

const SPREAD_RATE: f64 = 0.65;
const SPREAD_POWER: f64 = 1.5;

/// z of the middle of the packings.
const MIDDLE_Z: f64 = 5.0;

impl ContactCorrections {
    /// The learned ones: `grainlab_calibration` repeats them.
    pub const LEARNED: Self =
        Self { by_low_ratio: [[-0.075, 0.005, -0.075], [-0.134, 0.928, 0.918]], by_spread: [0.380, -0.536] };

    /// Factors of [`ContactCorrections::by_low_ratio`] at this κ and z.
    pub fn low_ratio_terms(kappa: f64, z: f64) -> [f64; 3] {
        let square = kappa * kappa;
        [square, square * kappa, square * (z / MIDDLE_Z).ln()]
    }

    /// Factor of [`ContactCorrections::by_spread`] at this exponent and z.
    pub fn spread_term(exponent: f64, z: f64) -> f64 {
        let of_exponent = exponent.max(0.0).powf(SPREAD_POWER) - f64::powf(1.0 / 3.0, SPREAD_POWER);
        of_exponent * (-SPREAD_RATE * (z - ISOSTATIC)).exp()
    }

    /// Correction of a modulus for its spread of stiffness, and its slope by z.
    pub(super) fn of_spread(&self, modulus: usize, exponent: f64, z: f64) -> [f64; 2] {
        let value = self.by_spread[modulus] * Self::spread_term(exponent, z);
        [value, -SPREAD_RATE * value]
    }

    /// Correction of a modulus for a low k_t/k_n, and its slopes by κ and z.
    pub(super) fn of_low_ratio(&self, modulus: usize, kappa: f64, z: f64) -> [f64; 3] {
        let [a, b, c] = self.by_low_ratio[modulus];
        let [square, cube, mixed] = Self::low_ratio_terms(kappa, z);
        let by_kappa = kappa * (2.0 * (a + c * (z / MIDDLE_Z).ln()) + 3.0 * b * kappa);
        [a * square + b * cube + c * mixed, by_kappa, c * square / z]
    }
}
