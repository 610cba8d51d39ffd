//! The sampled distribution against the first-order one, and where they differ.

use crate::cases::calibrations;
use crate::{PAPER_MODELS, model, table3};
use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};
use grainlab_emt::{
    Calibration, Conditions, Domain, EmtError, Jacobian, Measured, Model, Moduli, ModuliCovariance, Modulus,
    MonteCarlo, Observation, PointEstimate, SamplingSettings, StrainRatio, StrainRatioSource, models,
    monte_carlo,
};

const DRAWS: usize = 40_000;

/// Fraction of the draws without a solution.
fn failed(sampled: &MonteCarlo) -> f64 {
    sampled.unsolved as f64 / sampled.draws.max(1) as f64
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
    let settings = SamplingSettings { draws: DRAWS, seed: 1 };
    for calibration in calibrations() {
        for model in models() {
            let Some(o) = observed(*model, &calibration, 1e-3) else { continue };
            let linear = model.infer(&o, &calibration).unwrap();
            let sampled = monte_carlo(*model, &o, &calibration, settings).unwrap();
            assert_eq!((sampled.unsolved, sampled.draws, &sampled.first_fault), (0, DRAWS, &None));
            assert_eq!((sampled.model, sampled.calibration.as_str()), (model.name(), calibration.name()));
            let (c, expected) = (sampled.covariance.unwrap(), linear.covariance().unwrap());
            let error = 5.0 / (DRAWS as f64).sqrt();
            for quantity in InferredQuantity::ALL {
                let (i, name) = (quantity as usize, model.name());
                let Some(value) = linear.structure.get(quantity) else {
                    assert!(sampled.mean.get(quantity).is_none() && sampled.interval(quantity).is_none());
                    continue;
                };
                let sigma = linear.stddev(quantity).unwrap();
                assert!(
                    (sampled.mean.get(quantity).unwrap() - value).abs() < error * sigma,
                    "{name} {quantity}"
                );
                for j in 0..InferredQuantity::COUNT {
                    let scale = (expected[(i, i)] * expected[(j, j)] + expected[(i, j)].powi(2)).sqrt();
                    assert!(
                        (c[(i, j)] - expected[(i, j)]).abs() <= error * scale,
                        "{name} {quantity} {j}: {c} {expected}"
                    );
                }
                // An end of the interval has 2.7 times the standard error of the mean.
                let ends =
                    sampled.interval(quantity).unwrap().into_iter().zip(linear.interval(quantity).unwrap());
                ends.for_each(|(s, l)| assert!((s - l).abs() < 2.7 * error * sigma, "{name} {quantity}"));
                assert!(sampled.skewness(quantity).unwrap().abs() < 0.04, "{name} {quantity}");
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
        let sampled =
            monte_carlo(model(name), &o, &Calibration::PAPER, SamplingSettings { draws: DRAWS, seed: 2 })
                .unwrap();
        assert!(failed(&sampled) > 0.02, "{name}: {}", failed(&sampled));
        assert!(sampled.first_fault.as_ref().is_some_and(|e| !matches!(e, EmtError::Missing { .. })));
        let ([low, high], [_, taken]) = (
            sampled.interval(InferredQuantity::KHat).unwrap(),
            linear.interval(InferredQuantity::KHat).unwrap(),
        );
        let skewness = sampled.skewness(InferredQuantity::KHat).unwrap();
        assert!(skewness > 0.3 && high > taken + 1.0, "{name}: {skewness} {low} {high} {taken}");
        let share = sampled.unsolved as f64 / sampled.draws as f64;
        assert_eq!(failed(&sampled), share);
    }
}

#[test]
fn the_same_seed_gives_the_same_samples_and_another_one_others() {
    let o = table3::rows()[0].observation().with_relative_error(0.05);
    let of = |seed| {
        monte_carlo(model("ratio"), &o, &Calibration::PAPER, SamplingSettings { draws: 500, seed }).unwrap()
    };
    assert_eq!(of(3), of(3));
    assert_ne!(of(3).mean, of(4).mean);
}

#[test]
fn without_errors_there_is_nothing_to_sample_and_exact_data_leave_the_error_of_the_model() {
    let o = table3::rows()[0].observation();
    let of = |o: &Observation| {
        monte_carlo(model("ratio"), o, &Calibration::PAPER, SamplingSettings { draws: 50, seed: 0 })
    };
    let missing = EmtError::Missing { model: "ratio", missing: "the covariance of the moduli" };
    assert_eq!(of(&o).unwrap_err(), missing);
    // Only the error of the model is left.
    let exact = of(&o.clone().with_relative_error(0.0)).unwrap();
    let stated = model("ratio").infer(&o, &Calibration::PAPER).unwrap().stddev(InferredQuantity::K).unwrap();
    assert!((exact.mean.k.unwrap() - 5.73).abs() < 3.0 * stated / 50f64.sqrt());
    assert!((exact.stddev(InferredQuantity::K).unwrap() / stated - 1.0).abs() < 0.3);
    let mut none = table3::rows()[0].observation().with_relative_error(0.01);
    none.moduli = none.moduli.with(Modulus::G13, 1e9);
    assert!(matches!(of(&none), Err(EmtError::RatioOutOfRange { .. })));
    let o = table3::rows()[0].observation().with_relative_error(0.01);
    let empty =
        monte_carlo(model("ratio"), &o, &Calibration::PAPER, SamplingSettings { draws: 0, seed: 0 }).unwrap();
    assert!(empty.mean == Microstructure::default() && empty.covariance.is_none() && failed(&empty) == 0.0);
}

/// k is Θ in 20 MPa, refused above 6; the model's error has a standard deviation of 0.3.
#[derive(Debug)]
struct Line;

impl Model for Line {
    fn name(&self) -> &'static str {
        "line"
    }

    fn domain(&self, _: &Calibration) -> Domain {
        let structure = [Some([0.0, 6.0]), None, None, None, None];
        Domain {
            model: "line",
            structure,
            fitted: [None; InferredQuantity::COUNT],
            gamma: [0.0, 0.0],
            reduced_pressure: [0.0, f64::INFINITY],
            stress_ratio: [-1.5, 3.0],
            size_spread: [0.0, f64::INFINITY],
            needs_solid_fraction: false,
            compares_state: false,
        }
    }

    fn predict(&self, _: &Microstructure, _: &Conditions, _: &Calibration) -> Result<Moduli, EmtError> {
        Ok(Moduli::NONE)
    }

    fn solve(&self, o: &Observation, _: &Calibration) -> Result<PointEstimate, EmtError> {
        let k = o.moduli.get(Modulus::Theta).unwrap() / 20.0e6;
        if k > 6.0 {
            return Err(EmtError::NoCoordination {
                nearest: k,
                low: 0.0,
                high: 6.0,
                calibration: "none".into(),
            });
        }
        let mut left_out = MicrostructureCovariance::zeros();
        left_out[(0, 0)] = 0.09;
        let structure = Microstructure::default().with(InferredQuantity::K, k);
        Ok(PointEstimate { discrepancy: Some(left_out), ..PointEstimate::exact(structure) })
    }
}

/// 5 ± 0.4 from the data and ± 0.3 from the model make ± 0.5. 6 lies 2.5 σ of the data above the mean; 0.62 %
/// of the draws exceed it.
#[test]
fn what_the_model_leaves_out_is_added_and_draws_without_a_solution_are_counted() {
    let theta = 100.0e6;
    let o = Observation::new(Moduli::NONE.with(Modulus::Theta, theta), Conditions::at(1.0e5))
        .with_relative_error(0.08);
    let s =
        monte_carlo(&Line, &o, &Calibration::PAPER, SamplingSettings { draws: 200_000, seed: 5 }).unwrap();
    assert!((failed(&s) - 0.0062).abs() < 5.0 * (0.0062f64 / 200_000.0).sqrt(), "{}", failed(&s));
    assert!(matches!(s.first_fault, Some(EmtError::NoCoordination { nearest, .. }) if nearest > 6.0));
    // Truncated at 2.5 σ, a normal distribution has mean −0.01764 σ and variance 0.9556 σ².
    assert!((s.mean.k.unwrap() - (5.0 - 0.01764 * 0.4)).abs() < 5.0 * 0.5 / 200_000f64.sqrt());
    let variance: f64 = 0.9556 * 0.16 + 0.09;
    assert!((s.stddev(InferredQuantity::K).unwrap() / variance.sqrt() - 1.0).abs() < 5.0 / 400_000f64.sqrt());
    assert!(
        s.quantile(InferredQuantity::K, 0.0).unwrap() < 3.5
            && s.quantile(InferredQuantity::K, 1.0).unwrap() > 6.0
    );
}

/// Θ that follows from C11, C33, C13 and G12 is drawn with them: the five remain those of one medium, which a
/// model that uses all of them requires.
#[test]
fn correlated_errors_are_drawn_as_they_are() {
    #[derive(Debug)]
    struct Balance;
    impl Model for Balance {
        fn name(&self) -> &'static str {
            "balance"
        }
        fn domain(&self, c: &Calibration) -> Domain {
            Line.domain(c)
        }
        fn predict(&self, _: &Microstructure, _: &Conditions, _: &Calibration) -> Result<Moduli, EmtError> {
            Ok(Moduli::NONE)
        }
        fn solve(&self, o: &Observation, _: &Calibration) -> Result<PointEstimate, EmtError> {
            assert!(o.moduli.imbalance().unwrap().abs() < 1e-9);
            let [k, z] = [Modulus::G12, Modulus::G13].map(|m| o.moduli.get(m).unwrap() / 1e8);
            let structure = Microstructure { k: Some(k), z: Some(z), ..Microstructure::default() };
            // Differences would change one modulus without the others.
            Ok(PointEstimate { jacobian: Some(Jacobian::zeros()), ..PointEstimate::exact(structure) })
        }
    }
    let values = [Some(1.0e8), Some(1.1e8), None, Some(2.4e8), Some(2.5e8), Some(0.5e8)];
    let mut covariance =
        ModuliCovariance::from_diagonal(&[1.0, 1.0, 0.0, 4.0, 4.0, 1.0].map(|v| v * 1e12).into());
    // G12 and G13 share most of their error.
    (covariance[(0, 1)], covariance[(1, 0)]) = (0.8e12, 0.8e12);
    let o = Observation::new(Moduli::of_values(values), Conditions::at(1.0e5)).with_covariance(covariance);
    let s =
        monte_carlo(&Balance, &o, &Calibration::PAPER, SamplingSettings { draws: DRAWS, seed: 6 }).unwrap();
    let c = s.covariance.unwrap() * 1e4;
    let error = 5.0 / (DRAWS as f64).sqrt();
    assert!((c[(0, 0)] - 1.0).abs() < 1.42 * error && (c[(0, 2)] - 0.8).abs() < 1.29 * error, "{c}");
}
