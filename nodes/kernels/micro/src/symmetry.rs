//! How much of a stiffness is the accident of one packing.

/// Relative residual (Mandel norm) up to which a stiffness of a packing of `grains` grains counts as one of a symmetry
/// class, for [`grains::symmetry()`].
///
/// TODO
pub fn sampling_tolerance(grains: u32) -> f64 {
    (0.8 / f64::from(grains.max(1)).sqrt()).min(0.05)
}
