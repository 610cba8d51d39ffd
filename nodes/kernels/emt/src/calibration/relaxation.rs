//! The scaling laws for the moduli of relaxed contact networks.

use super::error::{CalibrationError, constant};
use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};

/// Coordination number at which a network of frictional grains is isostatic: 3 z/2 force components for 6 degrees of
/// freedom per grain. Its response to a change of coordination diverges there.
pub(crate) const ISOSTATIC: f64 = 4.0;

/// (z − 4)/z below which the scatter is taken as constant: no packing of the calibration is closer to the
/// isostatic point.
const MIN_EXCESS: f64 = 0.1;

/// Number of quantities whose scatter is known: five invariants of the stiffness, ε weighted by stiffness, and k.
pub(crate) const SCATTERED: usize = 7;

/// Covariance of the scatter of packings with the same structure.
pub(crate) type Scatter = SMatrix<f64, SCATTERED, SCATTERED>;

/// Constants of the model `relaxed`, for moduli in units of E*^⅔ p^⅓, the scaling of Hertz contacts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelaxationCalibration {
    /// Number of grains of each packing: the scatter is that of samples of this size.
    pub grains: u32,
    /// Reference pressure p0 of the laws, Pa.
    pub pressure: f64,
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
    /// Fraction of rattlers 1 − k/z = exp(r0 + r1 z + r2 ln(φ/φ0) + r3 ln(p/p0)).
    pub rattlers: [f64; 4],
    /// Dilatational deviator over ε.
    pub dilatation: AmplitudeLaw,
    /// Voigt deviator over ε.
    pub voigt: AmplitudeLaw,
    /// Harmonic part over ε.
    pub harmonic: AmplitudeLaw,
    /// ε weighted by contact stiffness over ε.
    pub eps_stiffness: AmplitudeLaw,
    /// Covariance of (ln Θ, ln G, D, V, H, ε weighted by stiffness, k) of packings of the same z, ε, φ and p, each
    /// multiplied by (z − 4)/z; row-major.
    pub scatter: [[f64; SCATTERED]; SCATTERED],
    /// Bulk modulus.
    pub theta: ScalingLaw,
    /// Shear modulus of the isotropic part.
    pub shear: ScalingLaw,
}

/// ln X = a + b ln z + c ln(z − z0) + d ln(φ/φ0) + e ln(p/p0).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScalingLaw {
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

impl ScalingLaw {
    /// ln X, with ln(φ/φ0) and ln(p/p0).
    pub(crate) fn value(&self, z: f64, ln_phi: f64, ln_p: f64) -> f64 {
        self.level
            + self.by_z * z.ln()
            + self.by_excess * (z - self.onset).ln()
            + self.by_solid_fraction * ln_phi
            + self.by_pressure * ln_p
    }

    /// d ln X/dz.
    pub(crate) fn slope(&self, z: f64) -> f64 {
        self.by_z / z + self.by_excess / (z - self.onset)
    }
}

/// a(z) = a0 + a1 z/(z − 4): the response of a network to the anisotropy of its contacts. The second term: where a
/// modulus is proportional to (z − 4)/z, more contacts in one direction change it by d ln G/d ln z = 4/(z − 4).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct AmplitudeLaw {
    /// a0.
    pub constant: f64,
    /// a1.
    pub critical: f64,
}

impl From<[f64; 2]> for AmplitudeLaw {
    fn from([constant, critical]: [f64; 2]) -> Self {
        Self { constant, critical }
    }
}

impl From<AmplitudeLaw> for [f64; 2] {
    fn from(law: AmplitudeLaw) -> Self {
        [law.constant, law.critical]
    }
}

impl AmplitudeLaw {
    pub(crate) fn value(&self, z: f64) -> f64 {
        self.constant + self.critical * z / (z - ISOSTATIC)
    }

    pub(crate) fn slope(&self, z: f64) -> f64 {
        -self.critical * ISOSTATIC / (z - ISOSTATIC).powi(2)
    }
}

impl RelaxationCalibration {
    /// Range of z of the model: slightly wider than that of the packings, where the laws still rise.
    pub(crate) fn domain(&self) -> [f64; 2] {
        [(self.z[0] - 0.05).max(ISOSTATIC + 0.05), self.z[1] + 0.3]
    }

    /// Range of ε of the model: twice that of the packings, since the model is linear in ε.
    pub(crate) fn domain_of_eps(&self) -> [f64; 2] {
        let reach = 2.0 * self.eps[0].abs().max(self.eps[1].abs());
        [-reach, reach]
    }

    /// (z − 4)/z, by which the scatter is divided: fluctuations grow towards the isostatic point.
    pub(crate) fn excess(z: f64) -> f64 {
        ((z - ISOSTATIC) / z).max(MIN_EXCESS)
    }

    /// Covariance of the scatter at this z, times `variance_factor`.
    pub(crate) fn scatter_at(&self, z: f64, variance_factor: f64) -> Scatter {
        let excess = Self::excess(z);
        Scatter::from_fn(|i, j| self.scatter[i][j]) * (variance_factor / (excess * excess))
    }

    /// Variance of the scatter of samples of this size over that of the packings. It grows as the inverse of the number
    /// of grains, but does not fall below 1 for larger samples: differences between preparations remain at any size.
    pub(crate) fn variance_factor(&self, grains: Option<u32>) -> f64 {
        grains.map_or(1.0, |n| (f64::from(self.grains) / f64::from(n.max(1))).max(1.0))
    }

    /// ln(1 − k/z).
    pub(crate) fn ln_rattlers(&self, z: f64, ln_phi: f64, ln_p: f64) -> f64 {
        let [level, by_z, by_phi, by_p] = self.rattlers;
        level + by_z * z + by_phi * ln_phi + by_p * ln_p
    }

    /// Conditions for a unique inversion: moduli that rise with z, a stiff network, and a valid covariance of
    /// the scatter.
    pub(super) fn check(&self) -> Result<(), CalibrationError> {
        const RANGE: &str = "it must be a range, low and high";
        let [low, high] = self.z;
        constant(
            "network.z",
            low,
            low > ISOSTATIC && low < high && high.is_finite(),
            "it must be a range above 4, low and high",
        )?;
        constant("network.eps", self.eps[0], self.eps[0] < self.eps[1], RANGE)?;
        constant("network.pressure", self.pressure, self.pressure > 0.0, "it must be positive")?;
        let phi = self.solid_fraction[0];
        constant("network.solid_fraction", phi, phi > 0.0 && phi < 1.0, "it must lie in (0, 1)")?;
        let [from, to] = self.domain();
        for (field, law) in [("network.theta", &self.theta), ("network.shear", &self.shear)] {
            constant(field, law.onset, law.onset < from, "the onset must lie below every z")?;
            for i in 0..=50 {
                let slope = law.slope(from + (to - from) * f64::from(i) / 50.0);
                constant(
                    field,
                    slope,
                    slope > 0.0,
                    "the modulus must rise with z wherever the model is used",
                )?;
            }
        }
        let scatter = Scatter::from_fn(|i, j| self.scatter[i][j]);
        let finite = scatter.iter().all(|v| v.is_finite());
        let lowest = if finite { scatter.symmetric_eigenvalues().min() } else { f64::NAN };
        let symmetric = scatter == scatter.transpose();
        constant(
            "network.scatter",
            lowest,
            symmetric && lowest > 0.0,
            "it must be a covariance, of positive eigenvalues",
        )
    }
}
