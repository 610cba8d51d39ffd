//! The rotation that makes several symmetric tensors as diagonal as one rotation can.
//!
//! Jacobi rotations: Cardoso and Souloumiac, SIAM J. Matrix Anal. Appl. 17, 161 (1996).

use grainlab_core::Mat3;

/// Maximum number of sweeps, and the sine of a rotation at which they end.
const SWEEPS: usize = 50;
const CONVERGED: f64 = 1e-12;

/// The orthogonal R that minimises the sum of the squares of the off-diagonal entries of Rᵀ A R over the symmetric
/// tensors A.
pub(super) fn joint_diagonal(tensors: &[Mat3]) -> Mat3 {
    let mut turned = tensors.to_vec();
    let mut rotation = Mat3::identity();
    for _ in 0..SWEEPS {
        let mut largest = 0.0f64;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let (mut along, mut across, mut both) = (0.0, 0.0, 0.0);
            for a in &turned {
                let (difference, sum) = (a[(p, p)] - a[(q, q)], a[(p, q)] + a[(q, p)]);
                along += difference * difference;
                across += sum * sum;
                both += difference * sum;
            }
            let (even, odd) = (along - across, 2.0 * both);
            let (sine, cosine) = (0.5 * odd.atan2(even + even.hypot(odd))).sin_cos();
            largest = largest.max(sine.abs());
            let mut step = Mat3::identity();
            (step[(p, p)], step[(q, q)]) = (cosine, cosine);
            (step[(p, q)], step[(q, p)]) = (-sine, sine);
            turned.iter_mut().for_each(|a| *a = step.transpose() * *a * step);
            rotation *= step;
        }
        if largest < CONVERGED {
            break;
        }
    }
    rotation
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::Vec3;
    use nalgebra::Rotation3;

    #[test]
    fn tensors_with_common_axes_become_diagonal() {
        let axes = Rotation3::from_euler_angles(0.4, -1.1, 2.0).into_inner();
        let diagonals = [Vec3::new(1.0, 2.0, 2.01), Vec3::new(-0.3, 0.5, 0.4), Vec3::new(0.0, 0.0, 1.0)];
        let tensors = diagonals.map(|d| axes * Mat3::from_diagonal(&d) * axes.transpose());
        let found = joint_diagonal(&tensors);
        assert!((found.transpose() * found - Mat3::identity()).amax() < 1e-12);
        for tensor in &tensors {
            let inside = found.transpose() * tensor * found;
            assert!((inside - Mat3::from_diagonal(&inside.diagonal())).amax() < 1e-10, "{inside}");
        }
    }

    #[test]
    fn one_tensor_has_its_eigenvectors() {
        let tensor = Mat3::new(2.0, 0.3, -0.1, 0.3, 1.0, 0.2, -0.1, 0.2, 0.5);
        let found = joint_diagonal(&[tensor]);
        let inside = found.transpose() * tensor * found;
        assert!((inside - Mat3::from_diagonal(&inside.diagonal())).amax() < 1e-10, "{inside}");
    }
}
