//! The acoustic tensor of one wave vector.

use grainlab_core::Mat3;

/// The acoustic tensor A at one wave number.
pub(super) struct AcousticTensor {
    pub(super) wavenumber: f64,
    /// Tensor A over q², m²/s².
    pub(super) over_square: Mat3,
    /// Relative error of ω².
    pub(super) error: f64,
}
