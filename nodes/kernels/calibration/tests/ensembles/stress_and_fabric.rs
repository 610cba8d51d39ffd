//! Causes of the anisotropy of moduli: the stress, or the contacts.
//!
//! Khidas & Jia, Phys. Rev. E 81, 021303 (2010): P waves are more sensitive to stress, S waves to fabric. Mayer & Liu,
//! arXiv:1010.2512: stress and density alone may explain these speeds. Here the contacts are counted. The squares of
//! speeds along and across e3 have the ratios C33/C11 for P waves and G13/G12 for S waves.

use crate::least_squares::{Fit, Point, within_packings};
use crate::{csv, ours};
use grainlab_calibration::CalibrationSample;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{Moduli, Modulus, StrainRatioSource};

/// A number of a packing.
type Number = fn(&CalibrationSample) -> f64;

/// Logarithm of C33/C11.
const P: Number = |s| ratio(&s.moduli, Modulus::C33, Modulus::C11);
/// Logarithm of G13/G12.
const S: Number = |s| ratio(&s.moduli, Modulus::G13, Modulus::G12);
const WAVES: [(&str, Number); 2] = [("P", P), ("S", S)];

const STRESS: Number = |s| s.stress_ratio;
const DENSITY: Number = |s| s.solid_fraction;
const STRESS_TIMES_DENSITY: Number = |s| s.stress_ratio * s.solid_fraction;
const EPS: Number = |s| s.eps;
const EPS_K: Number = |s| s.eps_stiffness;
const FABRICS: [(&str, Number); 2] = [("eps", EPS), ("eps_k", EPS_K)];

fn ratio(moduli: &Moduli, along: Modulus, across: Modulus) -> f64 {
    (moduli.get(along).unwrap() / moduli.get(across).unwrap()).ln()
}

fn points(samples: &[CalibrationSample], value: Number, causes: &[Number]) -> Vec<Point> {
    let point = |s: &CalibrationSample| Point {
        value: value(s),
        causes: causes.iter().map(|cause| cause(s)).collect(),
        packing: format!("{} {}", s.preparation, s.packing),
        recipe: s.preparation.clone(),
    };
    samples.iter().map(point).collect()
}

fn fit(samples: &[CalibrationSample], value: Number, causes: &[Number]) -> Fit {
    Fit::of(&points(samples, value, causes))
}

fn within(samples: &[CalibrationSample], value: Number, causes: &[Number]) -> Fit {
    Fit::of(&within_packings(&points(samples, value, causes)))
}

fn of(
    samples: &[CalibrationSample],
    mut keep: impl FnMut(&CalibrationSample) -> bool,
) -> Vec<CalibrationSample> {
    samples.iter().filter(|s| keep(s)).cloned().collect()
}

fn mean(samples: &[CalibrationSample], number: Number) -> f64 {
    samples.iter().map(number).sum::<f64>() / samples.len() as f64
}

fn extremes(samples: &[CalibrationSample], number: Number) -> [f64; 2] {
    let all = || samples.iter().map(number);
    [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
}

fn spread(samples: &[CalibrationSample], number: Number) -> f64 {
    let middle = mean(samples, number);
    (samples.iter().map(|s| (number(s) - middle).powi(2)).sum::<f64>() / samples.len() as f64).sqrt()
}

/// The packings of each comparison.
fn sets() -> [(&'static str, Vec<CalibrationSample>); 3] {
    let steps = csv::samples("steps.csv");
    let in_oedometer = |s: &CalibrationSample| s.preparation.starts_with("oedometer");
    [
        ("15 recipes (wide.csv)", csv::samples("wide.csv")),
        ("3 preparations, imposed stress (steps.csv)", of(&steps, |s| !in_oedometer(s))),
        ("3 preparations, oedometer (steps.csv)", of(&steps, in_oedometer)),
    ]
}

/// One wave regressed on one fabric and the stress ratio.
struct Row {
    fabric: Fit,
    stress: Fit,
    density: Fit,
    both: Fit,
}

impl Row {
    fn of(samples: &[CalibrationSample], wave: Number, fabric: Number) -> Self {
        Self {
            fabric: fit(samples, wave, &[fabric]),
            stress: fit(samples, wave, &[STRESS]),
            density: fit(samples, wave, &[STRESS, DENSITY, STRESS_TIMES_DENSITY]),
            both: fit(samples, wave, &[fabric, STRESS]),
        }
    }

    fn print(&self, wave: &str, fabric: &str) {
        let Row { fabric: alone, stress, density, both } = self;
        eprintln!(
            "{wave}  {fabric:6} {} {} {}   {:.2} {:.2} {:.2} {:.2}   {:.4} {:.4} {:.4}",
            with_error(coefficient(both, 0)),
            with_error(coefficient(both, 1)),
            with_error(stress_over_fabric(both)),
            alone.r2,
            stress.r2,
            density.r2,
            both.r2,
            alone.left_out,
            stress.left_out,
            both.left_out,
        );
    }
}

fn coefficient(fit: &Fit, i: usize) -> [f64; 2] {
    [fit.coefficients[i], fit.errors[i]]
}

/// ε with the effect of a q/p of 1, with its standard error.
fn stress_over_fabric(fit: &Fit) -> [f64; 2] {
    fit.compared(fit, |c, _| c[1] / c[0])
}

fn with_error([value, error]: [f64; 2]) -> String {
    format!("{value:6.3} +-{error:.3}")
}

/// `--nocapture` prints the table of which the README of this crate has the main numbers.
#[test]
fn both_waves_follow_both_the_contacts_and_the_stress_p_waves_the_stress_more() {
    eprintln!(
        "ln(C33/C11), P, and ln(G13/G12), S = constant + a fabric + b q/p; rms of a recipe left out of the fit"
    );
    for (title, samples) in sets() {
        let [[q0, q1], [e0, e1]] = [STRESS, EPS].map(|n| extremes(&samples, n));
        eprintln!("\n{title}: {} states, q/p {q0:.2} to {q1:.2}, eps {e0:.3} to {e1:.3}", samples.len());
        eprintln!(
            "          a             b             b/a             R2: fabric, q/p, q/p and density, fabric and q/p; left out: fabric, q/p, both"
        );
        let mut on_eps = Vec::new();
        for (wave, value) in WAVES {
            for (name, fabric) in FABRICS {
                let row = Row::of(&samples, value, fabric);
                row.print(wave, name);
                if name == "eps" {
                    for [found, error] in [0, 1].map(|i| coefficient(&row.both, i)) {
                        assert!(found > 4.0 * error, "{title}, {wave}: {found} +- {error}");
                    }
                    let alone = row.fabric.left_out.min(row.stress.left_out);
                    assert!(row.both.left_out < alone, "{title}, {wave}");
                    on_eps.push(row.both);
                }
            }
        }
        let more = on_eps[0].compared(&on_eps[1], |p, s| p[1] / p[0] - s[1] / s[0]);
        eprintln!("b/a on eps, P less S: {}", with_error(more));
        let [more, error] = more;
        // The 18 packings in the oedometer are too few to tell: 1.5 standard errors.
        let certain = if title.contains("oedometer") { 0.0 } else { 3.0 };
        assert!(more > certain * error, "{title}: {more} +- {error}");
    }
}

/// Changes in one packing, of which the contacts hardly change, have the coefficients of packings that differ.
#[test]
fn the_effect_of_stress_at_unchanged_contacts_is_the_same_within_a_packing() {
    let [_, (title, samples), _] = sets();
    eprintln!("\nwithin packings, {title}: a, b, R2 of both, and of q/p alone");
    for (wave, value) in WAVES {
        let across = fit(&samples, value, &[EPS, STRESS]);
        let [both, stress] = [&[EPS, STRESS][..], &[STRESS]].map(|causes| within(&samples, value, causes));
        let found = [0, 1].map(|i| coefficient(&both, i));
        eprintln!(
            "{wave}  {} {}  {:.2} {:.2}",
            with_error(found[0]),
            with_error(found[1]),
            both.r2,
            stress.r2
        );
        for (i, [found, error]) in found.into_iter().enumerate() {
            let [other, other_error] = coefficient(&across, i);
            assert!((found - other).abs() < 3.0 * error.hypot(other_error), "{wave} {i}: {found} {other}");
        }
        assert!(both.r2 > 0.9, "{wave}: {}", both.r2);
    }
}

/// Stress and density are not enough: they are equal in these packings, which differ by the sign of the anisotropy of
/// either wave. A response that follows from stress and density alone is isotropic under isotropic stress.
#[test]
fn under_isotropic_stress_at_one_density_either_wave_follows_the_contacts() {
    let [(_, wide), (_, steps), _] = sets();
    let isotropic = of(&wide, |s| s.stress_ratio.abs() < 1e-3);
    eprintln!("\nisotropic stress, {} states by 12 recipes: spread, R2 of eps, of density", isotropic.len());
    for (wave, value) in WAVES {
        let [contacts, density] = [EPS, DENSITY].map(|n| fit(&isotropic, value, &[n]).r2);
        eprintln!("{wave}  {:.3}  {contacts:.2} {density:.2}", spread(&isotropic, value));
        assert!(contacts > 0.8 && density < 0.1, "{wave}: {contacts} {density}");
    }
    let mut seen = std::collections::BTreeSet::new();
    let first = of(&steps, |s| seen.insert(format!("{} {}", s.preparation, s.packing)));
    let [along, across] = ["uniaxial", "biaxial"].map(|name| of(&first, |s| s.preparation == name));
    for (name, samples) in [("uniaxial", &along), ("biaxial", &across)] {
        let [phi, z, eps, p, s] = [DENSITY, |s: &CalibrationSample| s.z, EPS, P, S].map(|n| mean(samples, n));
        eprintln!(
            "pressed {name}, 100 kPa, {} packings: phi {phi:.4}, z {z:.3}, eps {eps:.4}, P {p:.3}, S {s:.3}",
            samples.len()
        );
    }
    assert_eq!((along.len(), across.len()), (8, 8));
    assert!((mean(&along, DENSITY) - mean(&across, DENSITY)).abs() < 5e-4);
    for (wave, value) in WAVES {
        let lowest = extremes(&along, value)[0];
        let highest = extremes(&across, value)[1];
        assert!(lowest > highest, "{wave}: {lowest} {highest}");
    }
}

/// Weighted by their stiffness, the contacts alone explain the P waves: stress acts on them by stiffening contacts.
#[test]
fn stress_acts_on_p_waves_by_the_stiffness_of_contacts() {
    for (title, samples) in sets() {
        let [alone, both] = [&[EPS_K][..], &[EPS_K, STRESS]].map(|causes| fit(&samples, P, causes));
        assert!(alone.r2 > 0.96 && both.r2 - alone.r2 < 0.01, "{title}: {} {}", alone.r2, both.r2);
    }
}

/// ε and q/p from the two anisotropies: what another recipe's packing is known to.
#[test]
fn speeds_separate_contacts_from_stress_only_if_the_stress_is_known() {
    let [(_, wide), ..] = sets();
    let rms = |value: Number, causes: &[Number]| fit(&wide, value, causes).left_out;
    let [from_speeds, with_stress] = [rms(EPS, &[P, S]), rms(EPS, &[P, S, STRESS])];
    let [stress, spread_of_stress] = [rms(STRESS, &[P, S]), spread(&wide, STRESS)];
    eprintln!(
        "\neps of a recipe left out, rms: {from_speeds:.4} from P and S, {with_stress:.4} with q/p too; spread {:.4}",
        spread(&wide, EPS)
    );
    eprintln!("q/p of a recipe left out, rms: {stress:.3} from P and S; spread {spread_of_stress:.3}");
    assert!(
        with_stress < 0.65 * from_speeds && stress > 0.7 * spread_of_stress,
        "{from_speeds} {with_stress} {stress}"
    );

    let inside = of(&csv::samples("steps.csv"), |s| (0.02..=0.3).contains(&s.stress_ratio.abs()));
    let relaxed = grainlab_emt::model("relaxed").unwrap();
    let calibration = ours();
    let rms = |known: bool, quantity: InferredQuantity, truth: Number| {
        let error = |s: &CalibrationSample| {
            let mut o = s.observation(StrainRatioSource::Zero);
            o.conditions.stress_ratio = o.conditions.stress_ratio.filter(|_| known);
            relaxed.infer(&o, calibration).unwrap().structure.get(quantity).unwrap() - truth(s)
        };
        (inside.iter().map(|s| error(s).powi(2)).sum::<f64>() / inside.len() as f64).sqrt()
    };
    let [eps, eps_k] = [(InferredQuantity::Eps, EPS), (InferredQuantity::EpsStiffness, EPS_K)]
        .map(|(quantity, truth)| [true, false].map(|known| rms(known, quantity, truth)));
    eprintln!(
        "relaxed, {} states of steps.csv under q/p of up to .3, rms error with q/p, and without:",
        inside.len()
    );
    eprintln!("eps {:.4} {:.4}, eps_k {:.4} {:.4}", eps[0], eps[1], eps_k[0], eps_k[1]);
    assert!(eps[0] < 0.01 && eps[1] > 3.0 * eps[0], "{eps:?}");
    assert!(eps_k[0] < 0.005 && eps_k[1] < 1.5 * eps_k[0], "{eps_k:?}");
}
