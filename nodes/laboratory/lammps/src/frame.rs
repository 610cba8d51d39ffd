//! The cell as LAMMPS has it: edges as the columns of an upper triangular matrix, in axes that rotate with them.

use grainlab_core::{Cell, Mat3, SymTensor, Vec3};

/// A cell in its own axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// Edges as columns in the axes of LAMMPS, m: upper triangular, with a positive diagonal.
    pub(crate) edges: Mat3,
    /// From the axes of LAMMPS to those of the packing.
    pub(crate) rotation: Mat3,
}

impl Frame {
    pub(crate) fn of(cell: &Cell) -> Self {
        let h = *cell.matrix();
        if (h[(1, 0)], h[(2, 0)], h[(2, 1)]) == (0.0, 0.0, 0.0) {
            return Self { edges: h, rotation: Mat3::identity() };
        }
        let (mut rotation, mut edges) = h.qr().unpack();
        for k in 0..3 {
            if edges[(k, k)] < 0.0 {
                edges.row_mut(k).neg_mut();
                rotation.column_mut(k).neg_mut();
            }
        }
        edges.fill_lower_triangle(0.0, 1);
        Self { edges, rotation }
    }

    /// Largest tilt of the box over the edge that it is tilted along.
    pub(crate) fn tilt(&self) -> f64 {
        let e = &self.edges;
        let tilts = [(0, 1), (0, 2), (1, 2)].map(|(row, column)| (e[(row, column)] / e[(row, row)]).abs());
        tilts.into_iter().fold(0.0, f64::max)
    }

    pub(crate) fn in_lammps(&self, v: &Vec3) -> Vec3 {
        self.rotation.tr_mul(v)
    }

    /// The symmetric part of a tensor, in the axes of the packing.
    pub(crate) fn tensor(&self, in_lammps: &Mat3) -> SymTensor {
        SymTensor::symmetric_part(&(self.rotation * in_lammps * self.rotation.transpose()))
    }
}

/// The affine velocity of an exchange, in which the edges change linearly from one frame to the next over a time: positions x
/// move with L x at its beginning, and with L' x at its end, of the same grains the same velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Affine {
    /// Velocity gradient L, 1/s.
    pub(crate) first: Mat3,
    /// Velocity gradient L', 1/s.
    pub(crate) last: Mat3,
}

impl Affine {
    /// That of a fixed box.
    pub(crate) const NONE: Self = Self {
        first: Mat3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        last: Mat3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    pub(crate) fn between(from: &Mat3, to: &Mat3, time: f64) -> Self {
        let speed = (to - from) / time;
        // Edges of a cell with a volume have an inverse.
        let inverse = |edges: &Mat3| edges.try_inverse().unwrap_or_default();
        Self { first: speed * inverse(from), last: speed * inverse(to) }
    }
}

/// Angular velocity of a velocity gradient, 1/s.
pub(crate) fn spin(l: &Mat3) -> Vec3 {
    0.5 * Vec3::new(l[(2, 1)] - l[(1, 2)], l[(0, 2)] - l[(2, 0)], l[(1, 0)] - l[(0, 1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_its_frame_rotated_and_lengths_and_angles_are_kept() {
        let h = Mat3::new(1.0, 0.1, -0.2, 0.05, 0.9, 0.1, -0.02, 0.2, 1.1);
        let frame = Frame::of(&Cell::new(h).unwrap());
        assert!((frame.rotation * frame.edges - h).norm() < 1e-14 && frame.rotation.determinant() > 0.999);
        assert!((0..3).all(|k| frame.edges[(k, k)] > 0.0) && frame.tilt() < 0.5);
    }

    #[test]
    fn a_grain_keeps_its_affine_velocity_during_an_exchange() {
        let (from, to) = (Mat3::identity(), Mat3::new(1.1, 0.2, 0.1, 0.0, 0.9, 0.05, 0.0, 0.0, 1.2));
        let affine = Affine::between(&from, &to, 0.5);
        let s = Vec3::new(0.2, 0.7, 0.4);
        assert!((affine.first * from * s - affine.last * to * s).norm() < 1e-14);
    }
}
