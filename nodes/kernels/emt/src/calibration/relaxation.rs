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

/// Share of the variance between samples of one recipe that is inverse to the number of grains: for the moduli and ε weighted by
/// stiffness as the tests of `grainlab_calibration` fit it. Whether a grain is a rattler is decided grain by grain, so all of k's is.
const SHARE_OF_SIZE: [f64; SCATTERED] = [0.45, 0.45, 0.45, 0.45, 0.45, 0.45, 1.0];

/// Range of a number of grains that is not known, uniform in its logarithm: from small simulations to large ones.
const UNKNOWN_GRAINS: [f64; 2] = [100.0, 20_000.0];

/// Returns the inverse of a number of grains; of an unknown number its mean over [`UNKNOWN_GRAINS`].
pub(crate) fn inverse_grains(grains: Option<u32>) -> f64 {
    let [low, high] = UNKNOWN_GRAINS;
    grains.map_or((1.0 / low - 1.0 / high) / (high / low).ln(), |n| 1.0 / f64::from(n.max(1)))
}

/// Relative standard deviation of the effect of q/p on the stiffness at unchanged contacts. Packings that were pressed at a low
/// friction and then sheared at a high one have 0.7 to 0.8 of the effect in the packings taught; the tests of `grainlab_calibration` fit
/// it to `tests/golden/ensembles/locked.csv`.
pub const RESPONSE_STDDEV: f64 = 0.29;

/// Number of quantities whose scatter is known: five invariants of the stiffness, ε weighted by stiffness, and k.
pub const SCATTERED: usize = 7;

/// The scattered quantities whose scatter changes alike with the state: scalars, deviators with the ε weighted by stiffness, k.
pub const GROUPS: [Range<usize>; 3] = [0..2, 2..6, 6..7];

/// Covariance of (ln Θ, ln G, D, V, H, ε weighted by stiffness, k) of packings with the same structure.
pub type Scatter = SMatrix<f64, SCATTERED, SCATTERED>;

/// How far packings are from the laws, in two levels.
///
/// The covariances are those of residuals from laws that were learned without the recipe of the packing, at the reference state;
/// row-major. A residual of a level is first multiplied by its weight at z, see [`ScatterLevels::weights`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScatterLevels {
    /// Covariance between recipes, the same in samples of any size.
    pub recipe: [[f64; SCATTERED]; SCATTERED],
    /// Covariance between samples of [`RelaxationCalibration::grains`] grains of one recipe.
    pub sample: [[f64; SCATTERED]; SCATTERED],
}

impl ScatterLevels {
    /// Weights of the residuals at this z, of recipes and of samples.
    ///
    /// Fluctuations of a sample grow towards the isostatic point as z/(z − 4), and so do those of the deviators of a recipe. The bulk
    /// and the shear modulus of a recipe are off by the same factor at any z.
    pub fn weights(z: f64) -> [[f64; SCATTERED]; 2] {
        let w = RelaxationCalibration::excess(z);
        [[1.0, 1.0, w, w, w, w, 1.0], [w, w, w, w, w, w, 1.0]]
    }

    /// The levels as matrices.
    pub fn matrices(&self) -> [Scatter; 2] {
        [self.recipe, self.sample].map(|level| Scatter::from_fn(|i, j| level[i][j]))
    }
}

/// Constants of the model `relaxed`, for moduli in units of E*^⅔ p^⅓, the scaling of Hertz contacts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelaxationCalibration {
    /// Median number of grains of the packings: [`ScatterLevels::sample`] is that of samples of this size.
    pub grains: u32,
    /// Number of recipes, each left out in turn to find the scatter.
    pub recipes: u32,
    /// Mean and standard deviation of ε over the packings.
    pub eps_spread: [f64; 2],
    /// Law of k.
    pub rattlers: RattlerLaw,
    /// h0 and h1 of the two scalars, of the deviators with the ε weighted by stiffness, and of k: the variance of their
    /// scatter is multiplied by (1 + h0 s²) exp(h1 ln p), with s² the variance of the radii.
    pub scatter_by_state: [[f64; 2]; GROUPS.len()],
    /// Scatter of packings about the laws.
    pub scatter: ScatterLevels,
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

    /// Factors of the variances of the scatter in this state.
    pub fn growth(by_state: &[[f64; 2]; GROUPS.len()], state: &NetworkState) -> [f64; SCATTERED] {
        let mut factors = [1.0; SCATTERED];
        for (group, growth) in GROUPS.into_iter().zip(by_state) {
            factors[group].fill(Self::growth_of(*growth, state.size_variance, state.ln_pressure));
        }
        factors
    }

    /// Factor of a variance by h0 and h1.
    pub fn growth_of([by_sizes, by_pressure]: [f64; 2], size_variance: f64, ln_pressure: f64) -> f64 {
        (1.0 + by_sizes * size_variance) * (by_pressure * ln_pressure).exp()
    }

    /// Factors of the variances of [`ScatterLevels::sample`] for samples of another size; an unknown size has the mean over
    /// 100 to 20,000 grains, uniform in its logarithm.
    ///
    /// The rest of the variance is due to other differences between samples of one recipe, and is the same at any size.
    pub fn sample_variances(grains: u32, of: Option<u32>) -> [f64; SCATTERED] {
        let inverse = inverse_grains(of);
        SHARE_OF_SIZE.map(|share| 1.0 - share + share * f64::from(grains) * inverse)
    }

    /// Returns the levels of the scatter of samples of so many grains, with the variance of each quantity multiplied by its factor of the
    /// state.
    pub(crate) fn scatter_of(&self, grains: Option<u32>, by_state: &[f64; SCATTERED]) -> [Scatter; 2] {
        let of_size = Self::sample_variances(self.grains, grains);
        let [recipe, sample] = self.scatter.matrices();
        let scaled = |level: &Scatter, by: &[f64; SCATTERED]| {
            Scatter::from_fn(|i, j| level[(i, j)] * (by[i] * by[j]).sqrt())
        };
        [scaled(&recipe, by_state), scaled(&scaled(&sample, &of_size), by_state)]
    }

    pub(crate) fn at_z(z: f64, levels: &[Scatter; 2]) -> Scatter {
        let [of_recipe, of_sample] = ScatterLevels::weights(z);
        let [recipe, sample] = levels;
        Scatter::from_fn(|i, j| {
            recipe[(i, j)] / (of_recipe[i] * of_recipe[j]) + sample[(i, j)] / (of_sample[i] * of_sample[j])
        })
    }

    /// Returns the covariance at this z in this state, by its levels: under a deviator, with that of its effect.
    pub(crate) fn scatter_in(&self, z: f64, levels: &[Scatter; 2], state: &NetworkState) -> Scatter {
        let mut by_stress = SVector::<f64, SCATTERED>::zeros();
        for (i, law) in
            [&self.dilatation, &self.voigt, &self.harmonic, &self.eps_stiffness].into_iter().enumerate()
        {
            by_stress[2 + i] = RESPONSE_STDDEV * law.by_stress_ratio(z, state) * state.stress_ratio;
        }
        Self::at_z(z, levels) + by_stress * by_stress.transpose()
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
        for (field, levels) in [
            ("network.scatter.recipe", &self.scatter.recipe),
            ("network.scatter.sample", &self.scatter.sample),
        ] {
            let scatter = Scatter::from_fn(|i, j| levels[i][j]);
            let finite = scatter.iter().all(|v| v.is_finite());
            let lowest = if finite { scatter.symmetric_eigenvalues().min() } else { f64::NAN };
            let valid = scatter == scatter.transpose() && lowest > 0.0;
            constant(field, lowest, valid, "it must be a covariance, of positive eigenvalues")?;
        }
        Ok(())
    }
}
