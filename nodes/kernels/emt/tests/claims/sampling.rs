//! The first-order distribution of an estimate against a sampled one (JCGM 101:2008), and where they differ.

use crate::cases::calibrations;
use crate::{PAPER_MODELS, model};
use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};
use grainlab_emt::{
    CREDIBLE_LEVEL, Calibration, Conditions, EmtError, MODULI, Measured, Model, Observation, StrainRatio,
    StrainRatioSource, models,
};
use nalgebra::{SMatrix, SVector};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

const DRAWS: usize = 40_000;

/// Independent numbers of mean 0 and variance 1, by Box and Muller's method.
fn normal<const N: usize>(random: &mut Pcg64Mcg) -> SVector<f64, N> {
    let mut uniform = || (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    SVector::from_fn(|_, _| {
        (-2.0 * (1.0 - uniform()).ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
    })
}

type Inferred = SVector<f64, { InferredQuantity::COUNT }>;

/// Draws with a solution, from the distribution of an estimate.
struct MonteCarlo {
    unsolved: usize,
    mean: Inferred,
    covariance: MicrostructureCovariance,
    /// Values of each quantity in rising order.
    sorted: [Vec<f64>; InferredQuantity::COUNT],
}

impl MonteCarlo {
    fn quantile(&self, quantity: InferredQuantity, level: f64) -> f64 {
        let sorted = &self.sorted[quantity as usize];
        let at = level * (sorted.len() - 1) as f64;
        let (below, above) = (at.floor() as usize, at.ceil() as usize);
        sorted[below] + (at - at.floor()) * (sorted[above] - sorted[below])
    }

    /// Interval with as many draws below as above it.
    fn interval(&self, quantity: InferredQuantity) -> [f64; 2] {
        let outside = 0.5 * (1.0 - CREDIBLE_LEVEL);
        [outside, 1.0 - outside].map(|level| self.quantile(quantity, level))
    }

    /// Skewness of the interval about the median: 0 if symmetric, 1 if all of it lies above. Higher moments need not exist.
    fn skewness(&self, quantity: InferredQuantity) -> f64 {
        let ([low, high], median) = (self.interval(quantity), self.quantile(quantity, 0.5));
        ((high - median) - (median - low)) / (high - low)
    }
}

/// Inverts draws of the moduli, the pressure, γ/Δ, the solid fraction and q/p from their normal distributions, and adds to each
/// solution a draw of the model's error.
fn monte_carlo(model: &dyn Model, o: &Observation, calibration: &Calibration, seed: u64) -> MonteCarlo {
    let estimate = model.infer(o, calibration).unwrap();
    let o = o.checked().unwrap();
    // Includes the modulus that follows from the others.
    let of_data = root(&o.covariance.unwrap());
    let of_model = root(&estimate.model_covariance.unwrap_or_default());
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let draw = |_| {
        let drawn = draw(&o, &of_data, &mut random);
        let left_out = of_model * normal(&mut random);
        Some(solve(model, &drawn, calibration, &estimate.structure).ok()? + left_out)
    };
    let solved: Vec<Inferred> = (0..DRAWS).filter_map(draw).collect();
    let count = solved.len() as f64;
    let mean = solved.iter().sum::<Inferred>() / count;
    let about_mean = |v: &Inferred| (v - mean) * (v - mean).transpose();
    MonteCarlo {
        unsolved: DRAWS - solved.len(),
        mean,
        covariance: solved.iter().map(about_mean).sum::<MicrostructureCovariance>() / (count - 1.0),
        sorted: std::array::from_fn(|i| {
            let mut column: Vec<f64> = solved.iter().map(|v| v[i]).collect();
            column.sort_by(f64::total_cmp);
            column
        }),
    }
}

/// One draw of the data. The covariance stays that of the observation, so that all draws are weighted alike.
fn draw(o: &Observation, of_data: &SMatrix<f64, MODULI, MODULI>, random: &mut Pcg64Mcg) -> Observation {
    let mut drawn = o.clone();
    let errors = of_data * normal::<MODULI>(random);
    for (modulus, value) in o.moduli.known() {
        drawn.moduli = drawn.moduli.with(modulus, value + errors[modulus as usize]);
    }
    let state = &mut drawn.conditions;
    let [pressure, gamma, phi, stress_ratio]: [f64; 4] = normal::<4>(random).into();
    state.pressure.value += pressure * state.pressure.stddev;
    state.gamma.value += gamma * state.gamma.stddev;
    for (known, error) in [(&mut state.solid_fraction, phi), (&mut state.stress_ratio, stress_ratio)] {
        let known = known.as_mut().unwrap();
        known.value += error * known.stddev;
    }
    drawn
}

/// The structure of one draw, zero where `wanted` is undetermined.
fn solve(
    model: &dyn Model,
    drawn: &Observation,
    calibration: &Calibration,
    wanted: &Microstructure,
) -> Result<Inferred, EmtError> {
    drawn.checked()?;
    let found = model.solve(drawn, calibration)?.structure;
    let of = |q: InferredQuantity| wanted.get(q).map_or(0.0, |_| found.get(q).unwrap());
    Ok(Inferred::from(InferredQuantity::ALL.map(of)))
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

/// A typical packing, in a state that every model accepts, with the relative error `relative`.
fn observed(model: &dyn Model, calibration: &Calibration, relative: f64) -> Option<Observation> {
    let structure = Microstructure {
        k: Some(5.2),
        k_hat: Some(5.4),
        z: Some(5.35),
        eps: Some(0.1),
        eps_stiffness: Some(0.08),
    };
    let known = |value: f64| Measured { value, stddev: relative * value };
    let conditions = Conditions {
        pressure: known(1.0e5),
        gamma: StrainRatio { value: -0.05, stddev: relative, source: StrainRatioSource::Given },
        solid_fraction: Some(known(0.63)),
        stress_ratio: Some(Measured { value: 0.0, stddev: relative }),
        size_spread: Some(0.0),
        material: None,
        ..Conditions::at(1e5)
    };
    match model.predict(&structure, &conditions, calibration) {
        Err(EmtError::NotCalibrated { .. }) => None,
        moduli => Some(Observation::new(moduli.unwrap(), conditions).with_relative_error(relative)),
    }
}

/// Five standard errors of 40,000 draws: of a mean σ/√N, of a covariance √((C_ii C_jj + C_ij²)/N). The error
/// of the linear slopes is a thousandth of σ here.
#[test]
fn at_a_tenth_of_a_percent_samples_and_slopes_of_every_model_agree() {
    for calibration in calibrations() {
        for model in models() {
            let Some(o) = observed(*model, &calibration, 1e-3) else { continue };
            let linear = model.infer(&o, &calibration).unwrap();
            let sampled = monte_carlo(*model, &o, &calibration, 1);
            assert_eq!(sampled.unsolved, 0);
            let (c, expected) = (sampled.covariance, linear.covariance().unwrap());
            let error = 5.0 / (DRAWS as f64).sqrt();
            for quantity in InferredQuantity::ALL {
                let (i, name) = (quantity as usize, model.name());
                let Some(value) = linear.structure.get(quantity) else {
                    continue;
                };
                let sigma = linear.stddev(quantity).unwrap();
                assert!((sampled.mean[i] - value).abs() < error * sigma, "{name} {quantity}");
                for j in 0..InferredQuantity::COUNT {
                    let scale = (expected[(i, i)] * expected[(j, j)] + expected[(i, j)].powi(2)).sqrt();
                    assert!(
                        (c[(i, j)] - expected[(i, j)]).abs() <= error * scale,
                        "{name} {quantity} {j}: {c} {expected}"
                    );
                }
                // An end of the interval has 2.7 times the standard error of the mean.
                let ends = sampled.interval(quantity).into_iter().zip(linear.interval(quantity).unwrap());
                ends.for_each(|(s, l)| assert!((s - l).abs() < 2.7 * error * sigma, "{name} {quantity}"));
                assert!(sampled.skewness(quantity).abs() < 0.04, "{name} {quantity}");
            }
        }
    }
}

/// At 30 % the linear slopes ignore the upper bound of k̂: the samples are asymmetric, wider, and a part of
/// them has no solution.
#[test]
fn at_30_percent_samples_and_slopes_differ() {
    for name in PAPER_MODELS.into_iter().filter(|name| *name != "emt") {
        let o = observed(model(name), &Calibration::PAPER, 0.3).unwrap();
        let linear = model(name).infer(&o, &Calibration::PAPER).unwrap();
        let sampled = monte_carlo(model(name), &o, &Calibration::PAPER, 2);
        assert!(sampled.unsolved as f64 > 0.02 * DRAWS as f64, "{name}: {}", sampled.unsolved);
        let ([low, high], [_, taken]) =
            (sampled.interval(InferredQuantity::KHat), linear.interval(InferredQuantity::KHat).unwrap());
        let skewness = sampled.skewness(InferredQuantity::KHat);
        assert!(skewness > 0.3 && high > taken + 1.0, "{name}: {skewness} {low} {high} {taken}");
    }
}
