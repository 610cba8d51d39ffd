//! First-order error propagation.

use crate::cases::{calibrations, pressure};
use crate::{model, table3};
use grainlab_core::results::{InferredQuantity, Microstructure};
use grainlab_core::{Mat3, Material};
use grainlab_emt::{
    Calibration, Conditions, EmtError, INPUTS, Inversion, Measured, Modulus, Observation, StrainRatio,
    StrainRatioSource, models,
};
use grainlab_testkit::Random;
use nalgebra::SVector;

const PRESSURE: usize = 6;
const GAMMA: usize = 7;
const SHEAR_MODULUS: usize = 11;

/// Correlated errors of the moduli, and errors of the state.
#[test]
fn the_covariance_is_that_of_the_inputs_by_the_slopes() {
    let conditions = Conditions {
        pressure: Measured { value: 80.0e3, stddev: 4.0e3 },
        gamma: StrainRatio { value: -0.06, stddev: 0.05, source: StrainRatioSource::Given },
        ..Conditions::at(80.0e3)
    };
    let truth = Microstructure::paper(5.2, 5.5, 0.1);
    let moduli = model("ratio").predict(&truth, &conditions, &Calibration::PAPER).unwrap();
    let [g12, g13, theta, ..] = moduli.values().map(|m| m.unwrap_or(0.0));
    let scale = Mat3::from_diagonal(&[g12, g13, theta].into());
    let root = Mat3::new(0.01, 0.0, 0.0, -0.006, 0.012, 0.0, 0.008, 0.004, 0.015);
    let relative = root * root.transpose();
    let o = Observation::new(moduli, conditions);
    let o = o.with_g12_g13_theta_covariance(&(scale * relative * scale));
    let e = model("ratio").infer(&o, &Calibration::PAPER).unwrap();
    let mut input = nalgebra::SMatrix::<f64, INPUTS, INPUTS>::zeros();
    input.fixed_view_mut::<3, 3>(0, 0).copy_from(&relative);
    (input[(PRESSURE, PRESSURE)], input[(GAMMA, GAMMA)]) = (0.05 * 0.05, 0.05 * 0.05);
    let expected = e.jacobian * input * e.jacobian.transpose();
    let found = e.data_covariance.unwrap();
    assert!((found - expected).amax() < 1e-9 * expected.amax(), "{found} {expected}");
}

/// The slopes of every model times those of its forward map are the unit matrix. A change of γ/Δ, pressure or
/// solid fraction together with the moduli predicted for it changes nothing. Cases keep a tenth of each range
/// away from its ends, where one-sided differences are only of first order.
#[test]
fn slopes_of_every_model_undo_those_of_its_forward_map() {
    const STEP: f64 = 1e-3;
    for calibration in calibrations() {
        for model in models() {
            let domain = model.domain(&calibration);
            let inner = |[low, high]: [f64; 2], random: &mut Random| {
                random.between(0.9 * low + 0.1 * high, 0.1 * low + 0.9 * high)
            };
            let mut random = Random::new(7);
            for _ in 0..200 {
                let structure =
                    Microstructure::of_values(domain.structure.map(|r| r.map(|r| inner(r, &mut random))));
                let conditions = Conditions {
                    gamma: StrainRatio::given(inner(domain.gamma, &mut random)),
                    solid_fraction: Some(Measured::exact(random.between(0.52, 0.7))),
                    stress_ratio: Some(Measured::exact(random.between(-0.15, 0.25))),
                    size_spread: Some(random.between(0.0, 0.2)),
                    ..Conditions::at(pressure(&mut random, &domain, calibration.material()))
                };
                let predict = |s: &Microstructure, c: &Conditions| model.predict(s, c, &calibration);
                let moduli = match predict(&structure, &conditions) {
                    Err(EmtError::NotCalibrated { .. }) => continue,
                    moduli => moduli.unwrap(),
                };
                let slopes =
                    model.infer(&Observation::new(moduli, conditions), &calibration).unwrap().jacobian;
                // Relative change of the moduli along one variable by five points, and the other variables.
                let along = |moved: &dyn Fn(f64) -> (Microstructure, Conditions), own: Option<usize>| {
                    let at = |by: f64| {
                        let (s, c) = moved(by);
                        predict(&s, &c).unwrap().values().map(|m| m.unwrap_or(0.0))
                    };
                    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|i| at(i * STEP));
                    let mut change = SVector::<f64, INPUTS>::zeros();
                    for (i, m) in moduli.values().iter().enumerate() {
                        let Some(m) = m.filter(|m| *m != 0.0) else { continue };
                        change[i] = (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * STEP * m);
                    }
                    own.into_iter().for_each(|i| change[i] = 1.0);
                    change
                };
                let near = |found: SVector<f64, { InferredQuantity::COUNT }>,
                            expected: SVector<f64, { InferredQuantity::COUNT }>| {
                    for (i, used) in domain.structure.iter().enumerate() {
                        let off = (found[i] - expected[i]).abs();
                        let what = || format!("{}: {structure:?} {conditions:?} {found}", model.name());
                        assert!(used.is_none() || off < 1e-5, "{}", what());
                    }
                };
                for quantity in InferredQuantity::ALL {
                    let Some(value) = structure.get(quantity) else { continue };
                    let change = along(&|by| (structure.with(quantity, value + by), conditions), None);
                    let mut unit = SVector::zeros();
                    unit[quantity as usize] = 1.0;
                    near(slopes * change, unit);
                }
                let state = |own, moved: &dyn Fn(f64) -> Conditions| {
                    near(slopes * along(&|by| (structure, moved(by)), Some(own)), SVector::zeros());
                };
                let scaled = |m: Measured, by: f64| Measured::exact(m.value * (1.0 + by));
                state(PRESSURE, &|by| Conditions { pressure: scaled(conditions.pressure, by), ..conditions });
                state(GAMMA, &|by| Conditions {
                    gamma: StrainRatio::given(conditions.gamma.value + by),
                    ..conditions
                });
                state(GAMMA + 1, &|by| Conditions {
                    solid_fraction: conditions.solid_fraction.map(|m| scaled(m, by)),
                    ..conditions
                });
                state(GAMMA + 2, &|by| Conditions {
                    stress_ratio: conditions.stress_ratio.map(|m| Measured::exact(m.value + by)),
                    ..conditions
                });
                if conditions.size_spread.is_some_and(|spread| spread > 0.01) {
                    state(GAMMA + 3, &|by| Conditions {
                        size_spread: conditions.size_spread.map(|s| s + by),
                        ..conditions
                    });
                }
                let grains = conditions.material.unwrap_or(*calibration.material());
                let with = |material| Conditions { material: Some(material), ..conditions };
                let shear_modulus = grains.shear_modulus;
                state(SHEAR_MODULUS, &|by| {
                    with(Material { shear_modulus: shear_modulus * (1.0 + by), ..grains })
                });
                let nu = grains.poisson_ratio;
                state(SHEAR_MODULUS + 1, &|by| with(Material { poisson_ratio: nu + by, ..grains }));
            }
        }
    }
}

/// Standard deviation by the errors of the data alone.
fn of_data(e: &Inversion, quantity: InferredQuantity) -> f64 {
    let i = quantity as usize;
    e.data_covariance.unwrap()[(i, i)].max(0.0).sqrt()
}

/// Errors of one percent of each modulus, independent: extremes over the rows of Table III, computed by
/// finite differences independent of this code and rounded to the digits given.
#[test]
fn one_percent_on_each_modulus_costs_what_is_known() {
    let mut extremes = [[f64::INFINITY, 0.0]; 3];
    for row in table3::rows() {
        let o = row.observation().with_relative_error(0.01);
        let e = model("ratio").infer(&o, &Calibration::PAPER).unwrap();
        let sigma =
            [InferredQuantity::K, InferredQuantity::KHat, InferredQuantity::Eps].map(|q| of_data(&e, q));
        for (found, [low, high]) in sigma.into_iter().zip(&mut extremes) {
            (*low, *high) = (low.min(found), high.max(found));
        }
    }
    let known = [[0.0515, 0.0642], [0.0144, 0.0502], [0.0246, 0.0292]];
    for (found, known) in extremes.as_flattened().iter().zip(known.as_flattened()) {
        assert!((found - known).abs() < 5e-5, "{extremes:?}");
    }
}

#[test]
fn unknown_errors_of_data_leave_that_of_the_model_and_known_ones_give_the_95_percent_interval() {
    let o = table3::rows()[0].observation();
    let unknown = model("ratio").infer(&o, &Calibration::PAPER).unwrap();
    assert!(unknown.data_covariance.is_none() && unknown.covariance() == unknown.model_covariance);
    assert!(unknown.stddev(InferredQuantity::K).unwrap() > 0.05);
    let known = model("ratio").infer(&o.with_relative_error(0.01), &Calibration::PAPER).unwrap();
    assert_eq!(grainlab_emt::CREDIBLE_LEVEL, 0.95);
    for quantity in [InferredQuantity::K, InferredQuantity::KHat, InferredQuantity::Eps] {
        let (middle, sigma) = (known.structure.get(quantity).unwrap(), known.stddev(quantity).unwrap());
        let [low, high] = known.interval(quantity).unwrap();
        assert!(((high - low) / (2.0 * sigma) - 1.959_964).abs() < 1e-6);
        assert!((low + high - 2.0 * middle).abs() < 1e-14);
    }
    // Quantities that are not part of the model are left out.
    assert!(
        known.interval(InferredQuantity::Z).is_none()
            && known.stddev(InferredQuantity::EpsStiffness).is_none()
    );
}

/// ε depends on G13 and G12 equally and on no other modulus; k depends almost only on the bulk modulus.
#[test]
fn information_is_the_contribution_of_each_datum() {
    let o = table3::rows()[0].observation().with_relative_error(0.01);
    let e = model("ratio").infer(&o, &Calibration::PAPER).unwrap();
    let [g12, g13, theta, others @ ..] = e.information(InferredQuantity::Eps).unwrap();
    assert!((g12 - 0.5).abs() < 1e-6 && (g13 - 0.5).abs() < 1e-6 && theta < 1e-6, "{g12} {g13} {theta}");
    assert_eq!(others, [0.0; INPUTS - 3]);
    let of_k = e.information(InferredQuantity::K).unwrap();
    assert!(
        of_k[Modulus::Theta as usize] > 0.95 && (of_k.iter().sum::<f64>() - 1.0).abs() < 1e-12,
        "{of_k:?}"
    );
}
