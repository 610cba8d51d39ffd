//! The models of rock physics on counted packings.

use crate::csv;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{Calibration, CalibrationSample, Estimate, StrainRatioSource, Warning};

fn estimates(samples: &[CalibrationSample], model: &str) -> Vec<(f64, Estimate)> {
    let model = grainlab_emt::model(model).unwrap();
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
    let held_out = csv::samples("held_out.csv");
    for model in ["hertz-mindlin", "johnson"] {
        let errors: Vec<f64> = estimates(&held_out, model)
            .iter()
            .map(|(k, e)| e.structure.get(InferredQuantity::K).unwrap() - k)
            .collect();
        let bias = mean(errors.iter().copied());
        let scatter = mean(errors.iter().map(|e| (e - bias).powi(2))).sqrt();
        assert!((-0.9..-0.8).contains(&bias) && scatter < 0.06, "{model}: {bias} {scatter}");
    }
}

/// Contacts stick in these networks, all of them; f stands for the relaxation of the network.
#[test]
fn the_share_of_contacts_that_stick_is_a_fit_and_no_property_of_the_contacts() {
    for (name, mean_share, some_negative) in [("held_out.csv", 0.29, false), ("wide.csv", 0.25, true)] {
        let shares: Vec<f64> = estimates(&csv::samples(name), "hertz-mindlin")
            .iter()
            .filter_map(|(_, e)| {
                e.warnings.iter().find_map(|w| match w {
                    Warning::StickingShare { share } => Some(*share),
                    _ => None,
                })
            })
            .collect();
        let found = mean(shares.iter().copied());
        let [low, high] = [f64::min, f64::max].map(|of| shares.iter().copied().reduce(of).unwrap());
        eprintln!("{name}: f {found:.2}, from {low:.2} to {high:.2}, of {} states", shares.len());
        assert!((found - mean_share).abs() < 0.01 && (low < 0.0) == some_negative && high < 0.7);
    }
}

/// The constants of `models/uniform_strain.rs`, with the bias in them: the intervals are wide.
#[test]
fn the_error_they_state_is_that_over_the_packings_of_the_calibration() {
    let files = ["isotropic.csv", "anisotropic.csv", "wide.csv"];
    let taught: Vec<_> = files.into_iter().flat_map(csv::samples).collect();
    let held_out = csv::samples("held_out.csv");
    for model in ["hertz-mindlin", "johnson"] {
        let found = estimates(&taught, model);
        let k = |e: &Estimate| e.structure.k.unwrap();
        let rms = mean(found.iter().map(|(truth, e)| (truth / k(e) - 1.0).powi(2))).sqrt();
        let e = &found[0].1;
        let stated =
            e.model_covariance.unwrap()[(InferredQuantity::K as usize, InferredQuantity::K as usize)];
        eprintln!("{model}: error of k over k {rms:.3}");
        assert!((stated.sqrt() / k(e) - rms).abs() < 0.005, "{model}: {stated} {rms}");
        let Some(_) = e.structure.eps_stiffness else { continue };
        let errors = taught.iter().zip(&found);
        let errors = errors.map(|(s, (_, e))| (e.structure.eps_stiffness.unwrap() - s.eps_stiffness).powi(2));
        let rms = mean(errors).sqrt();
        let at = InferredQuantity::EpsStiffness as usize;
        let stated = e.model_covariance.unwrap()[(at, at)].sqrt();
        eprintln!("{model}: error of eps_k {rms:.3}");
        assert!((stated - rms).abs() < 0.01, "{model}: {stated} {rms}");
        let inside = |s: &&CalibrationSample| {
            let observed = s.observation(StrainRatioSource::Zero).with_relative_error(0.01);
            let e = grainlab_emt::model(model).unwrap().infer(&observed, &Calibration::PAPER).unwrap();
            let holds = |q, truth| {
                let [low, high] = e.interval(q).unwrap();
                (low..=high).contains(&truth)
            };
            holds(InferredQuantity::K, s.k) && holds(InferredQuantity::EpsStiffness, s.eps_stiffness)
        };
        let share = held_out.iter().filter(inside).count() as f64 / held_out.len() as f64;
        assert!(share > 0.95, "{model}: {share}");
    }
}
