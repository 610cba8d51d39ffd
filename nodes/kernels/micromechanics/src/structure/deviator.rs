//! Symmetric traceless tensors as five numbers.
//!
//! The basis is orthonormal in the tensor product: diag(−1, −1, 2)/√6, diag(1, −1, 0)/√2, and the unit shears xy, xz, yz
//! over √2. The sum of squares of the five components is the square of the tensor's norm.

use grainlab_core::{SymTensor, Vec3};
use nalgebra::{SMatrix, SVector};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

const SQRT_6: f64 = 2.449_489_742_783_178;

/// A symmetric traceless tensor as its five components.
pub type DeviatorVector = SVector<f64, 5>;

/// Components of n⊗n − I/3, `n` a unit vector (of n⊗n less its mean, for any other).
pub fn from_direction(n: &Vec3) -> DeviatorVector {
    DeviatorVector::from([
        (2.0 * n.z * n.z - n.x * n.x - n.y * n.y) / SQRT_6,
        (n.x * n.x - n.y * n.y) * FRAC_1_SQRT_2,
        SQRT_2 * n.x * n.y,
        SQRT_2 * n.x * n.z,
        SQRT_2 * n.y * n.z,
    ])
}

/// Components of the deviator of `t`.
pub fn from_tensor(t: &SymTensor) -> DeviatorVector {
    DeviatorVector::from([
        (2.0 * t.zz - t.xx - t.yy) / SQRT_6,
        (t.xx - t.yy) * FRAC_1_SQRT_2,
        SQRT_2 * t.xy,
        SQRT_2 * t.xz,
        SQRT_2 * t.yz,
    ])
}

/// The traceless tensor of five components.
pub fn tensor(c: &DeviatorVector) -> SymTensor {
    let (axial, planar) = (c[0] / SQRT_6, c[1] * FRAC_1_SQRT_2);
    SymTensor {
        xx: planar - axial,
        yy: -planar - axial,
        zz: 2.0 * axial,
        yz: c[4] * FRAC_1_SQRT_2,
        xz: c[3] * FRAC_1_SQRT_2,
        xy: c[2] * FRAC_1_SQRT_2,
    }
}

/// The shortest solution of `matrix` x = `right` in the least-squares sense; `matrix` symmetric and positive
/// semidefinite. Directions whose eigenvalue is below 1e-9 of `scale` count as undetermined and are set to 0.
pub(crate) fn shortest_solution(
    matrix: SMatrix<f64, 5, 5>,
    right: &DeviatorVector,
    scale: f64,
) -> DeviatorVector {
    let eigen = matrix.symmetric_eigen();
    let mut x = DeviatorVector::zeros();
    for (k, &value) in eigen.eigenvalues.iter().enumerate() {
        if value > 1e-9 * scale {
            let v = eigen.eigenvectors.column(k);
            x += v * (v.dot(right) / value);
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_components_hold_a_traceless_tensor_and_its_norm() {
        let t = SymTensor::from_voigt([0.3, -0.5, 0.2, 0.7, -0.1, 0.4]);
        let c = from_tensor(&t);
        for (a, b) in tensor(&c).voigt().into_iter().zip(t.voigt()) {
            assert!((a - b).abs() < 1e-15);
        }
        assert!((c.norm_squared() - t.contract(&t)).abs() < 1e-15);
        let n = Vec3::new(0.36, -0.48, 0.8);
        let nn = SymTensor::symmetric_part(&(n * n.transpose()));
        assert!((from_direction(&n) - from_tensor(&nn)).amax() < 1e-15);
    }
}
