//! The relaxed network: the estimate from any set of moduli, and its uncertainty.

use crate::ours;
use grainlab_core::Material;
use grainlab_core::notes::{Code, Note, Status};
use grainlab_core::results::{InferredQuantity, Microstructure};
use grainlab_emt::Relaxed;
use grainlab_emt::{
    Calibration, Conditions, EmtError, Inversion, Measured, Model, Moduli, Modulus, NetworkState,
    Observation, Posterior, PosteriorSettings, Prior, Probe, RelaxationCalibration, ScatterLevels,
    UNKNOWN_SIZE_SPREAD, UNKNOWN_STRESS_RATIO,
};
use grainlab_testkit::Random;

fn conditions() -> Conditions {
    Conditions {
        stress_ratio: Some(Measured::exact(0.0)),
        size_spread: Some(0.0),
        material: Some(Material::GLASS),
        ..Conditions::at(100e3)
    }
}

fn structure(z: f64, eps: f64) -> Microstructure {
    Microstructure { z: Some(z), eps: Some(eps), ..Microstructure::default() }
}

fn moduli(z: f64, eps: f64) -> Moduli {
    Relaxed.predict(&structure(z, eps), &conditions(), ours()).unwrap()
}

fn infer(moduli: Moduli) -> Result<Inversion, EmtError> {
    Relaxed.infer(&Observation::new(moduli, conditions()).with_relative_error(0.005), ours())
}

fn only(all: &Moduli, kept: &[Modulus]) -> Moduli {
    kept.iter().fold(Moduli::NONE, |m, k| m.with(*k, all.get(*k).unwrap()))
}

#[test]
fn missing_moduli_leave_the_rest_and_undetermined_quantities_are_listed() {
    use Modulus::{C11, C33, G12, G13, Theta};
    let all = moduli(5.3, 0.05);
    for set in [&[G12, G13, Theta][..], &[C11, C33], &[G12, G13], &[C11, C33, G12, G13], &[C33, Theta]] {
        let found = infer(only(&all, set)).unwrap();
        assert!((found.structure.z.unwrap() - 5.3).abs() < 1e-9, "{set:?}: {:?}", found.structure);
        assert!((found.structure.eps.unwrap() - 0.05).abs() < 1e-9, "{set:?}: {:?}", found.structure);
    }
    // One modulus does not determine ε, and determines z less well than two.
    for one in [G12, Theta, C33] {
        let found = infer(only(&all, &[one])).unwrap();
        assert_eq!((found.structure.eps, found.structure.eps_stiffness), (None, None), "{one}");
        let off = (found.structure.z.unwrap() - 5.3).abs();
        assert!(off < 2.0 * found.stddev(InferredQuantity::Z).unwrap(), "{one}: {found:?}");
        let together = infer(all).unwrap();
        assert!(found.stddev(InferredQuantity::Z) > together.stddev(InferredQuantity::Z), "{one}");
    }
    let nothing = Relaxed.infer(&Observation::new(Moduli::NONE, conditions()), ours()).unwrap_err();
    assert!(matches!(nothing, EmtError::Missing { .. }), "{nothing}");
}

#[test]
fn more_moduli_are_never_worse() {
    use Modulus::{C11, C33, G12, G13, Theta};
    let all = moduli(5.1, 0.04);
    let sigma = |set: &[Modulus]| infer(only(&all, set)).unwrap().stddev(InferredQuantity::Eps).unwrap();
    let (three, four, five) = (sigma(&[G12, G13, Theta]), sigma(&[G12, G13, C11, C33]), infer(all).unwrap());
    assert!(three > 1.5 * four, "{three} {four}: P moduli carry more of eps than the ratio of shear moduli");
    assert!(four >= five.stddev(InferredQuantity::Eps).unwrap());
}

/// Samples drawn from the scatter of packings assumed by the model, with these measurement errors: the
/// intervals have their stated coverage. Data with 30 % error give a wide interval or a typed error, never a
/// wrong estimate with a small uncertainty.
#[test]
fn intervals_contain_the_truth_as_often_as_stated_at_any_noise() {
    let network = ours().network().unwrap();
    let mut random = Random::new(7);
    for (noise, at_least_solved) in [(0.0, 1.0), (0.01, 1.0), (0.05, 0.999), (0.3, 0.5)] {
        let (mut solved, mut held) = (0.0, [0.0; 2]);
        const DRAWS: usize = 4000;
        for _ in 0..DRAWS {
            let (z, eps) = (random.between(4.9, 5.7), random.between(-0.06, 0.08));
            let exact = moduli(z, eps);
            let scattered = scattered(&exact, network, z, &mut random);
            let observed = scattered.map(|m| m.map(|m| m * (1.0 + noise * random.normal())));
            let observation = Observation::new(Moduli::of_values(observed), conditions());
            let observation = observation.with_relative_error(noise);
            let Ok(found) = Relaxed.infer(&observation, ours()) else { continue };
            solved += 1.0;
            let warned = found.notes.iter().any(|w| w.is(Code::ErrorsLarge));
            assert_eq!(warned, noise > 0.1);
            for (i, (q, truth)) in
                [(InferredQuantity::Z, z), (InferredQuantity::Eps, eps)].into_iter().enumerate()
            {
                let Some([low, high]) = found.interval(q) else {
                    held[i] += 1.0;
                    continue;
                };
                assert!(low.is_finite() && high.is_finite());
                held[i] += f64::from(u8::from((low..=high).contains(&truth)));
            }
        }
        assert!(solved / DRAWS as f64 >= at_least_solved, "noise {noise}: {solved} of {DRAWS} solved");
        if noise < 0.1 {
            for held in held {
                let share = held / solved;
                assert!(
                    (0.93..=0.97).contains(&share),
                    "noise {noise}: {share} of the intervals hold the truth"
                );
            }
        } else {
            // Far outside first order, for which every estimate has a warning.
            assert!(held.iter().all(|h| h / solved > 0.6), "noise {noise}: {held:?} of {solved}");
        }
    }
}

/// The five independent moduli of a sample with this mean, in the order of [`Modulus::ALL`] and without Θ.
fn scattered(
    mean: &Moduli,
    network: &RelaxationCalibration,
    z: f64,
    random: &mut Random,
) -> [Option<f64>; 6] {
    // Glass at 100 kPa, of equal grains; the number of grains is unknown.
    let state = NetworkState::of(100e3, &Material::GLASS, 0.0, 0.0);
    let growth = RelaxationCalibration::growth(&network.scatter_by_state, &state);
    let of_size = RelaxationCalibration::sample_variances(network.grains, None);
    let [of_recipe, of_sample] = ScatterLevels::weights(z);
    let [recipe, sample] = network.scatter.matrices();
    let covariance = nalgebra::Matrix5::from_fn(|i, j| {
        let recipe = recipe[(i, j)] / (of_recipe[i] * of_recipe[j]);
        let sample = sample[(i, j)] * (of_size[i] * of_size[j]).sqrt() / (of_sample[i] * of_sample[j]);
        (recipe + sample) * (growth[i] * growth[j]).sqrt()
    });
    let off = covariance.cholesky().unwrap().l() * nalgebra::Vector5::from_fn(|_, _| random.normal());
    let at = grainlab_emt::Invariants::of(mean).unwrap();
    let [ln_theta, ln_shear, dilatation, voigt, harmonic]: [f64; 5] =
        std::array::from_fn(|i| at.values()[i] + off[i]);
    let moved = grainlab_emt::Invariants { ln_theta, ln_shear, dilatation, voigt, harmonic };
    let mut values = moved.moduli().map(Some);
    values[Modulus::Theta as usize] = None;
    values
}

#[test]
fn contradictory_data_give_a_warning_that_names_the_outlier() {
    let sound = moduli(5.2, 0.03);
    let conflict = |m: Moduli| {
        let found = infer(m).unwrap();
        let note = found.notes.into_iter().find(|note| note.is(Code::Conflict))?;
        let worst = Modulus::ALL.into_iter().find(|modulus| note.names(modulus.name()))?;
        Some((worst, note.value("chi_square")?))
    };
    assert_eq!(conflict(sound), None);
    for modulus in [Modulus::G12, Modulus::C11] {
        let wrong = sound.without(Modulus::Theta).with(modulus, 1.2 * sound.get(modulus).unwrap());
        let (worst, chi_square) = conflict(wrong).unwrap();
        assert!(worst == modulus && chi_square > 16.3, "{modulus}: {worst} is blamed, {chi_square}");
    }
}

/// Six moduli are one more than a medium has: the sixth is a check, and is used.
#[test]
fn a_theta_that_contradicts_the_other_five_gives_a_warning_about_given_moduli_only() {
    let sound = moduli(5.2, 0.03);
    let wrong = sound.with(Modulus::Theta, 1.3 * sound.get(Modulus::Theta).unwrap());
    let imbalance = |w: &Note| w.is(Code::Imbalance);
    let conflict = |w: &Note| w.is(Code::Conflict);
    assert!(!infer(sound).unwrap().notes.iter().any(imbalance));
    let found = infer(wrong).unwrap();
    assert!(found.notes.iter().any(imbalance) && found.notes.iter().any(conflict), "{found:?}");
    // Without errors there are no weights, and the five are taken; the warning is still given.
    let exact = Relaxed.infer(&Observation::new(wrong, conditions()), ours()).unwrap();
    assert!(exact.notes.iter().any(imbalance));
    assert!((exact.structure.eps.unwrap() - 0.03).abs() < 1e-9);

    let found = infer(wrong.without(Modulus::C13)).unwrap();
    let blamed = found.notes.iter().find(|note| note.is(Code::Conflict));
    assert!(blamed.is_some_and(|note| !note.names("C13")), "{:?}", found.notes);
    assert_eq!(found.information(InferredQuantity::Z).unwrap()[Modulus::C13 as usize], 0.0);
}

/// At the least errors the covariance of six would be singular but for rounding.
#[test]
fn a_theta_that_follows_from_the_other_moduli_adds_nothing_at_any_error() {
    let off = [(Modulus::G12, 1.02), (Modulus::C33, 0.99), (Modulus::C13, 1.03)];
    let sound = moduli(5.2, 0.03).without(Modulus::Theta);
    let five = off.iter().fold(sound, |m, (q, by)| m.with(*q, by * m.get(*q).unwrap()));
    let six = Observation::new(five, conditions()).checked().unwrap().moduli;
    let theta = six.get(Modulus::Theta).unwrap();
    for error in [0.0, 1e-7, 8e-7, 2e-6, 5e-6, 1e-5, 2e-5, 4e-5, 1e-3, 0.01] {
        let infer = |m: Moduli| {
            let o = Observation::new(m, conditions()).with_relative_error(error);
            Relaxed.infer(&o, ours()).unwrap_or_else(|e| panic!("{error}: {e}"))
        };
        let (with, without) = (infer(six), infer(five));
        let sigmas = |e: &Inversion| [InferredQuantity::K, InferredQuantity::Z].map(|q| e.stddev(q).unwrap());
        assert_eq!((sigmas(&with), with.misfit), (sigmas(&without), without.misfit), "{error}");
        // One that does not follow counts, where the errors leave it room.
        let measured = infer(six.with(Modulus::Theta, 1.002 * theta)).misfit.unwrap();
        assert_eq!(measured.degrees_of_freedom, if error < 1e-4 { 3 } else { 4 }, "{error}");
    }
}

/// Integrated over the priors, as an estimate for each q/p and each spread: what is unknown is in value and error, and said.
#[test]
fn unknown_stress_and_sizes_are_marginalised_and_they_and_the_number_of_grains_said() {
    let o = Observation::new(moduli(5.3, 0.05), conditions()).with_relative_error(0.002);
    let o = Observation { grains: Some(2000), ..o };
    let known = Relaxed.infer(&o, ours()).unwrap();
    let unknown = Conditions { stress_ratio: None, size_spread: None, ..conditions() };
    let assumed =
        Relaxed.infer(&Observation { conditions: unknown, grains: None, ..o.clone() }, ours()).unwrap();
    let unknown = [Code::StressRatioUnknown, Code::SizesUnknown, Code::GrainsUnknown];
    let told = |w: &Note| unknown.iter().any(|code| w.is(*code));
    assert_eq!(assumed.notes.iter().filter(|w| told(w)).count(), 3);
    assert!(!known.notes.iter().any(told), "{:?}", known.notes);
    // ε follows q/p linearly: its error by q/p is its range over that of q/p, times the standard deviation.
    let at = |q: f64, stddev: f64| {
        let stress_ratio = Some(Measured { value: q, stddev });
        Relaxed
            .infer(
                &Observation { conditions: Conditions { stress_ratio, ..conditions() }, ..o.clone() },
                ours(),
            )
            .unwrap()
    };
    let eps = InferredQuantity::Eps;
    let slope = (at(0.05, 0.0).structure.eps.unwrap() - at(-0.05, 0.0).structure.eps.unwrap()) / 0.1;
    let uncertain = at(0.0, UNKNOWN_STRESS_RATIO.stddev);
    let expected =
        (at(0.0, 0.0).stddev(eps).unwrap().powi(2) + (slope * UNKNOWN_STRESS_RATIO.stddev).powi(2)).sqrt();
    let (found, all) = (uncertain.stddev(eps).unwrap(), assumed.stddev(eps).unwrap());
    // Less than by the fixed weights: moduli that q/p moves get less of it.
    let known = at(0.0, 0.0).stddev(eps).unwrap();
    assert!(
        found > 1.2 * known && found < expected && all > 0.99 * found,
        "{known} {found} {expected} {all}"
    );
    let widest = assumed.widest().unwrap();
    assert!(widest.2 > 0.5 && assumed.notes.iter().any(|w| w.is(Code::WidenedMost) && w.names(widest.0)));
}

/// The prior of q/p: normal, cut at two standard deviations. That of the sizes: uniform, in the moments of the square.
#[test]
fn the_moments_of_what_is_unknown_are_those_of_the_stated_distributions() {
    let n = 200_000;
    let (mut total, mut square) = (0.0, 0.0);
    let (mut of_s2, mut of_s4) = (0.0, 0.0);
    for i in 0..n {
        let share = (f64::from(i) + 0.5) / f64::from(n);
        let q = 0.6 * share - 0.3;
        let weight = (-0.5 * (q / 0.15).powi(2)).exp();
        total += weight;
        square += weight * q * q;
        let s2 = (0.3 * share).powi(2);
        of_s2 += s2 / f64::from(n);
        of_s4 += s2 * s2 / f64::from(n);
    }
    assert!(
        UNKNOWN_STRESS_RATIO.value == 0.0
            && (UNKNOWN_STRESS_RATIO.stddev / (square / total).sqrt() - 1.0).abs() < 1e-4
    );
    let Measured { value, stddev } = UNKNOWN_SIZE_SPREAD;
    let of_square = 2.0 * value * stddev;
    assert!(
        (value * value / of_s2 - 1.0).abs() < 1e-3
            && (of_square / (of_s4 - of_s2 * of_s2).sqrt() - 1.0).abs() < 1e-3
    );
}

/// Changes one quantity of a state.
type At = fn(Conditions, f64) -> Conditions;

const PRESSURE: At =
    |c, p| Conditions { pressure: Measured::exact(p * Material::GLASS.effective_young()), ..c };
const STRESS: At = |c, q| Conditions { stress_ratio: Some(Measured::exact(q)), ..c };
const SIZES: At = |c, s| Conditions { size_spread: Some(s), ..c };

/// The ends as README states them, each with the others in the middle.
#[test]
fn the_ends_of_the_stated_domain_belong_to_it() {
    let kpa: At = |c, p| Conditions { pressure: Measured::exact(1e3 * p), ..c };
    let nu: At =
        |c, nu| Conditions { material: Some(Material { poisson_ratio: nu, ..Material::GLASS }), ..c };
    let ends: [(At, [f64; 2]); 5] = [
        (PRESSURE, [2e-8, 1.6e-4]),
        (kpa, [1.0, 5e3]),
        (nu, [0.0, 0.45]),
        (SIZES, [0.0, 0.3]),
        (STRESS, [-0.2, 0.3]),
    ];
    let inside = |z: f64, eps: f64, conditions: Conditions| {
        let moduli = Relaxed.predict(&structure(z, eps), &conditions, ours()).unwrap();
        let e =
            Relaxed.infer(&Observation::new(moduli, conditions).with_relative_error(0.01), ours()).unwrap();
        assert_eq!(e.status(), Status::Ok, "{z} {eps} {conditions:?}: {:?}", e.notes);
    };
    for (at, ends) in ends {
        ends.into_iter().for_each(|end| inside(5.3, 0.02, at(conditions(), end)));
    }
    // The first values outside have a warning.
    for (at, value) in [(STRESS, -0.201), (STRESS, 0.301), (SIZES, 0.301), (nu, 0.455)] {
        let there = at(conditions(), value);
        let moduli = Relaxed.predict(&structure(5.3, 0.02), &there, ours()).unwrap();
        let found = Relaxed.infer(&Observation::new(moduli, there), ours()).unwrap();
        assert_eq!(found.status(), Status::Extrapolated, "{value}: {:?}", found.notes);
    }
    for (z, eps) in [(4.2, 0.02), (6.4, 0.02), (5.3, -0.08), (5.3, 0.13)] {
        inside(z, eps, conditions());
    }
    // Grains of any Poisson ratio at 5 MPa.
    inside(5.3, 0.02, nu(kpa(conditions(), 5e3), 0.0));
}

/// Inside the packings taught nothing is said; beyond them there is a warning and a wider interval; further away no number.
#[test]
fn intervals_grow_outside_the_packings_taught_and_far_away_the_answer_is_unknown() {
    let ranges = ours().network().unwrap().reach;
    let [p, q, s] = [ranges.pressure, ranges.stress_ratio, ranges.size_spread].map(|range| range[1]);
    for (name, end, at, near, far) in [
        ("p/E*", p, PRESSURE, 3.0 * p, 1e3 * p),
        ("the axial stress ratio", q, STRESS, q + 0.1, q + 0.4),
        ("spread", s, SIZES, s + 0.08, s + 0.2),
    ] {
        // The moduli of Hertz contacts at this pressure, to first order.
        let infer = |value: f64| {
            let there = at(conditions(), value);
            let softer = (there.pressure.value / conditions().pressure.value).cbrt();
            let moduli = Moduli::of_values(moduli(5.3, 0.05).values().map(|m| m.map(|m| m * softer)));
            Relaxed.infer(&Observation::new(moduli, there), ours())
        };
        let is_named = |w: &Note| w.is(Code::StateOutsideCalibration) && w.subjects()[0].contains(name);
        let outside = |e: &Inversion| e.notes.iter().any(is_named);
        let (inside, beyond) = (infer(end).unwrap(), infer(near).unwrap());
        assert!(!outside(&inside) && outside(&beyond), "{name}: {inside:?} {beyond:?}");
        assert_eq!(beyond.status(), Status::Extrapolated);
        let sigma = |e: &Inversion| e.stddev(InferredQuantity::Z).unwrap();
        assert!(sigma(&beyond) > 1.2 * sigma(&inside), "{name}: {} {}", sigma(&beyond), sigma(&inside));
        let e = infer(far).unwrap_err();
        assert!(e.is(Code::TooFar) && e.to_string().contains(name), "{name}: {e}");
        assert!(e.to_string().starts_with("unknown:"), "{e}");
    }
}

#[test]
fn fewer_grains_scatter_more_and_more_grains_less() {
    let sigma = |quantity, grains| {
        let exact = Observation::new(moduli(5.3, 0.05), conditions()).with_relative_error(0.0);
        Relaxed.infer(&Observation { grains, ..exact }, ours()).unwrap().stddev(quantity).unwrap()
    };
    for quantity in [InferredQuantity::Z, InferredQuantity::K, InferredQuantity::Eps] {
        let of = |grains| sigma(quantity, Some(grains));
        let sizes = [100, 500, 2000, 8000, u32::MAX].map(of);
        assert!(sizes.is_sorted_by(|few, many| few > many) && sizes[4] > 0.0, "{quantity}: {sizes:?}");
        // Over 100 to 20,000 grains, the mean of 1/N is 1/532 if ln N is uniform.
        let unknown = sigma(quantity, None);
        assert!((of(533)..of(531)).contains(&unknown), "{quantity}: {unknown}");
    }
}

#[test]
fn an_unknown_probe_widens_and_moves_nothing() {
    use InferredQuantity::{Eps, EpsStiffness, K, Z};
    let sticking = Observation::new(moduli(5.3, 0.05), conditions()).with_relative_error(0.01);
    let unknown = Observation { probe: Probe::Unknown, ..sticking.clone() };
    let [sticking, unknown] = [sticking, unknown].map(|o| Relaxed.infer(&o, ours()).unwrap());
    assert_eq!((unknown.structure, unknown.status()), (sticking.structure, sticking.status()));
    for (quantity, added) in [(Z, 0.19), (K, 0.43), (Eps, 0.040)] {
        let [stddev, wider] = [&sticking, &unknown].map(|e| e.stddev(quantity).unwrap());
        assert!((wider - stddev.hypot(added)).abs() < 1e-9, "{quantity}: {stddev} {wider}");
    }
    assert!(unknown.stddev(EpsStiffness) > sticking.stddev(EpsStiffness));
    let said = |e: &Inversion| e.notes.iter().any(|note| note.is(Code::ProbeUnknown));
    assert!(said(&unknown) && !said(&sticking));
}

#[test]
fn draws_of_an_unknown_probe_are_as_wide_as_its_estimate() {
    let observation = Observation {
        probe: Probe::Unknown,
        grains: Some(2000),
        ..Observation::new(moduli(5.3, 0.03), conditions()).with_relative_error(0.01)
    };
    let estimate = Relaxed.infer(&observation, ours()).unwrap();
    let settings = PosteriorSettings::default();
    let posterior = Posterior::new(&Relaxed, &observation, ours(), &Prior::default(), settings).unwrap();
    let draws = posterior.draws(4000).unwrap().draws;
    for quantity in [InferredQuantity::Z, InferredQuantity::K, InferredQuantity::Eps] {
        let values: Vec<f64> = draws.iter().map(|draw| draw.structure.get(quantity).unwrap()).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let stddev = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        let ratio = stddev / estimate.stddev(quantity).unwrap();
        // The laws are not linear over three of these standard deviations.
        assert!((0.85..1.15).contains(&ratio), "{quantity}: {ratio}");
    }
    // What is known of z narrows k as much in the draws as in the estimate.
    let prior = Prior::parse("[z]\ndistribution = \"normal\"\nmean = 5.3\nstddev = 0.05\n").unwrap();
    let known = estimate.with_prior(&prior).unwrap().stddev(InferredQuantity::K).unwrap();
    let posterior = Posterior::new(&Relaxed, &observation, ours(), &prior, settings).unwrap();
    let k: Vec<f64> = posterior.draws(4000).unwrap().draws.iter().filter_map(|d| d.structure.k).collect();
    let mean = k.iter().sum::<f64>() / k.len() as f64;
    let stddev = (k.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / k.len() as f64).sqrt();
    assert!((0.85..1.15).contains(&(stddev / known)), "{stddev} {known}");
}

/// Hertz contacts have no length scale, and no pressure scale but E*.
#[test]
fn stiffer_grains_at_as_much_higher_a_pressure_are_the_same_packing() {
    let (z, eps) = (5.4, -0.02);
    let stiffer = Material { shear_modulus: 7.0 * Material::GLASS.shear_modulus, ..Material::GLASS };
    let at = Conditions { pressure: Measured::exact(700e3), material: Some(stiffer), ..conditions() };
    let predicted = Relaxed.predict(&structure(z, eps), &at, ours()).unwrap();
    for (modulus, value) in moduli(z, eps).known() {
        assert!((predicted.get(modulus).unwrap() / value / 7.0 - 1.0).abs() < 1e-12, "{modulus}");
    }
}

#[test]
fn k_and_eps_by_stiffness_follow_the_data_as_their_slopes_say() {
    let exact = Observation::new(moduli(5.25, 0.06), conditions()).checked().unwrap();
    let found = Relaxed.solve(&exact, ours()).unwrap();
    let slopes = found.jacobian.unwrap();
    const STEP: f64 = 1e-6;
    for modulus in Modulus::ALL {
        let at = |by: f64| {
            let m = exact.moduli.with(modulus, exact.moduli.get(modulus).unwrap() * (1.0 + by));
            Relaxed.solve(&Observation { moduli: m, ..exact.clone() }, ours()).unwrap().structure
        };
        let (up, down) = (at(STEP), at(-STEP));
        for q in
            [InferredQuantity::K, InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::EpsStiffness]
        {
            let numerical = (up.get(q).unwrap() - down.get(q).unwrap()) / (2.0 * STEP);
            let stated = slopes[(q as usize, modulus as usize)];
            assert!((numerical - stated).abs() < 1e-4, "{q} by {modulus}: {numerical} {stated}");
        }
    }
    let at = |by: f64| {
        let mut o = exact.clone();
        o.conditions.pressure.value *= 1.0 + by;
        Relaxed.solve(&o, ours()).unwrap().structure
    };
    for q in [InferredQuantity::K, InferredQuantity::Z, InferredQuantity::Eps] {
        let numerical = (at(STEP).get(q).unwrap() - at(-STEP).get(q).unwrap()) / (2.0 * STEP);
        assert!((numerical - slopes[(q as usize, 6)]).abs() < 1e-4, "{q} by pressure");
    }
}

#[test]
fn moduli_of_no_packing_and_a_calibration_without_networks_are_refused_by_name() {
    let sound = moduli(5.2, 0.03);
    let scaled = |by: f64| Moduli::of_values(sound.values().map(|m| m.map(|m| m * by)));
    for by in [1e-3, 0.3, 3.0, 1e3] {
        let e = infer(scaled(by)).unwrap_err();
        assert!(e.is(Code::NoCoordination), "{by}: {e}");
        assert!(e.to_string().contains("grainlab"), "{e}");
    }
    let e = Relaxed.infer(&Observation::new(sound, conditions()), &Calibration::PAPER).unwrap_err();
    assert!(matches!(e, EmtError::NotCalibrated { .. }), "{e}");
}
