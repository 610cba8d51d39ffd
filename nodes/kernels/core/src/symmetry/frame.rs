//! The frame in which a stiffness is nearest to a class.
//!
//! |C − P C|² as a function of the frame is smooth with several minima. Starting frames are the eigenvectors of the
//! dilatational tensor C_ijkk and of the Voigt tensor C_ikjk (exact for a stiffness of the class, unless they are
//! degenerate, as for a cubic one) and an even spread over all frames. The best of them are refined by
//! Levenberg–Marquardt steps on the rotation, which converge quadratically where the residual vanishes.

use crate::tensor::{Mat3, Vec3};
use nalgebra::{Matrix6, Quaternion, Rotation3, UnitQuaternion};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2, TAU};

/// Frames spread over all rotations. A class with the axes of a cube has each minimum 24 times.
const SPREAD: usize = 48;

const REFINED: usize = 6;

const STEPS: usize = 60;

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Search {
    /// All three axes.
    Frames,
    /// The third axis alone.
    Axes,
}

pub(super) struct Nearest {
    /// Norm of what the projection discards there.
    pub(super) residual: f64,
    /// Axes as columns.
    pub(super) axes: Mat3,
}

type Projection = fn(&Matrix6<f64>) -> Matrix6<f64>;

/// The frame in which `c` (Mandel form, symmetric, norm 1) is nearest to the class of `projection`.
pub(super) fn nearest(c: &Matrix6<f64>, projection: Projection, search: Search) -> Nearest {
    let mut starts: Vec<(f64, Rotation3<f64>)> = candidates(c, search)
        .into_iter()
        .map(|frame| {
            let seen = turned(c, &frame);
            ((seen - projection(&seen)).norm_squared(), frame)
        })
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let refined = starts.iter().take(REFINED).map(|(_, frame)| refine(c, projection, *frame));
    let (square, frame) = refined.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((1.0, Rotation3::identity()));
    Nearest { residual: square.sqrt(), axes: frame.matrix().transpose() }
}

/// Frames to start from, as rotations that turn the frame's axes onto x, y, z.
fn candidates(c: &Matrix6<f64>, search: Search) -> Vec<Rotation3<f64>> {
    let mut frames = vec![Rotation3::identity()];
    for tensor in [dilatational(c), voigt(c)] {
        let axes = tensor.symmetric_eigen().eigenvectors;
        // A class with an axis depends on which of the three is the third, other classes on no order.
        let orders = if search == Search::Axes { 3 } else { 1 };
        for last in 0..orders {
            let (a, b) = (axes.column((last + 1) % 3).into_owned(), axes.column((last + 2) % 3).into_owned());
            frames
                .push(Rotation3::from_matrix_unchecked(Mat3::from_columns(&[a, b, a.cross(&b)]).transpose()));
        }
    }
    for k in 0..SPREAD {
        // Additive recurrences of low discrepancy; three of them fill the rotations evenly (Shoemake).
        let at = |irrational: f64| ((k as f64 + 0.5) * irrational).fract();
        frames.push(match search {
            Search::Frames => {
                let (u, v, w) =
                    (at(0.819_172_513_396_164_4), at(0.671_043_606_703_789_2), at(0.549_700_477_901_970_6));
                let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
                let (v, w) = (TAU * v, TAU * w);
                let q = Quaternion::new(b * w.cos(), a * v.sin(), a * v.cos(), b * w.sin());
                UnitQuaternion::from_quaternion(q).to_rotation_matrix()
            }
            Search::Axes => {
                let z = (k as f64 + 0.5) / SPREAD as f64;
                let (sin, cos) = (TAU * at(0.618_033_988_749_894_9)).sin_cos();
                let flat = (1.0 - z * z).sqrt();
                let axis = Vec3::new(flat * cos, flat * sin, z);
                Rotation3::rotation_between(&axis, &Vec3::z()).unwrap_or_default()
            }
        });
    }
    frames
}

/// Least squares of what the projection discards, over the frame: its square there, and the frame.
fn refine(c: &Matrix6<f64>, projection: Projection, start: Rotation3<f64>) -> (f64, Rotation3<f64>) {
    let discarded = |seen: &Matrix6<f64>| seen - projection(seen);
    let spins = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| spin(&axis));
    let mut frame = start;
    let mut seen = turned(c, &frame);
    let mut rest = discarded(&seen);
    let mut square = rest.norm_squared();
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let slopes = spins.map(|g| discarded(&(g * seen - seen * g)));
        let gradient = Vec3::from(slopes.map(|s| s.dot(&rest)));
        let curvature = Mat3::from_fn(|i, j| slopes[i].dot(&slopes[j]));
        if gradient.amax() < 1e-17 {
            break;
        }
        let damped = curvature + Mat3::identity() * damping * curvature.trace().max(1e-12);
        let Some(step) = damped.cholesky().map(|l| -l.solve(&gradient)) else { break };
        let next = Rotation3::new(step) * frame;
        let next_seen = turned(c, &next);
        let next_rest = discarded(&next_seen);
        let next_square = next_rest.norm_squared();
        if next_square < square {
            let gain = square - next_square;
            (frame, seen, rest, square) = (next, next_seen, next_rest, next_square);
            damping = (damping * 0.1).max(1e-12);
            if gain < 1e-15 * square || square < 1e-32 {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > 1e8 {
                break;
            }
        }
    }
    // Many small rotations leave rounding in the matrix.
    frame.renormalize();
    (square, frame)
}

/// Dilatational tensor C_ijkk.
fn dilatational(c: &Matrix6<f64>) -> Mat3 {
    symmetric(std::array::from_fn(|a| c[(a, 0)] + c[(a, 1)] + c[(a, 2)]))
}

/// Voigt tensor C_ikjk.
fn voigt(c: &Matrix6<f64>) -> Mat3 {
    let of = |a: usize, b: usize| c[(a, b)];
    // Mandel entries of two shears are twice the tensor's, of one √2 times.
    symmetric([
        of(0, 0) + 0.5 * (of(4, 4) + of(5, 5)),
        of(1, 1) + 0.5 * (of(3, 3) + of(5, 5)),
        of(2, 2) + 0.5 * (of(3, 3) + of(4, 4)),
        of(1, 3) + of(2, 3) + FRAC_1_SQRT_2 * of(4, 5),
        of(0, 4) + of(2, 4) + FRAC_1_SQRT_2 * of(3, 5),
        of(0, 5) + of(1, 5) + FRAC_1_SQRT_2 * of(3, 4),
    ])
}

/// From Mandel order.
fn symmetric(m: [f64; 6]) -> Mat3 {
    let [yz, xz, xy] = [m[3], m[4], m[5]].map(|v| v * FRAC_1_SQRT_2);
    Mat3::new(m[0], xy, xz, xy, m[1], yz, xz, yz, m[2])
}

/// The matrix seen after `rotation`: Q c Qᵀ with Q the rotation of tensors in Mandel form.
fn turned(c: &Matrix6<f64>, rotation: &Rotation3<f64>) -> Matrix6<f64> {
    let r = rotation.matrix();
    let q = action(|basis| r * basis * r.transpose());
    q * c * q.transpose()
}

/// The derivative of [`turned`]'s Q with respect to a rotation about `axis`.
fn spin(axis: &Vec3) -> Matrix6<f64> {
    let w = axis.cross_matrix();
    action(|basis| w * basis - basis * w)
}

/// A linear map of symmetric tensors in Mandel form.
fn action(map: impl Fn(Mat3) -> Mat3) -> Matrix6<f64> {
    let mut matrix = Matrix6::zeros();
    for column in 0..6 {
        let mut unit = [0.0; 6];
        unit[column] = 1.0;
        let image = map(symmetric(unit));
        let shears = [image[(1, 2)], image[(0, 2)], image[(0, 1)]].map(|v| v * SQRT_2);
        let rows = [image[(0, 0)], image[(1, 1)], image[(2, 2)], shears[0], shears[1], shears[2]];
        matrix.set_column(column, &rows.into());
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stiffness::Stiffness;

    #[test]
    fn contracted_tensors_are_those_of_all_81_components() {
        let a = Matrix6::from_fn(|i, j| ((5 * i + 3 * j + i * i * j) as f64).cos());
        let c = Stiffness(a + a.transpose());
        let voigt_index = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];
        let full = |i: usize, j: usize, k: usize, l: usize| c.0[(voigt_index[i][j], voigt_index[k][l])];
        let sum = |of: &dyn Fn(usize) -> f64| (0..3).map(of).sum::<f64>();
        let expected = Mat3::from_fn(|i, j| sum(&|k| full(i, j, k, k)));
        assert!((dilatational(&c.mandel()) - expected).amax() < 1e-14);
        let expected = Mat3::from_fn(|i, j| sum(&|k| full(i, k, j, k)));
        assert!((voigt(&c.mandel()) - expected).amax() < 1e-14);
    }

    #[test]
    fn a_turned_matrix_is_the_turned_stiffness_and_a_spin_its_derivative() {
        let a = Matrix6::from_fn(|i, j| ((5 * i + 3 * j + i * i * j) as f64).cos());
        let c = Stiffness(a + a.transpose());
        let r = Rotation3::from_euler_angles(0.4, -1.2, 0.7);
        assert!((turned(&c.mandel(), &r) - c.rotated(r.matrix()).mandel()).amax() < 1e-13);
        let (h, m) = (1e-6, c.mandel());
        let step = |h: f64| turned(&m, &Rotation3::new(Vec3::y() * h));
        let g = spin(&Vec3::y());
        assert!(((step(h) - step(-h)) / (2.0 * h) - (g * m - m * g)).amax() < 1e-8);
    }
}
