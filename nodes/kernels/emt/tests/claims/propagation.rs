//! First-order error propagation.

use crate::table3;
use emt::{Calibration, Gamma, GammaSource, Model, Observation, Structure, models};
use grains::Mat3;
use nalgebra::{Matrix3x5, Matrix5, Vector3};
use proptest::prelude::*;

/// The observation with (ln G12, ln G13, ln Θ, ln p, g) shifted by `by` in entry `which`.
fn shifted(o: &Observation, which: usize, by: f64) -> Observation {
    let mut o = o.clone();
    match which {
        0 => o.g12 *= by.exp(),
        1 => o.g13 *= by.exp(),
        2 => o.theta *= by.exp(),
        3 => o.pressure *= by.exp(),
        _ => o.gamma.value += by,
    }
    o
}

/// Slopes of (k, k̂, ε) by central differences.
fn slopes(model: &dyn Model, o: &Observation) -> Matrix3x5<f64> {
    const STEP: f64 = 1e-5;
    let at = |which, by| {
        let s = model.infer(&shifted(o, which, by), &Calibration::PAPER).unwrap().structure;
        Vector3::new(s.k, s.k_hat, s.eps)
    };
    Matrix3x5::from_columns(&[0, 1, 2, 3, 4].map(|i| (at(i, STEP) - at(i, -STEP)) / (2.0 * STEP)))
}

proptest! {
    /// Correlated errors of all five inputs. Central differences with step h = 1e-5 are off by h² times a third
    /// derivative, which reaches some 1e3 times the value where s is near 1: 1e-6 of the largest entry.
    #[test]
    fn covariance_agrees_with_finite_differences(
        k in 3.0..8.0f64, k_hat in 4.0..8.0f64, eps in -0.45..0.9f64, g in -0.4..0.2f64,
        root in prop::array::uniform9(-1.0..1.0f64), p_error in 0.0..0.1f64, g_error in 0.0..0.1f64,
    ) {
        for model in models() {
            let gamma = Gamma { value: g, stddev: g_error, source: GammaSource::Given };
            let mut o = model.predict(&Structure { k, k_hat, eps }, gamma, 80.0e3, &Calibration::PAPER);
            let scale = Mat3::from_diagonal(&Vector3::new(o.g12, o.g13, o.theta));
            let root = Mat3::from_row_slice(&root) * 0.02;
            let relative = root * root.transpose();
            o.pressure_stddev = p_error * o.pressure;
            o = o.with_covariance(scale * relative * scale);

            let mut input = Matrix5::zeros();
            input.fixed_view_mut::<3, 3>(0, 0).copy_from(&relative);
            input[(3, 3)] = p_error * p_error;
            input[(4, 4)] = g_error * g_error;
            let j = slopes(*model, &o);
            let expected = j * input * j.transpose();
            let found = model.infer(&o, &Calibration::PAPER).unwrap().covariance.unwrap();
            prop_assert!((found - expected).amax() < 1e-6 * expected.amax(), "{}: {found} {expected}", model.name());
        }
    }
}

/// One percent on each modulus, independent: extremes over the rows of Table III, computed apart from this code by
/// finite differences and rounded to the digits given.
#[test]
fn one_percent_on_each_modulus_costs_what_is_known() {
    let ratio = emt::model("ratio").unwrap();
    let mut extremes = [[f64::INFINITY, 0.0]; 3];
    for row in table3::rows() {
        let o = row.observation("ratio").with_relative_error(0.01);
        let sigma = ratio.infer(&o, &Calibration::PAPER).unwrap().stddev().unwrap();
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
fn an_error_of_g_reaches_eps_and_k_but_not_the_corrected_k_hat() {
    let row = &table3::rows()[8];
    let sigma = |name: &str| {
        let mut o = row.observation(name).with_relative_error(0.0);
        o.gamma.stddev = 0.05;
        emt::model(name).unwrap().infer(&o, &Calibration::PAPER).unwrap().stddev().unwrap()
    };
    let corrected = sigma("ratio");
    assert!(corrected[1] < 1e-15 && corrected[2] > 0.04, "{corrected:?}");
    assert!(sigma("ratio-as-printed")[1] > 1e-3);
}

#[test]
fn unknown_uncertainty_stays_unknown_and_a_known_one_gives_the_95_percent_interval() {
    let ratio = emt::model("ratio").unwrap();
    let o = table3::rows()[0].observation("ratio");
    let unknown = ratio.infer(&o, &Calibration::PAPER).unwrap();
    assert!(unknown.covariance.is_none() && unknown.stddev().is_none() && unknown.interval().is_none());
    let known = ratio.infer(&o.with_relative_error(0.01), &Calibration::PAPER).unwrap();
    let (sigma, interval) = (known.stddev().unwrap(), known.interval().unwrap());
    assert_eq!(emt::CREDIBLE_LEVEL, 0.95);
    for (s, [low, high]) in sigma.into_iter().zip(interval) {
        assert!(((high - low) / (2.0 * s) - 1.959_964).abs() < 1e-6);
    }
    assert!((interval[0][0] + interval[0][1] - 2.0 * known.structure.k).abs() < 1e-14);
}
