//! The modes of a ray: the quasi-P and quasi-S waves that an instrument measures.
//!
//! The speeds of a ray along given polarizations are projections √(pᵀ A p)/q of the acoustic tensor A. In a medium with
//! this symmetry both are the same. A packing is never exactly transversely isotropic: its polarizations are turned a
//! little, and the speeds of its modes are further apart than their projections.

use grainlab_core::{Mat3, Vec3};
use nalgebra::{DMatrix, SymmetricEigen};

/// The acoustic tensor A at one wave number.
pub(super) struct AcousticTensor {
    pub(super) wavenumber: f64,
    /// Tensor A over q², m²/s².
    pub(super) over_square: Mat3,
    /// Relative error of ω².
    pub(super) error: f64,
}

/// Unit polarizations of the modes of long waves, in the span of the perpendicular unit vectors `within`: eigenvectors of
/// A/q², extrapolated linearly in q² to q = 0. Christoffel's tensor over the density has the same.
pub(super) fn long_wave_polarizations(tensors: &[AcousticTensor], within: &[Vec3]) -> Vec<Vec3> {
    let limit = long_wave_limit(tensors);
    let small = DMatrix::from_fn(within.len(), within.len(), |a, b| within[a].dot(&(limit * within[b])));
    let small = (&small + small.transpose()) * 0.5;
    let modes = SymmetricEigen::new(small).eigenvectors;
    modes
        .column_iter()
        .map(|mode| within.iter().zip(mode.iter()).map(|(e, share)| *e * *share).sum())
        .collect()
}

/// A/q² at q = 0 by least squares, m²/s².
fn long_wave_limit(tensors: &[AcousticTensor]) -> Mat3 {
    let count = tensors.len() as f64;
    let squares: Vec<f64> = tensors.iter().map(|t| t.wavenumber.powi(2)).collect();
    let centre = squares.iter().sum::<f64>() / count;
    let spread: f64 = squares.iter().map(|s| (s - centre).powi(2)).sum();
    let weight = |s: f64| 1.0 / count - if spread > 0.0 { centre * (s - centre) / spread } else { 0.0 };
    tensors.iter().zip(&squares).map(|(t, s)| t.over_square * weight(*s)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tensors(limit: Mat3, bend: Mat3) -> Vec<AcousticTensor> {
        let at = |wavenumber: f64| AcousticTensor {
            wavenumber,
            over_square: limit + bend * wavenumber.powi(2),
            error: 1e-6,
        };
        [0.1, 0.2, 0.3].map(at).into()
    }

    #[test]
    fn polarizations_are_those_of_the_limit_and_not_of_any_wave() {
        let limit = Mat3::from_diagonal(&Vec3::new(4.0, 1.1, 1.0));
        let bend = Mat3::new(0.0, 2.0, 0.0, 2.0, 0.0, 1.0, 0.0, 1.0, 0.0);
        let found = long_wave_polarizations(&tensors(limit, bend), &[Vec3::x(), Vec3::y(), Vec3::z()]);
        for mode in found {
            assert!((mode.amax() - 1.0).abs() < 1e-9, "{mode}");
        }
    }

    #[test]
    fn of_fewer_polarizations_the_modes_are_in_their_span() {
        let limit = Mat3::new(4.0, 0.2, 0.1, 0.2, 1.1, 0.3, 0.1, 0.3, 1.0);
        let found = long_wave_polarizations(&tensors(limit, Mat3::zeros()), &[Vec3::y(), Vec3::z()]);
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|m| m.x.abs() < 1e-12 && (m.norm() - 1.0).abs() < 1e-12));
        assert!(found[0].dot(&(limit * found[1])).abs() < 1e-12);
    }
}
