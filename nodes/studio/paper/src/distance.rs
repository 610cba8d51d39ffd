//! Distance of packings from the paper, in one number, term by term.

use crate::compare::{Comparison, compare};
use crate::quantity::Quantity;
use crate::sample::States;
use crate::tables::SAMPLES;
use grainlab_emt::Modulus;

/// Differences at 50 kPa from Tables I to III, each squared over what counts as near and averaged over the samples: 1 is a
/// difference as large as that. The moduli are those that Table III implies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// z less the paper's k, over 3 %.
    pub coordination: f64,
    /// ε, over 0.012.
    pub anisotropy: f64,
    /// γ/Δ of the total strain, over 0.02.
    pub strain_ratio: f64,
    /// φ, over 0.006.
    pub solid_fraction: f64,
    /// k of all grains, over 3 %; not in the sum.
    pub all_grains: f64,
    /// G12, over 3 %; not in the sum.
    pub shear_modulus: f64,
}

impl Distance {
    /// Distance of the means over seeds; `None` if a sample is missing.
    pub fn of(states: &States) -> Option<Self> {
        let compared = compare(states);
        let term = |quantity: Quantity, near: f64, size: fn(&Comparison) -> Option<f64>| {
            let at = |sample: usize| Comparison::find(&compared, quantity, sample, 0);
            let squares: Option<Vec<f64>> =
                (0..SAMPLES).map(|sample| Some((size(at(sample)?)? / near).powi(2))).collect();
            squares.map(|all| all.iter().sum::<f64>() / SAMPLES as f64)
        };
        Some(Self {
            coordination: term(Quantity::Z, 0.03, Comparison::relative)?,
            anisotropy: term(Quantity::Eps, 0.012, Comparison::difference)?,
            strain_ratio: term(Quantity::StrainTotal, 0.02, Comparison::difference)?,
            solid_fraction: term(Quantity::SolidFraction, 0.006, Comparison::difference)?,
            all_grains: term(Quantity::K, 0.03, Comparison::relative)?,
            shear_modulus: term(Quantity::Modulus(Modulus::G12), 0.03, Comparison::relative)?,
        })
    }

    /// The sum of the four terms that Tables I and II have.
    pub fn total(&self) -> f64 {
        self.coordination + self.anisotropy + self.strain_ratio + self.solid_fraction
    }
}
