//! The 6×6 elastic stiffness and its transversely isotropic projection.
//!
//! [`mod@crate::symmetry`] finds which symmetry it has.

use crate::tensor::{Mat3, SymTensor, Vec3};
use nalgebra::{Matrix6, Rotation3, Vector6};

/// Stiffness C of dσ = −C : dE (σ positive in compression, E in extension), Pa, 6×6, Voigt order xx, yy, zz, yz, xz, xy
/// with engineering shear strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness(pub Matrix6<f64>);

/// The five moduli of a medium that is isotropic about e3, and G12, G13, Θ, all Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransverseIsotropy {
    /// (C11 + C22)/2 made invariant: C12 + 2 G12.
    pub c11: f64,
    /// Projected modulus C12.
    pub c12: f64,
    /// (C13 + C23)/2.
    pub c13: f64,
    /// Projected modulus C33.
    pub c33: f64,
    /// G13 = (C44 + C55)/2.
    pub g13: f64,
    /// G12 = (C11 + C22)/8 − C12/4 + C66/2, invariant under rotation about e3.
    pub g12: f64,
    /// Norm of what the projection discards over the norm of C (Mandel norm), dimensionless.
    pub residual: f64,
}

impl Stiffness {
    /// From 36 numbers in row-major order, Pa.
    pub fn from_row_major(c: &[f64; 36]) -> Self {
        Self(Matrix6::from_row_slice(c))
    }

    /// As 36 numbers in row-major order, Pa.
    pub fn row_major(&self) -> [f64; 36] {
        std::array::from_fn(|k| self.0[(k / 6, k % 6)])
    }

    /// Stiffness that gives the change of the Cauchy stress, from the second derivative of the energy per volume by a symmetric strain
    /// under `stress`, Pa, positive in compression (Wallace, Thermodynamics of Crystals, 1972). Under a pressure p it is p higher in
    /// C12, and p/2 lower in C44. Of a deviator the symmetric part is taken.
    #[must_use]
    pub fn of_cauchy_stress(&self, stress: &SymTensor) -> Self {
        let (s, one) = (stress.matrix(), Mat3::identity());
        let mut changed = self.0;
        for (i, j) in (0..3).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            for (k, l) in (0..3).flat_map(|k| (0..=k).map(move |l| (k, l))) {
                let turned = s[(i, k)] * one[(j, l)]
                    + s[(i, l)] * one[(j, k)]
                    + s[(j, k)] * one[(i, l)]
                    + s[(j, l)] * one[(i, k)];
                let dilated = s[(i, j)] * one[(k, l)] + one[(i, j)] * s[(k, l)];
                changed[(VOIGT[i][j], VOIGT[k][l])] += 0.5 * dilated - 0.25 * turned;
            }
        }
        Self(changed)
    }

    /// Voigt bulk modulus Θ = C_iijj/9 (isotropic strain), Pa.
    pub fn bulk_voigt(&self) -> f64 {
        self.0.fixed_view::<3, 3>(0, 0).sum() / 9.0
    }

    /// Shear modulus of the nearest isotropic stiffness (Voigt average), Pa.
    pub fn shear_isotropic(&self) -> f64 {
        let (c, normal) = (&self.0, self.0.fixed_view::<3, 3>(0, 0));
        (1.5 * normal.trace() - 0.5 * normal.sum() + 3.0 * (c[(3, 3)] + c[(4, 4)] + c[(5, 5)])) / 15.0
    }

    /// Poisson ratio of the nearest isotropic stiffness.
    pub fn poisson_isotropic(&self) -> f64 {
        let (bulk, shear) = (self.bulk_voigt(), self.shear_isotropic());
        (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear)
    }

    /// Reuss bulk modulus 1/S_iijj (isotropic stress), Pa; `None` if C is singular.
    pub fn bulk_reuss(&self) -> Option<f64> {
        let strain = self.isotropic_compression()?;
        Some(-1.0 / strain.trace())
    }

    /// Strain, per Pa, that a unit increment of isotropic pressure causes: −C⁻¹ : I. Tensor components; `None` if C is
    /// singular.
    pub fn isotropic_compression(&self) -> Option<SymTensor> {
        let load = Vector6::new(-1.0, -1.0, -1.0, 0.0, 0.0, 0.0);
        let e = self.0.lu().solve(&load)?;
        let e = SymTensor::from_voigt([e[0], e[1], e[2], 0.5 * e[3], 0.5 * e[4], 0.5 * e[5]]);
        e.is_finite().then_some(e)
    }

    /// Projection on the stiffnesses that are isotropic about e3.
    pub fn transverse_isotropy(&self) -> TransverseIsotropy {
        let c = |i: usize, j: usize| self.0[(i - 1, j - 1)];
        let c12_mean = 0.5 * (c(1, 2) + c(2, 1));
        let g12 = (c(1, 1) + c(2, 2)) / 8.0 - c12_mean / 4.0 + c(6, 6) / 2.0;
        // C11 + C12 (projected) is the invariant (C11 + C22 + 2 C12)/2, and C11 − C12 = 2 G12.
        let sum = (c(1, 1) + c(2, 2) + 2.0 * c12_mean) / 2.0;
        let c11 = sum / 2.0 + g12;
        let c12 = sum / 2.0 - g12;
        let c13 = (c(1, 3) + c(3, 1) + c(2, 3) + c(3, 2)) / 4.0;
        let (c33, g13) = (c(3, 3), 0.5 * (c(4, 4) + c(5, 5)));
        let mut t = TransverseIsotropy { c11, c12, c13, c33, g13, g12, residual: 0.0 };
        let difference = mandel(&(self.0 - t.stiffness().0)).norm();
        t.residual = difference / mandel(&self.0).norm();
        t
    }

    /// Projection on the stiffnesses that are isotropic about the unit vector `axis`; the moduli are those of a frame with
    /// that axis as e3.
    pub fn transverse_isotropy_about(&self, axis: &Vec3) -> TransverseIsotropy {
        if *axis == Vec3::z() {
            return self.transverse_isotropy();
        }
        // Half a turn about x takes −z to z.
        let opposite = || Rotation3::from_axis_angle(&Vec3::x_axis(), std::f64::consts::PI);
        let turn = Rotation3::rotation_between(axis, &Vec3::z()).unwrap_or_else(opposite);
        self.rotated(turn.matrix()).transverse_isotropy()
    }

    /// In Mandel form, where rows and columns of shear are multiplied by √2 and the matrix norm is the tensor's, Pa.
    pub fn mandel(&self) -> Matrix6<f64> {
        mandel(&self.0)
    }

    /// The stiffness in a frame turned by `rotation` (columns: the old axes in the new frame; v' = R v).
    pub fn rotated(&self, rotation: &Mat3) -> Self {
        let full = self.full();
        let mut out = Matrix6::zeros();
        for a in 0..6 {
            for b in 0..6 {
                let ((i, j), (k, l)) = (PAIRS[a], PAIRS[b]);
                let mut sum = 0.0;
                for (index, value) in full.iter().enumerate() {
                    let (p, q, r, s) = (index / 27, index / 9 % 3, index / 3 % 3, index % 3);
                    sum += rotation[(i, p)] * rotation[(j, q)] * rotation[(k, r)] * rotation[(l, s)] * value;
                }
                out[(a, b)] = sum;
            }
        }
        Self(out)
    }

    fn full(&self) -> [f64; 81] {
        std::array::from_fn(|n| self.0[(VOIGT[n / 27][n / 9 % 3], VOIGT[n / 3 % 3][n % 3])])
    }
}

impl TransverseIsotropy {
    /// The medium with these five constants: C11, C33, C13, C44 = G13 and C66 = G12.
    pub const fn of_constants(c11: f64, c33: f64, c13: f64, g13: f64, g12: f64) -> Self {
        Self { c11, c12: c11 - 2.0 * g12, c13, c33, g13, g12, residual: 0.0 }
    }

    /// The stiffness with these moduli.
    pub fn stiffness(&self) -> Stiffness {
        let mut m = Matrix6::zeros();
        for i in 0..2 {
            m[(i, i)] = self.c11;
            m[(i, 1 - i)] = self.c12;
            m[(i, 2)] = self.c13;
            m[(2, i)] = self.c13;
        }
        m[(2, 2)] = self.c33;
        m[(3, 3)] = self.g13;
        m[(4, 4)] = self.g13;
        m[(5, 5)] = self.g12;
        Stiffness(m)
    }
}

const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
pub(crate) const VOIGT: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];

/// Voigt to Mandel, in which the matrix norm is the tensor norm.
fn mandel(c: &Matrix6<f64>) -> Matrix6<f64> {
    let w = |i: usize| if i < 3 { 1.0 } else { std::f64::consts::SQRT_2 };
    Matrix6::from_fn(|i, j| c[(i, j)] * w(i) * w(j))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn sample() -> Stiffness {
        let t = TransverseIsotropy::of_constants(360.0, 400.0, 70.0, 150.0, 140.0);
        t.stiffness()
    }

    #[test]
    fn an_isotropic_stiffness_has_its_own_shear_modulus_and_poisson_ratio() {
        let (lame, shear) = (3.0, 2.0);
        let diagonal =
            Matrix6::from_diagonal(&[2.0 * shear, 2.0 * shear, 2.0 * shear, shear, shear, shear].into());
        let of = Stiffness(diagonal + Matrix6::from_fn(|i, j| if i < 3 && j < 3 { lame } else { 0.0 }));
        assert!((of.shear_isotropic() - shear).abs() < 1e-14);
        assert!((of.poisson_isotropic() - lame / (2.0 * (lame + shear))).abs() < 1e-15);
    }

    #[test]
    fn projection_leaves_a_transversely_isotropic_stiffness_alone() {
        let t = sample().transverse_isotropy();
        assert!((t.stiffness().0 - sample().0).amax() < 1e-12 && t.residual < 1e-15);
        assert!((t.c11 - 360.0).abs() < 1e-12 && (t.g12 - 140.0).abs() < 1e-12);
    }

    #[test]
    fn projected_moduli_do_not_depend_on_a_rotation_about_the_axis() {
        let mut c = sample();
        c.0[(0, 0)] = 390.0;
        c.0[(5, 5)] = 120.0;
        let turned = c.rotated(Rotation3::from_axis_angle(&Vector3::z_axis(), 0.7).matrix());
        let (a, b) = (c.transverse_isotropy(), turned.transverse_isotropy());
        for (x, y) in [(a.c11, b.c11), (a.c12, b.c12), (a.g12, b.g12), (a.g13, b.g13), (a.c13, b.c13)] {
            assert!((x - y).abs() < 1e-11, "{x} {y}");
        }
        assert!((a.residual - b.residual).abs() < 1e-12 && a.residual > 0.01);
    }

    #[test]
    fn rotating_back_restores_every_entry() {
        let r = Rotation3::from_euler_angles(0.3, -0.8, 1.9);
        let back = sample().rotated(r.matrix()).rotated(&r.matrix().transpose());
        assert!((back.0 - sample().0).amax() < 1e-11);
    }

    #[test]
    fn reuss_bulk_modulus_lies_below_voigt() {
        let c = sample();
        assert!((c.bulk_voigt() - (2.0 * 360.0 + 400.0 + 2.0 * 80.0 + 4.0 * 70.0) / 9.0).abs() < 1e-12);
        assert!(c.bulk_reuss().unwrap() < c.bulk_voigt());
        assert!(Stiffness(Matrix6::zeros()).bulk_reuss().is_none());
    }
}
