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
