//! The periodic cell.

use crate::tensor::{Mat3, Vec3};

/// A periodic cell of any shape: a parallelepiped spanned by three vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    matrix: Mat3,
    inverse: Mat3,
    volume: f64,
}

impl Cell {
    /// A cell whose edge vectors are the columns of `matrix`, m. `None` unless the volume is positive and finite
    /// (columns must be right-handed).
    pub fn new(matrix: Mat3) -> Option<Self> {
        let volume = matrix.determinant();
        if !(volume > 0.0 && volume.is_finite()) {
            return None;
        }
        Some(Self { matrix, inverse: matrix.try_inverse()?, volume })
    }

    /// A cube of edge `edge`, m.
    pub fn cube(edge: f64) -> Option<Self> {
        Self::new(Mat3::identity() * edge)
    }

    /// Edge vectors as columns, m.
    pub fn matrix(&self) -> &Mat3 {
        &self.matrix
    }

    /// Inverse of [`Cell::matrix`], 1/m.
    pub fn inverse(&self) -> &Mat3 {
        &self.inverse
    }

    /// Volume of the cell, m³.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Distance between the two faces that edge vector `axis` connects, m: the widths that limit a search radius.
    pub fn width(&self, axis: usize) -> f64 {
        1.0 / self.inverse.row(axis).norm()
    }

    /// Shift of a periodic image, m.
    #[inline]
    pub fn shift(&self, image: [i8; 3]) -> Vec3 {
        self.matrix * Vec3::new(f64::from(image[0]), f64::from(image[1]), f64::from(image[2]))
    }

    /// Position in units of the edge vectors, not folded.
    pub fn fractional(&self, x: &Vec3) -> Vec3 {
        self.inverse * x
    }

    /// Place of a position, folded into the cell, along a space-filling (Morton) curve: what is near in place is near in
    /// space. 30 bits.
    pub fn place_on_curve(&self, x: &Vec3) -> u32 {
        let s = self.fractional(x);
        let coordinate = |k: usize| (s[k] - s[k].floor()) * f64::from(1u32 << CURVE_BITS);
        (0..3).map(|k| spread(coordinate(k) as u32) << k).sum()
    }

    /// The cell after the deformation `f` (new vectors = `f` · old vectors). `None` where it degenerates.
    pub fn deformed(&self, f: &Mat3) -> Option<Self> {
        Self::new(f * self.matrix)
    }
}

const CURVE_BITS: u32 = 10;

/// Two zero bits after each of the lowest ten.
fn spread(v: u32) -> u32 {
    (0..CURVE_BITS).map(|b| (v >> b & 1) << (3 * b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheared_cell_keeps_volume_and_loses_width() {
        let cell = Cell::new(Mat3::new(1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)).unwrap();
        assert!((cell.volume() - 1.0).abs() < 1e-15);
        assert!((cell.width(0) - 1.0 / 1.25f64.sqrt()).abs() < 1e-15);
        assert!((cell.width(1) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn flat_or_left_handed_cells_are_refused() {
        assert!(Cell::new(Mat3::zeros()).is_none());
        assert!(Cell::new(Mat3::identity() * -1.0).is_none());
        assert!(Cell::cube(f64::NAN).is_none());
    }
}
