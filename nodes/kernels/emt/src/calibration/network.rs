//! Relaxed contact networks: what their moduli depend on.

use nalgebra::SMatrix;

/// Coordination number at which a network of frictional grains is isostatic: 3 z/2 force components for 6 degrees of
/// freedom a grain. Its response to a change of coordination diverges there.
pub(crate) const ISOSTATIC: f64 = 4.0;

/// (z − 4)/z below which the scatter of packings is taken to grow no further; the packings seen end there.
const LEAST_EXCESS: f64 = 0.1;

/// Number of quantities whose scatter is known: five invariants of the stiffness, ε by stiffness and k.
pub(crate) const SCATTERED: usize = 7;

/// Covariance of the scatter of packings of one structure.
pub(crate) type Scatter = SMatrix<f64, SCATTERED, SCATTERED>;

/// Constants of the model `relaxed`, for moduli in units of E*^⅔ p^⅓, what Hertz contacts make of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// Bulk modulus.
    pub theta: Law,
    /// Shear modulus of the isotropic part.
    pub shear: Law,
    /// Dilatational deviator over ε.
    pub dilatation: Amplitude,
    /// Voigt deviator over ε.
    pub voigt: Amplitude,
    /// Harmonic part over ε.
    pub harmonic: Amplitude,
    /// ε weighted by contact stiffness over ε.
    pub eps_stiffness: Amplitude,
    /// Share of rattlers 1 − k/z = exp(r0 + r1 z + r2 ln(φ/φ0) + r3 ln(p/p0)).
    pub rattlers: [f64; 4],
    /// Scatter of (ln Θ, ln G, D, V, H, ε by stiffness, k) times (z − 4)/z: what packings of the same z, ε, φ and p still
    /// differ by, row-major.
    pub scatter: [[f64; SCATTERED]; SCATTERED],
    /// Lowest and highest z of the packings.
    pub z: [f64; 2],
    /// Lowest and highest ε of the packings.
    pub eps: [f64; 2],
    /// Mean and standard deviation of ε over the packings.
    pub eps_spread: [f64; 2],
    /// Mean φ0 and standard deviation of the solid fraction over the packings.
    pub solid_fraction: [f64; 2],
    /// Lowest and highest solid fraction of the packings.
    pub solid_fractions: [f64; 2],
    /// Pressure p0 that the laws refer to, Pa.
    pub pressure: f64,
    /// Grains in each packing: the scatter is that of samples of this size.
    pub grains: u32,
}

/// ln X = a + b ln z + c ln(z − z0) + d ln(φ/φ0) + e ln(p/p0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// a.
    pub level: f64,
    /// b.
    pub by_z: f64,
    /// c.
    pub by_excess: f64,
    /// z0, below every z of the packings.
    pub onset: f64,
    /// d.
    pub by_solid_fraction: f64,
    /// e.
    pub by_pressure: f64,
}

impl Law {
    /// ln X, with ln(φ/φ0) and ln(p/p0).
    pub(crate) fn value(&self, z: f64, ln_phi: f64, ln_p: f64) -> f64 {
        self.level
            + self.by_z * z.ln()
            + self.by_excess * (z - self.onset).ln()
            + self.by_solid_fraction * ln_phi
            + self.by_pressure * ln_p
    }

    /// Its slope by z.
    pub(crate) fn slope(&self, z: f64) -> f64 {
        self.by_z / z + self.by_excess / (z - self.onset)
    }
}

/// a(z) = a0 + a1 z/(z − 4): the response of a network to anisotropy of its contacts. Where a modulus goes as (z − 4)/z,
/// more contacts in one direction change it by d ln G/d ln z = 4/(z − 4) in parts of itself: the second term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amplitude {
    /// a0.
    pub constant: f64,
    /// a1.
    pub critical: f64,
}

impl Amplitude {
    pub(crate) fn value(&self, z: f64) -> f64 {
        self.constant + self.critical * z / (z - ISOSTATIC)
    }

    pub(crate) fn slope(&self, z: f64) -> f64 {
        -self.critical * ISOSTATIC / (z - ISOSTATIC).powi(2)
    }
}

impl Network {
    /// The z that the model predicts for: the packings' and a little beyond, where the laws still rise.
    pub(crate) fn domain(&self) -> [f64; 2] {
        [(self.z[0] - 0.05).max(ISOSTATIC + 0.05), self.z[1] + 0.3]
    }

    /// The ε that the model predicts for: to first order in ε, twice the packings'.
    pub(crate) fn domain_of_eps(&self) -> [f64; 2] {
        let reach = 2.0 * self.eps[0].abs().max(self.eps[1].abs());
        [-reach, reach]
    }

    /// What the scatter is divided by at this z: fluctuations grow towards the isostatic point.
    pub(crate) fn excess(z: f64) -> f64 {
        ((z - ISOSTATIC) / z).max(LEAST_EXCESS)
    }

    /// Covariance of the scatter at this z, `wider` than that of the packings.
    pub(crate) fn scatter_at(&self, z: f64, wider: f64) -> Scatter {
        let excess = Self::excess(z);
        Scatter::from_fn(|i, j| self.scatter[i][j]) * (wider / (excess * excess))
    }

    /// How much larger the variance of samples of this size is. Fewer grains scatter more, as their number; with more, what
    /// preparations differ by is left, which no number of grains takes away.
    pub(crate) fn wider(&self, grains: Option<u32>) -> f64 {
        grains.map_or(1.0, |n| (f64::from(self.grains) / f64::from(n.max(1))).max(1.0))
    }

    /// ln(1 − k/z).
    pub(crate) fn ln_rattlers(&self, z: f64, ln_phi: f64, ln_p: f64) -> f64 {
        let [level, by_z, by_phi, by_p] = self.rattlers;
        level + by_z * z + by_phi * ln_phi + by_p * ln_p
    }
}
