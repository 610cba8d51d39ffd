//! Samples whose contacts the inversion does not know, made by recipes that taught nothing: speeds at six pressures, of contacts,
//! frictions, sizes and Poisson's ratios at random.

use crate::{csv, ours};
use grainlab_calibration::CalibrationSample;
use grainlab_core::contact::{ContactLaw, Rough, SpringLaw};
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{
    ContactKind, Interval, Modulus, SeriesPrior, SeriesRow, SpeedMode, SpeedSeries, StrainRatioSource,
    infer_series,
};
use grainlab_testkit::golden::Table;
use grainlab_testkit::{Random, nightly};
use std::f64::consts::FRAC_PI_2;

/// No z above is stated.
const HIGHEST: f64 = 6.6;

/// Sample with its k_t/k_n and roughness, m; states in the order of the pressure.
struct Sample {
    states: Vec<CalibrationSample>,
    stiffness_ratio: f64,
    roughness: f64,
}

fn samples() -> Vec<Sample> {
    let t = Table::read("ensembles/series.csv");
    let mut all: Vec<Sample> = Vec::new();
    for (state, row) in csv::samples("series.csv").into_iter().zip(&t.rows) {
        match all.last_mut().filter(|s| s.states[0].packing == state.packing) {
            Some(sample) => sample.states.push(state),
            None => all.push(Sample {
                stiffness_ratio: t.number(row, "stiffness_ratio"),
                roughness: t.number(row, "roughness"),
                states: vec![state],
            }),
        }
    }
    all
}

/// Errors of a laboratory: of each speed, and of density, pressure and grain modulus as stated and as made, all relative.
#[derive(Clone, Copy)]
struct Errors {
    stated: [f64; 3],
    /// Errors made; `None` draws them.
    made: Option<[f64; 3]>,
}

const SPEED: f64 = 0.01;
const ORDINARY: Errors = Errors { stated: [0.01, 0.0, 0.05], made: None };

/// Speeds of P along and across the axis, SV across it, and SH.
fn measured(sample: &Sample, errors: Errors, random: &mut Random) -> SpeedSeries {
    let drawn = errors.stated.map(|stated| stated * random.normal());
    let [density, pressure, modulus] = errors.made.unwrap_or(drawn).map(|error| 1.0 + error);
    let waves = [
        (Modulus::C33, SpeedMode::P, 0.0),
        (Modulus::C11, SpeedMode::P, FRAC_PI_2),
        (Modulus::G13, SpeedMode::Sv, FRAC_PI_2),
        (Modulus::G12, SpeedMode::Sh, FRAC_PI_2),
    ];
    let mut rows = Vec::new();
    for state in &sample.states {
        let true_density = state.solid_fraction * state.material.density;
        for (of, mode, angle) in waves {
            let speed = (state.moduli.get(of).unwrap() / true_density).sqrt();
            rows.push(SeriesRow {
                pressure: state.pressure * pressure,
                density: true_density * density,
                mode,
                angle: Some(angle),
                speed: Some(speed * (1.0 + SPEED * random.normal())),
                stddev: SPEED,
                common_stddev: 0.0,
            });
        }
    }
    let first = &sample.states[0];
    let mut material = first.material;
    material.shear_modulus *= modulus;
    let [density_stddev, pressure_stddev, shear_modulus_stddev] = errors.stated;
    SpeedSeries {
        density_stddev,
        pressure_stddev,
        shear_modulus_stddev,
        size_variance: [first.size_spread.powi(2), 0.0],
        grains: Some(first.grains),
        ..SpeedSeries::of(rows, material)
    }
}

/// Share of the truths inside their intervals, with errors, in one quantity.
#[derive(Default)]
struct Found {
    inside: Vec<bool>,
    errors: Vec<f64>,
    stddevs: Vec<f64>,
    prior: Vec<f64>,
}

impl Found {
    fn add(&mut self, of: &Interval, truth: f64) {
        self.inside.push((of.low - 1e-3..=of.high + 1e-3).contains(&truth));
        self.errors.push(of.mean - truth);
        self.stddevs.push(of.stddev);
        self.prior.push(of.prior_stddev);
    }

    fn coverage(&self) -> f64 {
        self.inside.iter().filter(|i| **i).count() as f64 / self.inside.len() as f64
    }

    fn rms(&self) -> f64 {
        (self.errors.iter().map(|e| e * e).sum::<f64>() / self.errors.len() as f64).sqrt()
    }

    fn print(&self, name: &str) {
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
        println!(
            "{name:<16} {:.3} of {} inside, rms {:.4}, bias {:+.4}, stated {:.4}, prior {:.4}",
            self.coverage(),
            self.inside.len(),
            self.rms(),
            mean(&self.errors),
            mean(&self.stddevs),
            mean(&self.prior)
        );
    }
}

/// z, ε, ε weighted by stiffness, and k_t/k_n.
fn judged(every: usize, errors: Errors, prior: &SeriesPrior, is_known: bool) -> [Found; 4] {
    let network = ours().network().unwrap();
    let mut random = Random::new(31);
    let mut found: [Found; 4] = Default::default();
    for sample in samples().iter().step_by(every) {
        let mut series = measured(sample, errors, &mut random);
        if is_known && sample.roughness > 0.0 {
            let roughness = sample.roughness * (0.1 * random.normal()).exp();
            let phi = sample.states[0].solid_fraction;
            let crossover = ContactKind::crossover(roughness / 2e-4, &series.material, phi);
            series.ln_crossover = Some([crossover.ln(), 0.15]);
        }
        let estimate = infer_series(&series, network, prior).unwrap();
        for (state, at) in sample.states.iter().zip(&estimate.pressures) {
            found[0].add(&at.z, state.z.min(HIGHEST));
            found[1].add(&at.eps.unwrap(), state.eps);
            found[2].add(&at.eps_stiffness.unwrap(), state.eps_stiffness);
        }
        found[3].add(&estimate.stiffness_ratio, sample.stiffness_ratio);
    }
    let names =
        [InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::EpsStiffness].map(|q| q.name());
    for (found, name) in found.iter().zip(names.into_iter().chain(["k_t/k_n"])) {
        found.print(name);
    }
    found
}

/// Checks shares inside the intervals: 0.91 of all samples, which is 0.92 less a standard error; few samples scatter more.
fn assert_inside(found: &[Found; 4], of_few: f64) {
    let low = nightly(of_few, 0.91);
    for (found, name) in found.iter().zip(["z", "eps", "eps_stiffness", "k_t/k_n"]) {
        assert!(found.coverage() > low, "{name}: {}", found.coverage());
    }
    let [z, ..] = found;
    let prior = z.prior.iter().sum::<f64>() / z.prior.len() as f64;
    assert!(z.rms() < 0.5 * prior, "{} {prior}", z.rms());
}

#[test]
fn samples_with_contacts_that_are_not_known_are_inside_their_intervals() {
    assert_inside(&judged(nightly(30, 1), ORDINARY, SeriesPrior::builtin(), false), 0.8);
}

#[test]
fn samples_with_inputs_that_are_wrong_by_two_of_their_errors_are_inside_their_intervals() {
    let wrong = Errors { stated: [0.015, 0.025, 0.05], made: Some([0.03, 0.05, 0.1]) };
    assert_inside(&judged(nightly(50, 1), wrong, SeriesPrior::builtin(), false), 0.75);
}

/// Roughness to 10 %. Ten samples: three standard errors below .92.
#[test]
fn samples_with_a_known_roughness_are_inside_their_intervals() {
    let rough = SeriesPrior::builtin().of_law(ContactKind::Rough);
    assert_inside(&judged(nightly(30, 1), ORDINARY, &rough, true), 0.7);
}

/// Moduli with errors of 1 % at one pressure, by `free-contact`: without a contact law, and with it.
#[test]
fn single_states_are_inside_their_intervals_with_contacts_that_are_not_known_and_that_are() {
    let calibration = ours();
    for (few, is_known) in [(30, false), (15, true)] {
        let mut random = Random::new(7);
        let [mut z, mut eps] = [Found::default(), Found::default()];
        for sample in samples().iter().step_by(nightly(few, 1)) {
            for state in &sample.states {
                let mut observed = state.observation(StrainRatioSource::Zero).with_relative_error(0.01);
                observed.moduli = observed.moduli.without(Modulus::C13);
                let moduli = observed.moduli;
                for (modulus, value) in moduli.known() {
                    observed.moduli = observed.moduli.with(modulus, value * (1.0 + 0.01 * random.normal()));
                }
                let tangential_factor = sample.stiffness_ratio / state.material.stiffness_ratio();
                let springs = SpringLaw::Rough(Rough { roughness: sample.roughness, tangential_factor });
                observed.conditions.contact_law = is_known.then(|| ContactLaw::of(springs));
                let found = grainlab_emt::free_contact().infer(&observed, calibration).unwrap();
                for (of, q, truth) in [
                    (&mut z, InferredQuantity::Z, state.z.min(HIGHEST)),
                    (&mut eps, InferredQuantity::Eps, state.eps),
                ] {
                    let [low, high] = found.interval(q).unwrap();
                    let (mean, stddev) = (found.structure.get(q).unwrap(), found.stddev(q).unwrap());
                    of.add(&Interval { mean, stddev, low, high, prior_stddev: f64::NAN }, truth);
                }
            }
        }
        println!("one pressure, contact law {}", if is_known { "known" } else { "not known" });
        z.print("z");
        eps.print("eps");
        let least = nightly(0.8, 0.85);
        assert!(z.coverage() > least && eps.coverage() > least, "{} {}", z.coverage(), eps.coverage());
    }
}
