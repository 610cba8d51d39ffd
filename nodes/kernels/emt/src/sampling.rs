//! Propagation of distributions by sampling (JCGM 101:2008), where errors are too large for a linear propagation.
//!
//! Moduli and all inputs of the state that have an error are drawn from normal distributions, each draw is inverted, and a
//! draw of the model's error is added. With small errors this agrees with [`crate::Estimate`]. With large
//! ones intervals become asymmetric, and some draws have no solution. These are counted. Every number here
//! refers to the draws with a solution, and is not meaningful if many draws have none.

use crate::calibration::Calibration;
use crate::conditions::STATE_INPUTS;
use crate::error::EmtError;
use crate::estimate::CREDIBLE_LEVEL;
use crate::model::Model;
use crate::moduli::MODULI;
use crate::observation::Observation;
use crate::random::Random;
use grainlab_core::Material;
use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};
use nalgebra::{SMatrix, SVector};

/// Settings of the sampling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplingSettings {
    /// Number of draws. With 10,000 draws the end of a 95 % interval is accurate to 3 % of its distance from the
    /// middle.
    pub draws: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for SamplingSettings {
    fn default() -> Self {
        Self { draws: 20_000, seed: 0 }
    }
}

/// Estimate of one model from one observation, as draws from its distribution.
#[derive(Clone, Debug, PartialEq)]
pub struct MonteCarlo {
    /// Name of the model.
    pub model: &'static str,
    /// Name of the calibration.
    pub calibration: String,
    /// Number of draws.
    pub draws: usize,
    /// Number of draws without a solution.
    pub unsolved: usize,
    /// The error of the first of these.
    pub first_fault: Option<EmtError>,
    /// Means; `None` is undetermined, or not part of the model.
    pub mean: Microstructure,
    /// Covariance; `None` where fewer than two draws have a solution.
    pub covariance: Option<MicrostructureCovariance>,
    /// Values of each quantity in rising order; empty where it is undetermined.
    sorted: [Vec<f64>; InferredQuantity::COUNT],
}

impl MonteCarlo {
    /// Standard deviation of a quantity.
    pub fn stddev(&self, quantity: InferredQuantity) -> Option<f64> {
        self.mean.get(quantity)?;
        let i = quantity as usize;
        Some(self.covariance?[(i, i)].sqrt())
    }

    /// The quantile of a quantity at `level`, 0 to 1.
    pub fn quantile(&self, quantity: InferredQuantity, level: f64) -> Option<f64> {
        let sorted = &self.sorted[quantity as usize];
        let last = sorted.len().checked_sub(1)?;
        let at = level.clamp(0.0, 1.0) * last as f64;
        let (below, above) = (at.floor() as usize, at.ceil() as usize);
        Some(sorted[below] + (at - at.floor()) * (sorted[above] - sorted[below]))
    }

    /// Interval of a quantity at [`CREDIBLE_LEVEL`], low and high, with as many draws below as above it.
    pub fn interval(&self, quantity: InferredQuantity) -> Option<[f64; 2]> {
        let outside = 0.5 * (1.0 - CREDIBLE_LEVEL);
        Some([self.quantile(quantity, outside)?, self.quantile(quantity, 1.0 - outside)?])
    }

    /// Skewness of the interval about the median: 0 if symmetric, 1 if all of it lies above, −1 if all lies below.
    /// Higher moments need not exist.
    pub fn skewness(&self, quantity: InferredQuantity) -> Option<f64> {
        let [low, high] = self.interval(quantity)?;
        let median = self.quantile(quantity, 0.5)?;
        Some(if high > low { ((high - median) - (median - low)) / (high - low) } else { 0.0 })
    }
}

/// Draws from the distribution of what `model` infers from `observation`, whose covariance of the moduli must be known.
///
/// The observation must have a solution; the model's error at this solution is used for every draw.
pub fn monte_carlo(
    model: &dyn Model,
    observation: &Observation,
    calibration: &Calibration,
    settings: SamplingSettings,
) -> Result<MonteCarlo, EmtError> {
    let missing = EmtError::Missing { model: model.name(), missing: "the covariance of the moduli" };
    let covariance = observation.covariance.ok_or(missing)?;
    let estimate = model.infer(observation, calibration)?;
    let observation = observation.checked()?;
    // Includes the modulus that follows from the others.
    let of_data = root(&observation.covariance.unwrap_or(covariance));
    let of_model = root(&estimate.model_covariance.unwrap_or_default());

    let mut random = Random::new(settings.seed);
    let mut solved: Vec<SVector<f64, { InferredQuantity::COUNT }>> = Vec::with_capacity(settings.draws);
    let mut first_fault = None;
    for _ in 0..settings.draws {
        // All numbers are drawn before the inversion can fail, so that no draw depends on the outcome of another.
        let drawn = draw(&observation, &of_data, &mut random, calibration.material());
        let left_out = of_model * random.normal();
        match solve(model, &drawn, calibration, &estimate.structure) {
            Ok(found) => solved.push(found + left_out),
            Err(fault) => first_fault = first_fault.or(Some(fault)),
        }
    }

    let determined = estimate.structure.values().map(|v| v.is_some());
    let count = solved.len() as f64;
    let mean: SVector<f64, { InferredQuantity::COUNT }> =
        solved.iter().sum::<SVector<f64, { InferredQuantity::COUNT }>>() / count;
    let covariance = (solved.len() > 1).then(|| {
        let about_mean = |v: &SVector<f64, { InferredQuantity::COUNT }>| (v - mean) * (v - mean).transpose();
        solved.iter().map(about_mean).sum::<MicrostructureCovariance>() / (count - 1.0)
    });
    let sorted = std::array::from_fn(|i| {
        let mut column: Vec<f64> =
            if determined[i] { solved.iter().map(|v| v[i]).collect() } else { Vec::new() };
        column.sort_by(f64::total_cmp);
        column
    });
    Ok(MonteCarlo {
        model: model.name(),
        calibration: calibration.name().to_owned(),
        draws: settings.draws,
        unsolved: settings.draws - solved.len(),
        first_fault,
        mean: Microstructure::of_values(std::array::from_fn(|i| {
            (determined[i] && !solved.is_empty()).then_some(mean[i])
        })),
        covariance,
        sorted,
    })
}

/// One draw of the data. The covariance stays that of the observation, so that all draws are weighted alike.
fn draw(
    observation: &Observation,
    of_data: &SMatrix<f64, MODULI, MODULI>,
    random: &mut Random,
    material: &Material,
) -> Observation {
    let mut drawn = observation.clone();
    let errors = of_data * random.normal();
    for (modulus, value) in observation.moduli.known() {
        drawn.moduli = drawn.moduli.with(modulus, value + errors[modulus as usize]);
    }
    let stddevs = observation.conditions.stddevs(material);
    let errors: [f64; STATE_INPUTS] = random.normal::<STATE_INPUTS>().into();
    for (input, (error, stddev)) in errors.into_iter().zip(stddevs).enumerate() {
        // An unknown one stays unknown where it is not moved.
        if stddev > 0.0
            && let Some(moved) = drawn.conditions.moved(input, error * stddev, material)
        {
            drawn.conditions = moved;
            // The laws take its square.
            drawn.conditions.size_spread = moved.size_spread.map(f64::abs);
        }
    }
    drawn
}

/// The structure of one draw, zero where `wanted` is undetermined.
fn solve(
    model: &dyn Model,
    drawn: &Observation,
    calibration: &Calibration,
    wanted: &Microstructure,
) -> Result<SVector<f64, { InferredQuantity::COUNT }>, EmtError> {
    drawn.check_values()?;
    let found = model.solve(drawn, calibration)?.structure;
    let mut values = SVector::zeros();
    for quantity in InferredQuantity::ALL {
        if wanted.get(quantity).is_none() {
            continue;
        }
        let missing = EmtError::Missing { model: model.name(), missing: quantity.name() };
        let value = found.get(quantity).ok_or(missing)?;
        if !value.is_finite() {
            return Err(EmtError::NotFinite { quantity: quantity.name(), value });
        }
        values[quantity as usize] = value;
    }
    Ok(values)
}

/// The lower triangular R with R Rᵀ = covariance, of any rank: Cholesky's, with a column of zeros where an
/// error depends on earlier ones.
fn root<const N: usize>(covariance: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    /// Fraction of a variance that is rounding.
    const ROUNDING: f64 = 1e-12;
    let mut root = SMatrix::<f64, N, N>::zeros();
    for j in 0..N {
        let rest = |i: usize| covariance[(i, j)] - (0..j).map(|k| root[(i, k)] * root[(j, k)]).sum::<f64>();
        let pivot = rest(j);
        if pivot <= ROUNDING * covariance[(j, j)] {
            continue;
        }
        let mut column = SVector::<f64, N>::zeros();
        (j..N).for_each(|i| column[i] = rest(i) / pivot.sqrt());
        root.set_column(j, &column);
    }
    root
}
