//! The stored ensembles of packings: those from which the built-in calibration was learned, and held-out
//! ones.

mod contacts;
mod csv;
mod judged;
mod least_squares;
mod left_out;
mod locked;
mod predictive;
mod ranks;
mod rock_physics;
mod scatter;
mod series;
mod stress_and_fabric;
mod table;

use grainlab_calibration::{CalibrationSample, discrepancies, learn};
use grainlab_core::notes::Status;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{Calibration, Moduli, Modulus, Observation, StrainRatioSource};
use left_out::truth;

/// Packings not used in any calibration: 24 seeds, 4 frictions, 4 pressures.
fn held_out() -> Vec<CalibrationSample> {
    csv::samples("held_out.csv")
}

fn ours() -> &'static Calibration {
    Calibration::builtin("grainlab").unwrap()
}

/// The constants are learned, not written by hand. Logarithms differ by rounding between libraries: 1e-6 of
/// each number, an absolute 1e-12 for those that are zero up to rounding.
#[test]
fn the_built_in_calibration_is_learned_from_the_stored_ensembles() {
    let learned =
        learn("grainlab", &csv::samples("isotropic.csv"), &csv::samples("anisotropic.csv"), &csv::others())
            .unwrap();
    written(&learned, "grainlab.toml");
    assert_alike(&learned, ours());
}

/// The numbers of two calibrations agree.
fn assert_alike(learned: &Calibration, kept: &Calibration) {
    let numbers = |c: &Calibration| -> Vec<String> {
        let text = c.to_toml().unwrap();
        text.split(|c: char| " =[],\n".contains(c)).filter(|w| !w.is_empty()).map(String::from).collect()
    };
    let (learned, kept) = (numbers(learned), numbers(kept));
    assert_eq!(learned.len(), kept.len());
    for (l, k) in learned.iter().zip(&kept) {
        match (l.parse::<f64>(), k.parse::<f64>()) {
            (Ok(l), Ok(k)) => assert!(l == k || (l - k).abs() <= 1e-6 * k.abs() + 1e-12, "{l} {k}"),
            _ => assert_eq!(l, k),
        }
    }
}

#[test]
fn the_stored_errors_with_the_constants_of_the_paper_are_learned_from_the_same_packings() {
    let all = [csv::samples("isotropic.csv"), csv::samples("anisotropic.csv"), csv::others()].concat();
    let kept = include_str!("../../../emt/src/calibration/paper.toml");
    let mut learned = Calibration::PAPER;
    learned.discrepancies = discrepancies(&all.iter().collect::<Vec<_>>(), &learned);
    written(&learned, "paper.toml");
    assert_alike(&learned, &Calibration::parse(kept).unwrap());
}

/// Writes a built-in calibration anew with `GRAINLAB_WRITE=1`.
fn written(learned: &Calibration, file: &str) {
    if std::env::var_os("GRAINLAB_WRITE").is_some() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../emt/src/calibration/");
        std::fs::write(format!("{path}{file}"), learned.to_toml().unwrap()).unwrap();
    }
}

#[test]
fn the_built_in_file_is_what_is_written() {
    assert_eq!(ours().to_toml().unwrap(), include_str!("../../../emt/src/calibration/grainlab.toml"));
}

/// Errors of one quantity over samples.
struct Errors {
    rms: f64,
    covered: f64,
}

fn errors(
    model: &str,
    gamma: StrainRatioSource,
    quantity: InferredQuantity,
    keep: fn(Moduli) -> Moduli,
) -> Errors {
    errors_over(&held_out(), model, gamma, quantity, keep)
}

fn errors_over(
    samples: &[CalibrationSample],
    model: &str,
    gamma: StrainRatioSource,
    quantity: InferredQuantity,
    keep: fn(Moduli) -> Moduli,
) -> Errors {
    let model = grainlab_emt::model(model).unwrap();
    let (mut squares, mut covered) = (0.0, 0.0);
    for s in samples {
        let whole = s.observation(gamma);
        let observation = Observation { moduli: keep(whole.moduli), ..whole };
        let found = model.infer(&observation, ours()).unwrap();
        let truth = truth(s, quantity);
        squares += (found.structure.get(quantity).unwrap() - truth).powi(2);
        let [low, high] = found.interval(quantity).unwrap();
        covered += f64::from(u8::from((low..=high).contains(&truth)));
    }
    let n = samples.len() as f64;
    Errors { rms: (squares / n).sqrt(), covered: covered / n }
}

#[test]
fn unseen_packings_give_back_z_and_eps_without_any_gamma() {
    let all = |m| m;
    let of = |q| errors("relaxed", StrainRatioSource::Zero, q, all);
    let (z, eps) = (of(InferredQuantity::Z), of(InferredQuantity::Eps));
    assert!(z.rms < 0.05 && eps.rms < 0.010, "z {} eps {}", z.rms, eps.rms);
    let ratio = [
        StrainRatioSource::Zero,
        StrainRatioSource::Total,
        StrainRatioSource::Elastic,
        StrainRatioSource::Contact,
    ]
    .map(|g| errors("ratio", g, InferredQuantity::Eps, all).rms);
    let best = ratio.into_iter().fold(f64::INFINITY, f64::min);
    assert!(eps.rms < 0.5 * best, "{} against {ratio:?}", eps.rms);
    assert!(of(InferredQuantity::EpsStiffness).rms < eps.rms, "moduli see stiffness before they see number");
}

#[test]
fn stated_intervals_hold_the_truth_of_at_least_95_percent_of_unseen_packings() {
    for quantity in
        [InferredQuantity::K, InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::EpsStiffness]
    {
        let covered = errors("relaxed", StrainRatioSource::Zero, quantity, |m| m).covered;
        assert!(covered >= 0.95, "{quantity}: {covered}");
    }
}

/// 30 packings of 8,000 grains by the recipes of the calibration, three pressures each.
#[test]
fn intervals_of_larger_samples_are_narrower_and_hold_the_truth() {
    let large = csv::samples("large.csv");
    assert!(large.len() == 90 && large.iter().all(|s| s.grains == 8000));
    for quantity in [InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::EpsStiffness] {
        let covered = errors_over(&large, "relaxed", StrainRatioSource::Zero, quantity, |m| m).covered;
        assert!(covered >= 0.93, "{quantity}: {covered}");
    }
}

#[test]
fn three_moduli_or_the_p_moduli_alone_are_worth_what_is_stated() {
    let three = errors("relaxed", StrainRatioSource::Zero, InferredQuantity::Eps, |m| {
        m.without(Modulus::C11).without(Modulus::C33).without(Modulus::C13)
    });
    let p_alone = errors("relaxed", StrainRatioSource::Zero, InferredQuantity::Eps, |m| {
        Moduli::NONE
            .with(Modulus::C11, m.get(Modulus::C11).unwrap())
            .with(Modulus::C33, m.get(Modulus::C33).unwrap())
    });
    assert!(p_alone.rms < 0.010 && three.rms < 0.02 && p_alone.rms < three.rms);
    for e in [three, p_alone] {
        assert!(e.covered >= 0.90, "{}", e.covered);
    }
}

/// The order of recommendation is learned from packings that teach, with γ/Δ of the contacts where a model takes one.
#[test]
fn of_two_models_the_one_with_the_smaller_error_of_eps_on_the_packings_that_teach_is_recommended() {
    let samples = csv::samples("anisotropic.csv");
    let names = ["relaxed", "directional", "ratio", "ratio-as-printed", "emt"];
    let rms = names.map(|name| {
        errors_over(&samples, name, StrainRatioSource::Contact, InferredQuantity::Eps, |m| m).rms
    });
    eprintln!("{names:?} {rms:.4?}");
    for (i, a) in names.iter().enumerate() {
        for (j, b) in names.iter().enumerate().filter(|(j, _)| rms[i] < rms[*j] - 1e-6) {
            assert_eq!(grainlab_emt::recommended([(*b, Status::Ok), (*a, Status::Ok)]), Some(*a), "{i} {j}");
        }
    }
}

/// The 16 states of the paper, which are four loadings of one packing each: three moduli and no γ/Δ.
#[test]
fn directional_coordination_halves_the_paper_s_own_error_on_its_own_rows() {
    let rows = csv::paper_rows();
    assert_eq!(rows.len(), 16);
    let mean_error = |model: &str| {
        let model = grainlab_emt::model(model).unwrap();
        let off = rows.iter().map(|(o, eps)| {
            (model.infer(o, &Calibration::PAPER).unwrap().structure.eps.unwrap() - eps).abs()
        });
        off.sum::<f64>() / 16.0
    };
    let (directional, ratio) = (mean_error("directional"), mean_error("ratio"));
    assert!(directional <= 0.015 && (ratio - 0.036).abs() < 5e-4, "{directional} {ratio}");
}
