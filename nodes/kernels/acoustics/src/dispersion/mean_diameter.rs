//! The unit of wavelengths.

use grainlab_core::Packing;

/// Mean grain diameter, m.
pub(crate) fn mean_diameter(packing: &Packing) -> f64 {
    2.0 * packing.radii.iter().sum::<f64>() / packing.grains() as f64
}
