//! The model of rock physics on counted packings.

use crate::csv;
use grainlab_calibration::CalibrationSample;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{Calibration, Inversion, StrainRatioSource};

fn estimates(samples: &[CalibrationSample]) -> Vec<(f64, Inversion)> {
    let model = grainlab_emt::model("hertz-mindlin").unwrap();
    let one = |s: &CalibrationSample| {
        (s.k, model.infer(&s.observation(StrainRatioSource::Zero), &Calibration::PAPER).unwrap())
    };
    samples.iter().map(one).collect()
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().sum::<f64>() / values.count() as f64
}

/// A pack under uniform strain is stiffer than a real one of as many contacts, which can relax: it needs fewer.
#[test]
fn uniform_strain_infers_too_few_contacts_and_by_nearly_the_same_number() {
    let errors: Vec<f64> = estimates(&csv::samples("held_out.csv"))
        .iter()
        .map(|(k, e)| e.structure.get(InferredQuantity::K).unwrap() - k)
        .collect();
    let bias = mean(errors.iter().copied());
    let scatter = mean(errors.iter().map(|e| (e - bias).powi(2))).sqrt();
    assert!((-0.9..-0.8).contains(&bias) && scatter < 0.06, "{bias} {scatter}");
}

/// Contacts stick in these networks, all of them; f stands for the relaxation of the network.
#[test]
fn the_share_of_contacts_that_stick_is_a_fit_and_no_property_of_the_contacts() {
    for (name, mean_share, some_negative) in [("held_out.csv", 0.29, false), ("wide.csv", 0.25, true)] {
        let shares: Vec<f64> = estimates(&csv::samples(name))
            .iter()
            .filter_map(|(_, e)| e.notes.iter().find_map(|note| note.value("share")))
            .collect();
        let found = mean(shares.iter().copied());
        let [low, high] = [f64::min, f64::max].map(|of| shares.iter().copied().reduce(of).unwrap());
        eprintln!("{name}: f {found:.2}, from {low:.2} to {high:.2}, of {} states", shares.len());
        assert!((found - mean_share).abs() < 0.01 && (low < 0.0) == some_negative && high < 0.7);
    }
}

/// The constant of `models/hertz_mindlin.rs`, with the bias in it.
#[test]
fn the_error_it_states_is_that_over_the_packings_of_the_calibration() {
    let files = ["isotropic.csv", "anisotropic.csv", "wide.csv"];
    let found = estimates(&files.into_iter().flat_map(csv::samples).collect::<Vec<_>>());
    let k = |e: &Inversion| e.structure.k.unwrap();
    let rms = mean(found.iter().map(|(truth, e)| (truth / k(e) - 1.0).powi(2))).sqrt();
    let (e, at) = (&found[0].1, InferredQuantity::K as usize);
    let stated = e.model_covariance.unwrap()[(at, at)];
    eprintln!("error of k over k {rms:.3}");
    assert!((stated.sqrt() / k(e) - rms).abs() < 0.005, "{stated} {rms}");
}
