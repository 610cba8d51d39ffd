//! Packings that were sheared after they were pressed, other than those that taught.

use crate::left_out::truth;
use crate::{csv, ours};
use grainlab_calibration::CalibrationSample;
use grainlab_core::contact::{ContactLaw, Rough, SpringLaw};
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{Observation, ROUGH_CONTACTS, StrainRatioSource};
use grainlab_testkit::golden::Table;
use std::collections::BTreeMap;

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

/// Of the packings of `rough_recipes.csv` whose grains overlap by less than three times their roughness: recipes count alike.
#[test]
fn the_errors_beyond_the_posterior_of_rough_packings_are_those_of_recipes_that_teach() {
    const QUANTITIES: [InferredQuantity; 3] =
        [InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::EpsStiffness];
    /// 97.5 % of a Student distribution of 15 degrees of freedom, over 1.96.
    const OF_FEW: f64 = 1.087;
    let t = Table::read("ensembles/rough_recipes.csv");
    let mut recipes: BTreeMap<String, Vec<[f64; 3]>> = BTreeMap::new();
    for (s, row) in csv::samples("rough_recipes.csv").into_iter().zip(&t.rows) {
        let roughness = t.number(row, "roughness");
        // The radius is 0.1 mm.
        let overlap = 1e-4 * (s.pressure / s.material.shear_modulus).powf(2.0 / 3.0);
        if overlap > 3.0 * roughness {
            continue;
        }
        let springs = SpringLaw::Rough(Rough { roughness, tangential_factor: 0.7 });
        let mut o = s.observation(StrainRatioSource::Zero);
        o.conditions.contact_law = Some(ContactLaw { springs, ..ContactLaw::default() });
        let found = grainlab_emt::free_contact().infer(&o, ours()).unwrap();
        let beyond = |(q, added): (InferredQuantity, f64)| {
            let off = found.structure.get(q).unwrap() - truth(&s, q);
            off * off - found.stddev(q).unwrap().powi(2) + added * added
        };
        let all = QUANTITIES.into_iter().zip(ROUGH_CONTACTS).map(beyond);
        recipes.entry(s.preparation.clone()).or_default().push(all.collect::<Vec<_>>().try_into().unwrap());
    }
    let n = recipes.len() as f64;
    for (i, kept) in ROUGH_CONTACTS.into_iter().enumerate() {
        let mean = |all: &Vec<[f64; 3]>| all.iter().map(|a| a[i]).sum::<f64>() / all.len() as f64;
        let fitted = OF_FEW * (recipes.values().map(mean).sum::<f64>() / n).sqrt();
        eprintln!("{}: {fitted:.4} of {n} recipes", QUANTITIES[i]);
        assert!((fitted / kept - 1.0).abs() < 0.03, "{fitted} {kept}");
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
