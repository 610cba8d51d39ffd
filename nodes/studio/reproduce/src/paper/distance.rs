//! Distance of packings from the paper, in one number, term by term.

use super::compare::{Comparison, compare};
use super::quantity::Quantity;
use super::sample::States;
use super::tables::SAMPLES;
use grainlab_emt::Modulus;

/// The sum of the first four terms, and the terms.
pub const DISTANCE: [&str; 7] =
    ["distance", "z", "eps", "gamma/Delta", "phi", "k (not counted)", "G12 (not counted)"];

/// Differences at 50 kPa from Tables I to III in the order of [`DISTANCE`], each squared over what counts as near and averaged
/// over the samples: 1 is a difference as large as that. z and k are compared with the paper's k; γ/Δ is that of the total strain,
/// G12 that which Table III implies. `None` if a sample is missing.
pub fn distance(states: &States) -> Option<[f64; 7]> {
    let compared = compare(states);
    let term = |quantity: Quantity, near: f64, size: fn(&Comparison) -> Option<f64>| {
        let at = |sample: usize| Comparison::find(&compared, quantity, sample, 0);
        let squares: Option<Vec<f64>> =
            (0..SAMPLES).map(|sample| Some((size(at(sample)?)? / near).powi(2))).collect();
        squares.map(|all| all.iter().sum::<f64>() / SAMPLES as f64)
    };
    let z = term(Quantity::Z, 0.03, Comparison::relative)?;
    let eps = term(Quantity::Eps, 0.012, Comparison::difference)?;
    let gamma = term(Quantity::StrainTotal, 0.02, Comparison::difference)?;
    let phi = term(Quantity::SolidFraction, 0.006, Comparison::difference)?;
    let k = term(Quantity::K, 0.03, Comparison::relative)?;
    let g12 = term(Quantity::Modulus(Modulus::G12), 0.03, Comparison::relative)?;
    Some([z + eps + gamma + phi, z, eps, gamma, phi, k, g12])
}
