//! Packings that were sheared after they were pressed, other than those that taught.

use crate::left_out::truth;
use crate::{csv, ours};
use grainlab_calibration::CalibrationSample;
use grainlab_core::contact::{ContactLaw, Rough, SpringLaw};
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{Observation, StrainRatioSource};

/// At unchanged contacts their stiffness follows q/p less than in the packings taught. `--nocapture` prints the numbers that the README
/// of `grainlab_emt` has.
#[test]
fn intervals_contain_the_counts_of_rough_packings_that_were_sheared() {
    let springs = SpringLaw::Rough(Rough { roughness: 1e-7, tangential_factor: 0.7 });
    let observed = |sample: &CalibrationSample| {
        let mut observation = sample.observation(StrainRatioSource::Zero);
        observation.conditions.contact_law = Some(ContactLaw { springs, ..ContactLaw::default() });
        observation
    };
    let quantities = [InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::EpsStiffness];
    covers("sheared_rough.csv", "free-contact", &quantities, observed, 94);
}

#[test]
fn intervals_of_eps_contain_the_count_of_packings_sheared_without_sliding() {
    let observed =
        |sample: &CalibrationSample| sample.observation(StrainRatioSource::Zero).with_relative_error(0.01);
    covers("locked.csv", "relaxed", &[InferredQuantity::Eps], observed, 95);
}

/// Prints the errors of rough packings beyond their posterior, by file and recipe.
#[test]
fn zz_beyond() {
    use grainlab_emt::Model as _;
    let quantities = [InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::EpsStiffness];
    let model = grainlab_emt::free_contact();
    for file in ["wide.csv", "recipes.csv", "anisotropic.csv", "sheared_rough.csv"] {
        let mut by: std::collections::BTreeMap<String, Vec<[(f64, f64); 3]>> = Default::default();
        for s in csv::samples(file) {
            let factor = if file == "sheared_rough.csv" { 0.7 } else { 1.0 };
            let springs = SpringLaw::Rough(Rough { roughness: 1e-9, tangential_factor: factor });
            let mut o = s.observation(StrainRatioSource::Zero);
            o.conditions.contact_law = Some(ContactLaw { springs, ..ContactLaw::default() });
            let Ok(e) = model.infer(&o, ours()) else { continue };
            by.entry(s.preparation.clone())
                .or_default()
                .push(quantities.map(|q| (e.structure.get(q).unwrap() - truth(&s, q), e.stddev(q).unwrap())));
        }
        let mut all = Vec::new();
        for (name, found) in by.iter().chain([(&"ALL".to_owned(), &Vec::new())]) {
            all.extend(found.iter().copied());
            let found = if name == "ALL" { &all } else { found };
            let n = found.len() as f64;
            let f = [0, 1, 2].map(|i| {
                let (mean, sq, st) = found.iter().fold((0.0, 0.0, 0.0), |(a, b, c), f| {
                    (a + f[i].0 / n, b + f[i].0 * f[i].0 / n, c + f[i].1 * f[i].1 / n)
                });
                format!("{mean:+.4} {:.4} {:.4}", sq.sqrt(), st.sqrt())
            });
            eprintln!("{file:20} {name:22} {:4} {}", found.len(), f.join("   "));
        }
    }
}

/// Prints how often the intervals of quantities contain their counts in the samples of a table, %, and asks for `least`.
fn covers(
    table: &str,
    model: &str,
    quantities: &[InferredQuantity],
    observed: impl Fn(&CalibrationSample) -> Observation,
    least: usize,
) {
    let model = grainlab_emt::model(model).unwrap();
    let infer = |sample: CalibrationSample| (model.infer(&observed(&sample), ours()).unwrap(), sample);
    let found: Vec<_> = csv::samples(table).into_iter().map(infer).collect();
    for quantity in quantities.iter().copied() {
        let (mut squares, mut sum, mut inside) = (0.0, 0.0, 0);
        for (found, sample) in &found {
            let counted = truth(sample, quantity);
            let error = found.structure.get(quantity).unwrap() - counted;
            sum += error;
            squares += (error / found.stddev(quantity).unwrap()).powi(2);
            let [low, high] = found.interval(quantity).unwrap();
            inside += usize::from((low..=high).contains(&counted));
        }
        let n = found.len();
        let (rms, mean) = ((squares / n as f64).sqrt(), sum / n as f64);
        eprintln!(
            "{table}, {} of {n} states: mean error {mean:.3}, rms {rms:.2} stated errors; {inside} in the 95 % intervals",
            quantity.symbol()
        );
        assert!(inside * 100 >= n * least, "{quantity}: {inside} of {n}");
    }
}
