//! The constants of the model of relaxed contact networks.

use super::error::{CalibrationError, constant};
use super::laws::{
    DeviatorLaw, ISOSTATIC, NetworkState, REFERENCE_PRESSURE, REFERENCE_STIFFNESS_RATIO, RattlerLaw,
    ScalingLaw,
};
use super::reach::Reach;
use grainlab_core::Material;
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// (z − 4)/z below which the scatter is taken as constant: no packing of the calibration is closer to the
/// isostatic point.
const MIN_EXCESS: f64 = 0.05;

/// Least and largest share of the variance of packings of 2,000 grains that is due to their size: packings of 8,000 grains by
/// the same recipes (`tests/golden/ensembles/large.csv`) have .67 (ε) to .55 (ε weighted by stiffness) of the variance, and
/// would have a quarter if all of it were.
const OF_THE_SAMPLE: [f64; 2] = [0.45, 0.6];

/// Relative standard deviation of the effect of q/p on the stiffness at unchanged contacts. Packings that were pressed at a low
/// friction and then sheared at a high one, within the elastic range, have .65 to .85 of the effect in the packings taught
/// (`tests/golden/ensembles/locked.csv`).
pub(crate) const RESPONSE_STDDEV: f64 = 0.25;

/// Number of quantities whose scatter is known: five invariants of the stiffness, ε weighted by stiffness, and k.
pub const SCATTERED: usize = 7;

/// The scattered quantities whose scatter changes alike with the state: scalars, deviators with the ε weighted by stiffness, k.
pub const GROUPS: [Range<usize>; 3] = [0..2, 2..6, 6..7];

/// Covariance of the scatter of packings with the same structure.
pub type Scatter = SMatrix<f64, SCATTERED, SCATTERED>;

/// Constants of the model `relaxed`, for moduli in units of E*^⅔ p^⅓, the scaling of Hertz contacts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelaxationCalibration {
    /// Number of grains of each packing: the scatter is that of samples of this size.
    pub grains: u32,
    /// Number of recipes, each left out in turn to find the scatter.
    pub recipes: u32,
    /// Mean and standard deviation of ε over the packings.
    pub eps_spread: [f64; 2],
    /// Law of k.
    pub rattlers: RattlerLaw,
    /// h0 and h1 of the two scalars, of the deviators with the ε weighted by stiffness, and of k: the variance of their
    /// scatter is multiplied by exp(h0 s² + h1 ln p), with s² the variance of the radii.
    pub scatter_by_state: [[f64; 2]; GROUPS.len()],
    /// Covariance of (ln Θ, ln G, D, V, H, ε weighted by stiffness, k) of packings of the same z, ε and state, left out by
    /// their recipes, all but k multiplied by (z − 4)/z; row-major.
    pub scatter: [[f64; SCATTERED]; SCATTERED],
    /// Ranges of the packings.
    pub reach: Reach,
    /// Law of the dilatational deviator.
    pub dilatation: DeviatorLaw,
    /// Law of the Voigt deviator.
    pub voigt: DeviatorLaw,
    /// Law of the harmonic part.
    pub harmonic: DeviatorLaw,
    /// ε weighted by contact stiffness.
    pub eps_stiffness: DeviatorLaw,
    /// Law of the bulk modulus.
    pub theta: ScalingLaw,
    /// Shear modulus of the isotropic part.
    pub shear: ScalingLaw,
}

impl NetworkState {
    /// State of grains of this material at this pressure, Pa, with this standard deviation of the radii over their mean and q/p.
    pub fn of(pressure: f64, material: &Material, size_spread: f64, stress_ratio: f64) -> Self {
        let stiffness_ratio = material.stiffness_ratio();
        Self {
            ln_pressure: (pressure / material.effective_young() / REFERENCE_PRESSURE).ln(),
            stiffness_ratio: stiffness_ratio - REFERENCE_STIFFNESS_RATIO,
            size_variance: size_spread * size_spread,
            stress_ratio,
        }
    }
}

impl RelaxationCalibration {
    /// Range of the search for z: slightly wider than that of the packings, where the laws still rise.
    pub(crate) fn domain(&self) -> [f64; 2] {
        let [low, high] = self.reach.z;
        [(low - 0.1).max(ISOSTATIC + 0.05), high + 0.3]
    }

    /// (z − 4)/z, by which the scatter of all but k is divided: fluctuations grow towards the isostatic point.
    pub fn excess(z: f64) -> f64 {
        ((z - ISOSTATIC) / z).max(MIN_EXCESS)
    }

    /// By what the residual of each scattered quantity is multiplied at this z.
    pub fn weights(z: f64) -> [f64; SCATTERED] {
        let w = Self::excess(z);
        [w, w, w, w, w, w, 1.0]
    }

    /// Factors of the variances of the scatter in this state.
    pub fn growth(by_state: &[[f64; 2]; GROUPS.len()], state: &NetworkState) -> [f64; SCATTERED] {
        let mut factors = [1.0; SCATTERED];
        for (group, [by_sizes, by_pressure]) in GROUPS.into_iter().zip(by_state) {
            factors[group].fill((by_sizes * state.size_variance + by_pressure * state.ln_pressure).exp());
        }
        factors
    }

    /// Covariance of the scatter at this z, with the variance of each quantity multiplied by its factor.
    pub(crate) fn scatter_at(&self, z: f64, factors: &[f64; SCATTERED]) -> Scatter {
        let w = Self::weights(z);
        Scatter::from_fn(|i, j| self.scatter[i][j] * (factors[i] * factors[j]).sqrt() / (w[i] * w[j]))
    }

    /// Covariance of the scatter at this z in this state: under a deviator, with that of its effect.
    pub(crate) fn scatter_in(&self, z: f64, factors: &[f64; SCATTERED], state: &NetworkState) -> Scatter {
        let mut by_stress = SVector::<f64, SCATTERED>::zeros();
        for (i, law) in
            [&self.dilatation, &self.voigt, &self.harmonic, &self.eps_stiffness].into_iter().enumerate()
        {
            by_stress[2 + i] = RESPONSE_STDDEV * law.by_stress_ratio(z, state) * state.stress_ratio;
        }
        self.scatter_at(z, factors) + by_stress * by_stress.transpose()
    }

    /// Variances of the scatter of samples of this size over those of the packings. Only the share that is due to the size of the
    /// sample changes as the inverse of the number of grains, and none of that of k in larger samples: differences between
    /// recipes remain at any size. The share is that with the larger variance.
    pub(crate) fn variance_factors(&self, grains: Option<u32>) -> [f64; SCATTERED] {
        // A sample of unknown size counts as the packings.
        let ratio = grains.map_or(1.0, |n| f64::from(self.grains) / f64::from(n.max(1)));
        let [least, largest] = OF_THE_SAMPLE;
        let share = if ratio > 1.0 { largest } else { least };
        let moduli = 1.0 - share + share * ratio;
        let k = moduli.max(1.0);
        [moduli, moduli, moduli, moduli, moduli, moduli, k]
    }

    /// Conditions for a unique inversion: moduli that rise with z, a stiff network, and a valid covariance of
    /// the scatter.
    pub(super) fn check(&self) -> Result<(), CalibrationError> {
        const RANGE: &str = "it must be a range, low and high";
        let Reach { z, eps, pressure, stiffness_ratio, size_spread, stress_ratio } = self.reach;
        let above = z[0] > ISOSTATIC && z[0] < z[1] && z[1].is_finite();
        constant("network.reach.z", z[0], above, "it must be a range above 4, low and high")?;
        constant("network.reach.eps", eps[0], eps[0] < eps[1], RANGE)?;
        constant("network.reach.pressure", pressure[0], pressure[0] > 0.0, "it must be positive")?;
        for (field, [low, high]) in [
            ("network.reach.pressure", pressure),
            ("network.reach.stiffness_ratio", stiffness_ratio),
            ("network.reach.size_spread", size_spread),
            ("network.reach.stress_ratio", stress_ratio),
        ] {
            constant(field, low, low <= high && low.is_finite() && high.is_finite(), RANGE)?;
        }
        constant("network.grains", f64::from(self.grains), self.grains > 0, "it must be positive")?;
        let [from, to] = self.domain();
        for (field, law) in [("network.theta", &self.theta), ("network.shear", &self.shear)] {
            constant(field, law.onset, law.onset < from, "the onset must lie below every z")?;
            for state in self.reach.corners() {
                for i in 0..=50 {
                    let slope = law.slope(from + (to - from) * f64::from(i) / 50.0, &state);
                    let rises = "the modulus must rise with z wherever the model is used";
                    constant(field, slope, slope > 0.0, rises)?;
                }
            }
        }
        let scatter = Scatter::from_fn(|i, j| self.scatter[i][j]);
        let finite = scatter.iter().all(|v| v.is_finite());
        let lowest = if finite { scatter.symmetric_eigenvalues().min() } else { f64::NAN };
        let symmetric = scatter == scatter.transpose();
        let valid = symmetric && lowest > 0.0;
        constant("network.scatter", lowest, valid, "it must be a covariance, of positive eigenvalues")
    }
}
