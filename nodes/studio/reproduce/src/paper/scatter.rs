//! Scatter of packings of one recipe from seed to seed.

use super::quantity::Quantity;
use super::tables::SAMPLES;
use grainlab_emt::Modulus;

/// Grains of the packings of which [`SCATTER`] is the scatter.
const GRAINS: f64 = 500.0;

/// Standard deviation of each quantity from seed to seed, S1 to S4: over 12 seeds, the root of its mean square over the four
/// pressures (`grainlab reproduce --grains 500 --seeds 12`). That of coordination and moduli is over the value.
const SCATTER: [(Quantity, [f64; SAMPLES]); 16] = [
    (Quantity::K, [0.0087, 0.0095, 0.016, 0.017]),
    (Quantity::Z, [0.007, 0.0052, 0.0063, 0.0077]),
    (Quantity::Fabric(0), [0.0042, 0.004, 0.0056, 0.0039]),
    (Quantity::Fabric(1), [0.0044, 0.0036, 0.0048, 0.0044]),
    (Quantity::Fabric(2), [0.0047, 0.0029, 0.0045, 0.0037]),
    (Quantity::Eps, [0.018, 0.011, 0.017, 0.014]),
    (Quantity::DeviatoricFabric, [0.007, 0.0043, 0.0067, 0.0055]),
    (Quantity::SolidFraction, [0.0012, 0.0014, 0.0013, 0.0014]),
    (Quantity::StrainTotal, [0.012, 0.013, 0.013, 0.013]),
    (Quantity::StrainElastic, [0.0044, 0.0029, 0.0071, 0.0057]),
    (Quantity::StrainContact, [0.006, 0.0047, 0.0068, 0.0057]),
    (Quantity::Modulus(Modulus::G12), [0.016, 0.026, 0.042, 0.042]),
    (Quantity::Modulus(Modulus::G13), [0.015, 0.028, 0.032, 0.035]),
    (Quantity::Modulus(Modulus::Theta), [0.0065, 0.0084, 0.012, 0.011]),
    (Quantity::ShearRatio, [0.019, 0.033, 0.055, 0.041]),
    (Quantity::KEmt, [0.024, 0.022, 0.046, 0.045]),
];

/// Standard deviation of a quantity from seed to seed, of packings of this number of grains; it falls with the square root of the
/// number. `None` where it was not measured.
pub(crate) fn of_one(quantity: Quantity, sample: usize, value: f64, grains: f64) -> Option<f64> {
    let (_, all) = SCATTER.iter().find(|(q, _)| *q == quantity)?;
    let scale = if is_relative(quantity) { value.abs() } else { 1.0 };
    Some(scale * all[sample] * (GRAINS / grains).sqrt())
}

fn is_relative(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::K | Quantity::Z | Quantity::Modulus(_) | Quantity::KEmt)
}
