//! Simulation-based calibration (Talts et al. 2018): structures drawn from the prior, moduli simulated with all errors, and the
//! rank of the true value among draws from the posterior of these moduli.

use grainlab_core::results::{InferredQuantity, Microstructure};
use grainlab_emt::{
    Calibration, Conditions, EmtError, Model, Moduli, Observation, Posterior, PosteriorSettings, Prior,
};
use grainlab_testkit::Random;
use nalgebra::{SVector, Vector2};

/// Draws per simulation: with the true value, a multiple of the number of bins.
const DRAWS: usize = 99;

/// Number of bins.
pub(crate) const BINS: usize = 20;

/// Points of each integration: the draws need only the largest weight from it.
const POINTS: usize = 1024;

/// Structures drawn from the prior before the model counts as predicting none of them.
const TRIES: usize = 1000;

/// Standard deviation of each measured modulus over its value for the mean structure of the prior.
const ERROR: f64 = 0.01;

/// The share of draws below the true value of each quantity, in one simulation at this state.
pub(crate) fn simulated_ranks(
    model: &dyn Model,
    calibration: &Calibration,
    prior: &Prior,
    conditions: Conditions,
    random: &mut Random,
) -> Result<Vec<f64>, EmtError> {
    let complete = prior.completed(&model.prior_domain(calibration))?;
    // The error of the data is the same in all simulations, so that it says nothing of the structure.
    let typical = typical_observation(model, calibration, &complete, conditions)?;
    let likelihood = model.likelihood(&typical, calibration)?;
    // The prior is that of the structures for which the model predicts moduli.
    let drawn = (0..TRIES).find_map(|_| {
        let of = |q: &InferredQuantity| Some(complete.get(*q)?.quantile(random.unit()));
        let unknowns = likelihood.unknowns().iter().map(of).collect::<Option<Vec<f64>>>()?;
        Some((likelihood.at(&unknowns)?, unknowns))
    });
    let (predicted, unknowns) = drawn.unwrap();
    let difference = predicted.replicated(&SVector::from_fn(|_, _| random.normal()));
    let observed = likelihood.moduli().iter().zip(likelihood.observed());
    let simulated =
        observed.fold(Moduli::NONE, |all, (m, value)| all.with(*m, value + difference[*m as usize]));
    let observation = Observation { moduli: simulated, ..typical.clone() };
    let at = model.likelihood(&observation, calibration)?.at(&unknowns).unwrap();
    let mut truth: Vec<f64> = unknowns.clone();
    if !likelihood.following().is_empty() {
        let (mean, covariance) = at.following;
        let root = covariance.cholesky().map_or_else(nalgebra::Matrix2::zeros, |c| c.l());
        let following: Vector2<f64> = mean + root * Vector2::from_fn(|_, _| random.normal());
        truth.extend(following.iter());
    }
    let own = PosteriorSettings { points: POINTS, seed: (random.unit() * 1e9) as u64 };
    let posterior = Posterior::new(model, &observation, calibration, prior, own)?;
    let draws = posterior.draws(DRAWS)?;
    let share = |(quantity, truth): (InferredQuantity, f64)| {
        let below = draws.draws.iter().filter(|d| d.structure.get(quantity).is_some_and(|v| v < truth));
        below.count() as f64 / (DRAWS + 1) as f64
    };
    Ok(draws.quantities.iter().copied().zip(truth).map(share).collect())
}

/// The moduli of the mean structure of the prior, with the error of the data.
fn typical_observation(
    model: &dyn Model,
    calibration: &Calibration,
    prior: &Prior,
    conditions: Conditions,
) -> Result<Observation, EmtError> {
    let domain = model.domain(calibration);
    let inside = |q: InferredQuantity| {
        let [low, high] = domain.structure[q as usize]?;
        Some(prior.get(q)?.mean().clamp(low, high))
    };
    let structure = Microstructure::of_values(InferredQuantity::ALL.map(inside));
    let moduli = model.predict(&structure, &conditions, calibration)?;
    Ok(Observation::new(moduli, conditions).with_relative_error(ERROR))
}
