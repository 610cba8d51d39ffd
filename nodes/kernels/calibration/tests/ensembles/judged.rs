//! Every model on packings of recipes that teach nothing (`judged.csv`): what is called `ok` holds, and consistent data raise
//! no alarm. `--nocapture` prints what was found.

use crate::left_out::truth;
use crate::{csv, ours};
use grainlab_calibration::CalibrationSample;
use grainlab_core::notes::{Code, Status};
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{
    Calibration, Inversion, MODULI, Measured, Model, ModuliCovariance, Modulus, Observation, Relaxed,
    StrainRatioSource, UNKNOWN_STRESS_RATIO, models,
};
use grainlab_testkit::Random;

/// The recipe without friction to the end, whose contacts have no tangential springs.
const SMOOTH: &str = "smooth";

const QUANTITIES: [InferredQuantity; 4] =
    [InferredQuantity::K, InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::EpsStiffness];

fn judged() -> Vec<CalibrationSample> {
    csv::samples("judged.csv").into_iter().filter(|s| s.preparation != SMOOTH).collect()
}

/// Error of each quantity in stated standard deviations.
fn pulls(e: &Inversion, s: &CalibrationSample) -> Vec<(InferredQuantity, f64)> {
    let pull = |q: InferredQuantity| Some((q, (e.structure.get(q)? - truth(s, q)) / e.stddev(q)?));
    QUANTITIES.into_iter().filter_map(pull).collect()
}

/// True if the sample is in the domain of `relaxed` that README states.
pub(crate) fn inside(s: &CalibrationSample) -> bool {
    let within = |v: f64, [low, high]: [f64; 2]| (low..=high).contains(&v);
    within(s.z, [4.2, 6.4])
        && within(s.eps, [-0.08, 0.13])
        && within(s.pressure / s.material.effective_young(), [2e-8, 1.6e-4])
        && within(s.material.poisson_ratio, [0.0, 0.45])
        && within(s.size_spread, [0.0, 0.3])
        && within(s.stress_ratio, [-0.2005, 0.3005])
}

#[test]
fn the_packings_are_many_and_of_many_recipes_that_taught_nothing() {
    let all = csv::samples("judged.csv");
    let recipes = |all: &[CalibrationSample]| -> std::collections::BTreeSet<String> {
        all.iter().map(|s| s.preparation.clone()).collect()
    };
    assert!(all.len() >= 500 && recipes(&all).len() >= 25);
    for taught in ["isotropic.csv", "anisotropic.csv", "wide.csv"] {
        assert!(recipes(&all).is_disjoint(&recipes(&csv::samples(taught))), "{taught}");
    }
}

/// Answers of the models of the paper are called extrapolated for grains of another Poisson ratio alone: they are judged, too.
fn is_answer(e: &Inversion) -> bool {
    let only_grains = || {
        let ranges = e.notes.iter().filter(|w| w.severity() > Status::Ok);
        ranges.clone().count() > 0 && ranges.clone().all(|w| w.is(Code::OtherGrains))
    };
    e.status() == Status::Ok || (e.status() == Status::Extrapolated && only_grains())
}

#[test]
fn at_most_one_in_fifty_answers_of_any_model_is_more_than_three_stated_sigmas_off_in_a_quantity() {
    const SOURCES: [StrainRatioSource; 4] = [
        StrainRatioSource::Zero,
        StrainRatioSource::Total,
        StrainRatioSource::Elastic,
        StrainRatioSource::Contact,
    ];
    let packings = judged();
    let mut faults = Vec::new();
    for name in Calibration::BUILTIN {
        let calibration = Calibration::builtin(name).unwrap();
        for model in models() {
            for source in if model.uses_gamma() { &SOURCES[..] } else { &SOURCES[..1] } {
                let (mut ok, mut off, mut worst, mut without) = (0, [0; 4], 0.0f64, 0);
                for s in &packings {
                    let Ok(e) = model.infer(&s.observation(*source), calibration) else { continue };
                    if !is_answer(&e) {
                        continue;
                    }
                    let pulls = pulls(&e, s);
                    let determined = QUANTITIES.iter().filter(|q| e.structure.get(**q).is_some()).count();
                    without += usize::from(pulls.len() < determined);
                    let furthest = pulls.iter().map(|(_, p)| p.abs()).fold(0.0, f64::max);
                    (ok, worst) = (ok + 1, worst.max(furthest));
                    for (q, pull) in pulls {
                        let at = QUANTITIES.iter().position(|known| *known == q).unwrap();
                        off[at] += usize::from(pull.abs() > 3.0);
                    }
                }
                eprintln!(
                    "{name} {} {}: k, z, eps, eps_stiffness of {off:?} of {ok} beyond 3 sigma, furthest {worst:.1}",
                    model.name(),
                    source.name()
                );
                if off.iter().any(|off| off * 50 > ok) || without > 0 {
                    faults.push((name, model.name(), source.name(), off, ok, without));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{faults:?}");
}

/// Medians of the standard deviations of k, z, ε and ε weighted by stiffness before unknown inputs were part of them.
const MEDIANS: [f64; 4] = [0.09957, 0.05788, 0.01465, 0.00771];

#[test]
fn relaxed_answers_inside_its_domain_as_accurately_as_before() {
    let inside: Vec<_> = judged().into_iter().filter(inside).collect();
    let infer = |s: &CalibrationSample| {
        Some((Relaxed.infer(&s.observation(StrainRatioSource::Zero), ours()).ok()?, s.clone()))
    };
    let is_ok = |(e, _): &(Inversion, CalibrationSample)| e.status() == Status::Ok;
    let estimates: Vec<_> = inside.iter().filter_map(infer).filter(is_ok).collect();
    let median = |q: InferredQuantity| {
        let mut all: Vec<f64> = estimates.iter().map(|(e, _)| e.stddev(q).unwrap()).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let pulls: Vec<_> = estimates.iter().map(|(e, s)| pulls(e, s)).collect();
    for (i, q) in QUANTITIES.into_iter().enumerate() {
        let of = |f: &dyn Fn(f64) -> f64| pulls.iter().map(|p| f(p[i].1)).sum::<f64>() / pulls.len() as f64;
        let held = of(&|pull| f64::from(u8::from(pull.abs() < 1.96)));
        eprintln!(
            "{q}: error over sigma, rms {:.3}, mean {:.3}; inside 95 %: {held:.3}",
            of(&|p| p * p).sqrt(),
            of(&|p| p)
        );
    }
    let found = QUANTITIES.map(median);
    eprintln!(
        "ok on {} of {}, median sigma of k, z, eps, eps_stiffness {found:?}",
        estimates.len(),
        inside.len()
    );
    assert!(estimates.len() * 10 >= inside.len() * 9);
    for (found, before) in found.into_iter().zip(MEDIANS) {
        assert!(found <= 1.15 * before, "{found} {before}");
    }
}

/// q/p, pressure and shear modulus of the grains stated with errors drawn from the stated distributions.
#[test]
fn intervals_hold_the_truth_where_the_state_is_uncertain() {
    const REPEATED: usize = 4;
    let mut random = Random::new(5);
    let (mut inside_95, mut count) = ([0usize; 4], [0usize; 4]);
    for s in judged().iter().filter(|s| inside(s)).flat_map(|s| [s; REPEATED]) {
        let mut o = s.observation(StrainRatioSource::Zero);
        let q = loop {
            let q = 0.15 * random.normal();
            if q.abs() <= 0.3 {
                break q;
            }
        };
        let c = &mut o.conditions;
        c.stress_ratio = Some(Measured { value: s.stress_ratio + q, stddev: UNKNOWN_STRESS_RATIO.stddev });
        c.pressure =
            Measured { value: s.pressure * (1.0 + 0.05 * random.normal()), stddev: 0.05 * s.pressure };
        let mut grains = s.material;
        grains.shear_modulus *= 1.0 + 0.05 * random.normal();
        c.material = Some(grains);
        c.shear_modulus_stddev = 0.05 * s.material.shear_modulus;
        let e = Relaxed.infer(&o, ours());
        assert!(!e.as_ref().is_err_and(|e| e.is(Code::NoCoordination)), "{o:?}");
        let Ok(e) = e else { continue };
        for (i, q) in QUANTITIES.into_iter().enumerate() {
            let Some([low, high]) = e.interval(q) else { continue };
            count[i] += 1;
            inside_95[i] += usize::from((low..=high).contains(&truth(s, q)));
        }
    }
    let share: [f64; 4] = std::array::from_fn(|i| inside_95[i] as f64 / count[i] as f64);
    eprintln!("inside 95 % of k, z, eps, eps_stiffness: {share:?} of {count:?}");
    // The recipes that taught differ more in k than these. Most of the error of ε is due to q/p, whose distribution has no tails.
    let most = [1.0, 0.98, 0.99, 0.98];
    assert!(share.iter().zip(most).all(|(share, most)| (0.92..=most).contains(share)), "{share:?}");
}

/// The moduli with independent errors of this relative size, stated; one of them off by so many of its errors.
fn with_errors(
    s: &CalibrationSample,
    relative: f64,
    noise: &[f64; MODULI],
    fault: (Modulus, f64),
) -> Observation {
    let mut o = s.observation(StrainRatioSource::Zero);
    let mut covariance = ModuliCovariance::zeros();
    for (m, value) in s.moduli.known() {
        let sigma = relative * value.abs();
        covariance[(m as usize, m as usize)] = sigma * sigma;
        let by = noise[m as usize] + if fault.0 == m { fault.1 } else { 0.0 };
        o.moduli = o.moduli.with(m, value + by * sigma);
    }
    o.with_covariance(covariance)
}

fn estimate(
    s: &CalibrationSample,
    relative: f64,
    noise: &[f64; MODULI],
    fault: (Modulus, f64),
) -> Option<Inversion> {
    Relaxed.infer(&with_errors(s, relative, noise, fault), ours()).ok()
}

const NO_FAULT: (Modulus, f64) = (Modulus::G12, 0.0);

#[test]
fn at_most_one_in_a_hundred_consistent_packings_raises_an_alarm() {
    let mut random = Random::new(6);
    for relative in [0.0, 0.003, 0.01, 0.03] {
        let (mut flagged, mut all) = (0, 0);
        for s in judged().iter().filter(|s| inside(s)).flat_map(|s| [s; 4]) {
            let noise = std::array::from_fn(|_| random.normal());
            let Some(e) = estimate(s, relative, &noise, NO_FAULT) else { continue };
            (flagged, all) = (flagged + usize::from(e.status() == Status::Contradictory), all + 1);
        }
        eprintln!("errors of {relative}: {flagged} of {all} flagged");
        assert!(flagged * 100 <= all, "{relative}: {flagged} of {all}");
    }
}

/// Calls `each` for every modulus and error of the data: the estimates of one packing with the modulus off by five of its errors to
/// either side, the estimate for any number of errors, and the distance of five errors in standard deviations, half the sum of χ²
/// with the fault less that without.
fn with_faults(
    seed: u64,
    relative: f64,
    modulus: Modulus,
    mut each: impl FnMut(f64, &Inversion, &dyn Fn(f64) -> Option<Inversion>),
) {
    let mut random = Random::new(seed);
    for s in judged().iter().filter(|s| inside(s)) {
        let noise = std::array::from_fn(|_| random.normal());
        let of = |by: f64| estimate(s, relative, &noise, (modulus, by));
        let (Some(without), Some(above), Some(below)) = (of(0.0), of(5.0), of(-5.0)) else { continue };
        let chi_square = |e: &Inversion| e.misfit.unwrap().chi_square;
        let square = 0.5 * (chi_square(&above) + chi_square(&below)) - chi_square(&without);
        each(square.max(1e-12).sqrt(), &above, &of);
    }
}

/// The standard deviation is that of the modulus less its prediction by the others: the errors of the data and the scatter of
/// packings.
#[test]
fn nine_in_ten_moduli_off_by_five_standard_deviations_from_their_prediction_are_flagged() {
    let mut of_all = [0, 0];
    for relative in [0.003, 0.01, 0.03] {
        for modulus in Modulus::ALL {
            let (mut flagged, mut all) = (0, 0);
            with_faults(8, relative, modulus, |distance, _, of| {
                let Some(e) = of(25.0 / distance) else { return };
                (flagged, all) = (flagged + usize::from(e.status() == Status::Contradictory), all + 1);
            });
            eprintln!("{modulus} five from its prediction, errors of {relative}: {flagged} of {all} flagged");
            assert!(flagged * 100 >= 85 * all, "{modulus} {relative}: {flagged} of {all}");
            of_all = [of_all[0] + flagged, of_all[1] + all];
        }
    }
    assert!(of_all[0] * 10 >= of_all[1] * 9, "{of_all:?}");
}

/// No test finds a fault of five stated errors that the scatter of packings hides. The best test, of a known modulus and sign and
/// at a false alarm in a hundred, finds nine in ten only in Θ, and in C11 at large errors.
#[test]
fn most_faults_of_five_stated_errors_are_flagged_where_the_scatter_of_packings_does_not_hide_them() {
    let mut visible = 0;
    for relative in [0.003, 0.01, 0.03] {
        for modulus in Modulus::ALL {
            let (mut flagged, mut all, mut best) = (0.0, 0.0, 0.0);
            with_faults(7, relative, modulus, |distance, above, _| {
                all += 1.0;
                flagged += f64::from(u8::from(above.status() == Status::Contradictory));
                best += 0.5 * libm::erfc((2.326 - distance) / std::f64::consts::SQRT_2);
            });
            eprintln!(
                "{modulus} off by five errors of {relative}: {:.2} flagged, {:.2} by the best test",
                flagged / all,
                best / all
            );
            if best >= 0.9 * all {
                visible += 1;
                assert!(flagged >= 0.65 * all, "{modulus} {relative}");
            }
        }
    }
    assert!(visible >= 3);
}
