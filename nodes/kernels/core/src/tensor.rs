//! Small vectors and tensors.

/// A vector of three Cartesian components.
pub type Vec3 = nalgebra::Vector3<f64>;

/// A general second-order tensor, 3×3.
pub type Mat3 = nalgebra::Matrix3<f64>;

/// A symmetric second-order tensor; unit and sign are those of the quantity it holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SymTensor {
    /// Component along x, x.
    pub xx: f64,
    /// Component along y, y.
    pub yy: f64,
    /// Component along z, z.
    pub zz: f64,
    /// Component along y, z (tensor component, not engineering shear).
    pub yz: f64,
    /// Component along x, z.
    pub xz: f64,
    /// Component along x, y.
    pub xy: f64,
}

impl SymTensor {
    /// Names of the components, in Voigt order.
    pub const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "yz", "xz", "xy"];

    /// `value` times the identity.
    pub const fn isotropic(value: f64) -> Self {
        Self { xx: value, yy: value, zz: value, yz: 0.0, xz: 0.0, xy: 0.0 }
    }

    /// From Voigt order xx, yy, zz, yz, xz, xy (tensor components).
    pub const fn from_voigt(v: [f64; 6]) -> Self {
        Self { xx: v[0], yy: v[1], zz: v[2], yz: v[3], xz: v[4], xy: v[5] }
    }

    /// In Voigt order xx, yy, zz, yz, xz, xy (tensor components).
    pub const fn voigt(&self) -> [f64; 6] {
        [self.xx, self.yy, self.zz, self.yz, self.xz, self.xy]
    }

    /// The symmetric part of `m`.
    pub fn symmetric_part(m: &Mat3) -> Self {
        Self {
            xx: m[(0, 0)],
            yy: m[(1, 1)],
            zz: m[(2, 2)],
            yz: 0.5 * (m[(1, 2)] + m[(2, 1)]),
            xz: 0.5 * (m[(0, 2)] + m[(2, 0)]),
            xy: 0.5 * (m[(0, 1)] + m[(1, 0)]),
        }
    }

    /// Logarithmic (Hencky) strain of the deformation gradient `f`: ln V of its left stretch V = √(F Fᵀ), positive in
    /// extension, on the present axes, like stress and fabric; independent of the rotation of F = V R.
    pub fn logarithmic_strain(f: &Mat3) -> Self {
        let left = (f * f.transpose()).symmetric_eigen();
        let logs = left.eigenvalues.map(|v| 0.5 * v.ln());
        let q = left.eigenvectors;
        Self::symmetric_part(&(q * Mat3::from_diagonal(&logs) * q.transpose()))
    }

    /// As a full matrix.
    pub fn matrix(&self) -> Mat3 {
        Mat3::new(
            self.xx, self.xy, self.xz, //
            self.xy, self.yy, self.yz, //
            self.xz, self.yz, self.zz,
        )
    }

    /// Sum of the diagonal.
    pub fn trace(&self) -> f64 {
        self.xx + self.yy + self.zz
    }

    /// A third of the trace: the pressure, if this is a stress.
    pub fn mean(&self) -> f64 {
        self.trace() / 3.0
    }

    /// Deviatoric invariant √(3/2 s:s) with s the deviator: q, if this is a stress.
    pub fn deviatoric_invariant(&self) -> f64 {
        let m = self.mean();
        let (x, y, z) = (self.xx - m, self.yy - m, self.zz - m);
        let off = self.yz * self.yz + self.xz * self.xz + self.xy * self.xy;
        (1.5 * (x * x + y * y + z * z + 2.0 * off)).sqrt()
    }

    /// Component along the unit vector `axis`: axis·T·axis.
    pub fn along(&self, axis: &Vec3) -> f64 {
        axis.dot(&(self.matrix() * axis))
    }

    /// (σ_hh − (tr σ − σ_hh)/2)/p about the unit vector `axis` h, with p = tr σ/3, of a stress positive in compression;
    /// `None` without pressure.
    pub fn axial_ratio(&self, axis: &Vec3) -> Option<f64> {
        let (p, along) = (self.mean(), self.along(axis));
        (p > 0.0).then(|| 1.5 * (along / p - 1.0))
    }

    /// The deviator: this less its mean on the diagonal.
    pub fn deviator(&self) -> Self {
        let m = self.mean();
        Self { xx: self.xx - m, yy: self.yy - m, zz: self.zz - m, ..*self }
    }

    /// Full contraction T:U with another.
    pub fn contract(&self, other: &Self) -> f64 {
        let off = self.yz * other.yz + self.xz * other.xz + self.xy * other.xy;
        self.xx * other.xx + self.yy * other.yy + self.zz * other.zz + 2.0 * off
    }

    /// True if every component is finite.
    pub fn is_finite(&self) -> bool {
        self.voigt().iter().all(|v| v.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniaxial_stress_has_its_own_magnitude_as_deviatoric_invariant() {
        let s = SymTensor { zz: 7.0, ..SymTensor::default() };
        assert!((s.deviatoric_invariant() - 7.0).abs() < 1e-14);
    }

    #[test]
    fn logarithmic_strain_ignores_the_rotation_before_and_turns_with_the_one_after() {
        let stretch = Mat3::from_diagonal(&Vec3::new(0.98f64.exp(), (-0.3f64).exp(), 0.1f64.exp()));
        let r = nalgebra::Rotation3::from_euler_angles(0.4, -0.2, 1.1);
        let before = SymTensor::logarithmic_strain(&(stretch * r.matrix())).matrix();
        let expected = Mat3::from_diagonal(&Vec3::new(0.98, -0.3, 0.1));
        assert!((before - expected).amax() < 1e-14);
        let after = SymTensor::logarithmic_strain(&(r.matrix() * stretch)).matrix();
        assert!((after - r.matrix() * expected * r.matrix().transpose()).amax() < 1e-14);
    }

    #[test]
    fn symmetric_part_drops_the_spin() {
        let spin = Mat3::new(0.0, 1.0, -2.0, -1.0, 0.0, 3.0, 2.0, -3.0, 0.0);
        assert_eq!(SymTensor::symmetric_part(&spin), SymTensor::default());
    }
}
