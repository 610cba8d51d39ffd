//! Simulation-based calibration (Talts et al. 2018): structures drawn from the prior, moduli simulated with all errors, and the
//! rank of the true value among draws from the posterior of these moduli.

use grainlab_core::results::{InferredQuantity, Microstructure};
use grainlab_emt::{
    Calibration, Conditions, EmtError, MODULI, Model, Moduli, Modulus, Observation, Posterior,
    PosteriorSettings, Prior, RankHistogram,
};
use nalgebra::{SVector, Vector2};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

struct Random(Pcg64Mcg);

impl Random {
    fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal<const N: usize>(&mut self) -> SVector<f64, N> {
        let mut one =
            || (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos();
        SVector::from_fn(|_, _| one())
    }
}

/// Draws per simulation: with the true value, a multiple of the number of bins.
const DRAWS: usize = 99;

/// Number of bins.
const BINS: usize = 20;

/// Points of each integration: the draws need only the largest weight from it.
const POINTS: usize = 1024;

/// Structures drawn from the prior before the model counts as predicting none of them.
const TRIES: usize = 1000;

/// Settings of the simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SimulationSettings {
    /// The state of every simulated sample.
    pub(crate) conditions: Conditions,
    /// Number of grains of a sample; `None`: as the packings of the calibration.
    pub(crate) grains: Option<u32>,
    /// Standard deviation of each measured modulus over its value for the mean structure of the prior.
    pub(crate) relative_error: f64,
    /// The moduli that are measured.
    pub(crate) moduli: [bool; MODULI],
    /// Seed of the random numbers.
    pub(crate) seed: u64,
}

/// Ranks of one simulation.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SimulatedRanks {
    /// The share of draws below the true value of each quantity.
    pub(crate) shares: Vec<(InferredQuantity, f64)>,
}

impl SimulatedRanks {
    /// Number of bins of a histogram of these ranks.
    pub(crate) fn histogram() -> RankHistogram {
        RankHistogram::new(BINS)
    }
}

/// The ranks of simulation `index`. An error if the model predicts no moduli for the prior, if the
/// simulated moduli are not those of a stable medium, or if their posterior cannot be sampled.
pub(crate) fn simulated_ranks(
    model: &dyn Model,
    calibration: &Calibration,
    prior: &Prior,
    settings: &SimulationSettings,
    index: u64,
) -> Result<SimulatedRanks, EmtError> {
    let complete = prior.completed(&model.prior_domain(calibration))?;
    // The error of the data is the same in all simulations, so that it says nothing of the structure.
    let typical = typical_observation(model, calibration, &complete, settings)?;
    let mut random = Random(Pcg64Mcg::seed_from_u64(
        settings.seed.wrapping_add(index.wrapping_mul(0x9e37_79b9_7f4a_7c15)),
    ));
    let likelihood = model.likelihood(&typical, calibration)?;
    let none = EmtError::NoLikelihood {
        model: model.name(),
        reason: "it predicts no moduli for structures of the prior; narrow the prior",
    };
    // The prior is that of the structures for which the model predicts moduli.
    let drawn = (0..TRIES).find_map(|_| {
        let of = |q: &InferredQuantity| Some(complete.get(*q)?.quantile(random.uniform()));
        let unknowns = likelihood.unknowns().iter().map(of).collect::<Option<Vec<f64>>>()?;
        Some((likelihood.at(&unknowns)?, unknowns))
    });
    let (predicted, unknowns) = drawn.ok_or(none.clone())?;
    let difference = predicted.replicated(&random.normal());
    let observed = likelihood.moduli().iter().zip(likelihood.observed());
    let simulated =
        observed.fold(Moduli::NONE, |all, (m, value)| all.with(*m, value + difference[*m as usize]));
    let observation = Observation { moduli: simulated, ..typical.clone() };
    let at = model.likelihood(&observation, calibration)?.at(&unknowns).ok_or(none)?;
    let mut truth: Vec<f64> = unknowns.clone();
    if !likelihood.following().is_empty() {
        let (mean, covariance) = at.following;
        let root = covariance.cholesky().map_or_else(nalgebra::Matrix2::zeros, |c| c.l());
        let following: Vector2<f64> = mean + root * random.normal::<2>();
        truth.extend(following.iter());
    }
    let own = PosteriorSettings { points: POINTS, seed: random.0.next_u64() };
    let posterior = Posterior::new(model, &observation, calibration, prior, own)?;
    let draws = posterior.draws(DRAWS)?;
    let share = |(quantity, truth): (InferredQuantity, f64)| {
        let below = draws.draws.iter().filter(|d| d.structure.get(quantity).is_some_and(|v| v < truth));
        (quantity, below.count() as f64 / (DRAWS + 1) as f64)
    };
    Ok(SimulatedRanks { shares: draws.quantities.iter().copied().zip(truth).map(share).collect() })
}

/// The moduli of the mean structure of the prior, with the error of the data.
fn typical_observation(
    model: &dyn Model,
    calibration: &Calibration,
    prior: &Prior,
    settings: &SimulationSettings,
) -> Result<Observation, EmtError> {
    let domain = model.domain(calibration);
    let inside = |q: InferredQuantity| {
        let [low, high] = domain.structure[q as usize]?;
        Some(prior.get(q)?.mean().clamp(low, high))
    };
    let structure = Microstructure::of_values(InferredQuantity::ALL.map(inside));
    let moduli = model.predict(&structure, &settings.conditions, calibration)?;
    let measured = Modulus::ALL.into_iter().filter(|m| settings.moduli[*m as usize]);
    let kept = measured.filter_map(|m| Some((m, moduli.get(m)?)));
    let moduli = kept.fold(Moduli::NONE, |all, (m, value)| all.with(m, value));
    let observation =
        Observation { grains: settings.grains, ..Observation::new(moduli, settings.conditions) };
    Ok(observation.with_relative_error(settings.relative_error))
}
