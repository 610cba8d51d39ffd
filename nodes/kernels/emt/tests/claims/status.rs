//! Answers that are not `ok`.

use crate::{PAPER_MODELS, table3};
use grainlab_core::Material;
use grainlab_core::notes::{Code, Note, Status};
use grainlab_emt::{
    Calibration, Conditions, EmtError, Measured, Model, Moduli, Modulus, Observation, RelaxationCalibration,
    Sensitivity, SeriesEstimate, SeriesPrior, SeriesRow, SpeedMode, SpeedSeries, infer_series,
    simulate_series,
};

/// p/E* of the packings of the calibration.
const REACH: [f64; 2] = [2.32e-8, 1.63e-4];

fn network() -> &'static RelaxationCalibration {
    Calibration::builtin("grainlab").unwrap().network().unwrap()
}

/// The moduli of an ordinary packing at this p/E*, by Hertz's law from those at 50 kPa.
fn packing(reduced: f64) -> Observation {
    let pressure = reduced * Material::GLASS.effective_young();
    let moduli = Moduli::of_values([104.2e6, 112.4e6, 136e6, 263.0e6, 282.0e6, 58.0e6].map(Some))
        .without(Modulus::C13);
    let scale = (pressure / 50e3).cbrt();
    let moduli = Moduli::of_values(moduli.values().map(|m| m.map(|m| m * scale)));
    let conditions = Conditions {
        solid_fraction: Some(Measured::exact(0.62)),
        stress_ratio: Some(Measured::exact(0.0)),
        size_spread: Some(0.0),
        ..Conditions::at(pressure)
    };
    Observation::new(moduli, conditions).with_relative_error(0.03)
}

#[test]
fn beyond_the_pressures_of_the_calibration_no_model_answers_ok() {
    let calibration = Calibration::builtin("grainlab").unwrap();
    let models = grainlab_emt::models().iter().copied().chain([grainlab_emt::free_contact()]);
    for model in models {
        let status = |reduced: f64| {
            model.infer(&packing(reduced), calibration).map_or(Status::Unknown, |found| found.status())
        };
        for reduced in [0.5 * REACH[0], 1.5 * REACH[1], 13.0 * REACH[1], 50.0 * REACH[1]] {
            assert_ne!(status(reduced), Status::Ok, "{} at {reduced:e}", model.name());
        }
    }
    let free = |reduced: f64| grainlab_emt::free_contact().infer(&packing(reduced), calibration).unwrap();
    assert_eq!(free(1e-6).status(), Status::Ok, "{:?}", free(1e-6).notes);
    assert!(
        free(13.0 * REACH[1]).notes.iter().any(|w| w.is(Code::StateOutsideCalibration) && w.names("p/E*"))
    );
}

#[test]
fn the_first_warning_is_the_reason_of_the_status() {
    let infer = |reduced: f64, slip: f64| {
        let mut o = packing(reduced);
        o.conditions.stress_ratio = None;
        let g12 = o.moduli.get(Modulus::G12).unwrap();
        o.moduli = o.moduli.with(Modulus::G12, slip * g12);
        grainlab_emt::Relaxed.infer(&o, Calibration::builtin("grainlab").unwrap()).unwrap()
    };
    for (reduced, slip, status) in
        [(1e-6, 1.4, Status::Contradictory), (1.5 * REACH[1], 1.0, Status::Extrapolated)]
    {
        let e = infer(reduced, slip);
        assert_eq!(e.status(), status, "{:?}", e.notes);
        assert!(e.notes[1..].contains(&Note::stress_ratio_unknown()), "{:?}", e.notes);
        let first = &e.notes[0];
        assert!(first.severity() == status, "{first}");
    }
}

#[test]
fn a_posterior_below_every_z_of_the_calibration_is_said() {
    let mut soft = packing(1e-6);
    soft.moduli = soft.moduli.with(Modulus::G12, 12e6).with(Modulus::G13, 12e6).with(Modulus::Theta, 110e6);
    soft.moduli = soft.moduli.without(Modulus::C11).without(Modulus::C33);
    let soft = soft.with_relative_error(0.03);
    let e = grainlab_emt::free_contact().infer(&soft, Calibration::builtin("grainlab").unwrap()).unwrap();
    let said = e.notes.iter().find(|w| w.is(Code::LowerZ));
    assert!(
        said.is_some_and(|w| w.to_string().contains("has z below 4.11")),
        "{:?} {:?}",
        e.structure,
        e.notes
    );
}

/// The bounds: 15 contacts per grain, or a hundredth of one.
#[test]
fn a_structure_that_no_packing_of_spheres_has_is_unknown() {
    let infer = |name: &str, [g12, g13, theta]: [f64; 3], pressure: f64| {
        let conditions =
            Conditions { solid_fraction: Some(Measured::exact(0.62)), ..Conditions::at(pressure) };
        let o = Observation::new(Moduli::paper(g12, g13, theta), conditions);
        grainlab_emt::model(name).unwrap().infer(&o, &Calibration::PAPER)
    };
    let (usual, in_gpa) = ([100e6, 100e6, 136e6], [0.1042, 0.1124, 0.136]);
    for name in PAPER_MODELS.into_iter().chain(["hertz-mindlin"]) {
        for (moduli, pressure) in [(usual, 1e-30), (usual, 0.05), (in_gpa, 50e3), (in_gpa, 0.05)] {
            let refused = infer(name, moduli, pressure);
            assert!(refused.is_err(), "{name} at {pressure:e}: {refused:?}");
            assert!(!refused.unwrap_err().is_input_error());
        }
    }
    for pressure in [1e-30, 0.05, 50.0] {
        assert_eq!(
            infer("directional", usual, pressure).map_or(Status::Unknown, |found| found.status()),
            Status::Unknown,
            "{pressure:e}"
        );
    }
    let EmtError::NoAnswer(why) = infer("ratio", usual, 50.0).unwrap_err() else { panic!() };
    assert!(why.is(Code::NoPacking) && why.names("k") && (why.values()[0] - 54.48).abs() < 0.01, "{why}");
    // Effective media give sound packings less than one contact per grain.
    for row in &table3::rows() {
        let mut o = row.observation();
        o.conditions.solid_fraction = Some(Measured::exact(0.636));
        for model in grainlab_emt::models() {
            assert!(model.infer(&o, model.default_calibration()).is_ok(), "{} {}", model.name(), row.label);
        }
    }
}

fn row(pressure: f64, mode: SpeedMode, angle: Option<f64>, [speed, stddev]: [f64; 2]) -> SeriesRow {
    SeriesRow {
        pressure,
        density: 1600.0,
        mode,
        angle,
        speed: Some(speed),
        stddev: stddev / speed,
        common_stddev: 0.0,
    }
}

const QUARTZ: Material = Material { shear_modulus: 44e9, poisson_ratio: 0.08, density: 2650.0 };

fn inferred(series: &SpeedSeries) -> (SeriesEstimate, Sensitivity) {
    let prior = SeriesPrior::builtin();
    let estimate = infer_series(series, network(), prior).unwrap();
    let sensitivity = Sensitivity::of(&estimate, series, network(), prior).unwrap();
    (estimate, sensitivity)
}

/// P and S of a sand; `scale` is the error of a unit.
fn sand(scale: f64, modes: &[SpeedMode]) -> SpeedSeries {
    let all = [
        row(1e5 * scale, SpeedMode::P, None, [425.0, 4.3]),
        row(1e5 * scale, SpeedMode::Sv, None, [255.0, 3.0]),
        row(4e5 * scale, SpeedMode::P, None, [600.0, 6.0]),
        row(4e5 * scale, SpeedMode::Sv, None, [358.0, 3.6]),
    ];
    SpeedSeries::of(all.into_iter().filter(|row| modes.contains(&row.mode)).collect(), QUARTZ)
}

#[test]
fn pressures_in_pa_that_were_taken_as_kpa_are_not_ok_with_one_mode_alone() {
    let (right, sensitivity) = inferred(&sand(1.0, &[SpeedMode::P, SpeedMode::Sv]));
    assert_eq!(right.status(&sensitivity), Status::Ok);
    assert!(right.pressures.iter().all(|p| p.outside.is_none() && p.z_below < 0.1));
    let (slip, sensitivity) = inferred(&sand(1e3, &[SpeedMode::Sv]));
    assert_ne!(slip.status(&sensitivity), Status::Ok);
    for at in &slip.pressures {
        assert!(
            at.outside
                .as_ref()
                .is_some_and(|note| note.is(Code::StateOutsideCalibration) && note.names("p/E*")),
            "{at:?}"
        );
        assert!(at.z_below > 0.1, "{at:?}");
    }
}

#[test]
fn in_a_series_each_pressure_beyond_the_calibration_is_marked_and_no_other() {
    let young = QUARTZ.effective_young();
    let at = |share: f64| (share * young, 350.0 * (share / 1e-5).powf(0.2));
    let shares = [1.2e-8, 1e-6, 1e-5, 1e-3];
    let rows =
        shares.map(at).map(|(pressure, speed)| row(pressure, SpeedMode::Sv, None, [speed, 0.03 * speed]));
    let estimate =
        infer_series(&SpeedSeries::of(rows.to_vec(), QUARTZ), network(), SeriesPrior::builtin()).unwrap();
    let marked: Vec<bool> = estimate.pressures.iter().map(|p| p.outside.is_some()).collect();
    assert_eq!(marked, [true, false, false, true]);
    let wide = SpeedSeries { size_variance: [0.16, 0.0], ..sand(1.0, &[SpeedMode::P]) };
    let estimate = infer_series(&wide, network(), SeriesPrior::builtin()).unwrap();
    assert!(
        estimate.pressures.iter().all(|p| p.outside.is_some()),
        "sizes that no packing of the calibration has"
    );
}

/// Speeds of a sand from 30 kPa to 5.5 MPa; the first is `factor` times the measured one.
fn long_series(factor: f64) -> SpeedSeries {
    let p = [
        (3e4, 324.35),
        (1.2e5, 434.78),
        (2.6e5, 520.56),
        (4.5e5, 589.42),
        (9e5, 674.07),
        (1.35e6, 729.21),
        (2.2e6, 818.14),
    ];
    let later = [(3.4e6, 900.99), (4.5e6, 960.33)];
    let s = [
        (7e4, 237.27),
        (2.5e5, 311.62),
        (4e5, 344.96),
        (8e5, 395.22),
        (1.3e6, 439.51),
        (1.8e6, 473.83),
        (3.3e6, 543.05),
    ];
    let last = [(4.4e6, 588.13), (5.5e6, 593.93)];
    let of = |mode: SpeedMode| {
        move |(pressure, speed): (f64, f64)| row(pressure, mode, None, [speed, 0.02 * speed])
    };
    let all = p
        .into_iter()
        .chain(later)
        .map(of(SpeedMode::P))
        .chain(s.into_iter().chain(last).map(of(SpeedMode::Sv)));
    let mut rows: Vec<SeriesRow> = all.collect();
    rows[0].speed = rows[0].speed.map(|speed| factor * speed);
    let glass = Material { poisson_ratio: 0.22, ..Material::GLASS };
    SpeedSeries { density_stddev: 0.03, size_variance: [0.03, 0.03], ..SpeedSeries::of(rows, glass) }
}

#[test]
fn a_row_that_the_others_contradict_and_that_decides_z_is_a_contradiction() {
    let sound = infer_series(&long_series(1.0), network(), SeriesPrior::builtin()).unwrap();
    // The row with the smaller error has p = .008, and another row has a smaller p.
    for factor in [1.09, 1.1] {
        let (estimate, sensitivity) = inferred(&long_series(factor));
        assert!(!estimate.is_contradictory(), "the series as a whole is not improbable");
        assert_eq!(estimate.status(&sensitivity), Status::Contradictory, "{factor}");
        let decisive = sensitivity.doubted.iter().find(|d| d.is_decisive()).unwrap();
        assert_eq!(decisive.rows, [0]);
        let (z, without) = (estimate.pressures[decisive.place].z, decisive.z[decisive.place]);
        assert!(
            (without[0] - sound.pressures[decisive.place].z.mean).abs()
                < sound.pressures[decisive.place].z.stddev
        );
        assert!((without[0] - z.mean).abs() > 2.0 * z.stddev);
    }
}

/// One row of twenty is outside the central 95 % of its prediction by chance.
#[test]
fn a_sound_series_has_no_decisive_row_however_many_are_outside_their_prediction() {
    let mut series = long_series(1.0);
    let mut outside = 0;
    for seed in 0..4 {
        simulate_series(&mut series, network(), SeriesPrior::builtin(), None, seed).unwrap();
        let (estimate, sensitivity) = inferred(&series);
        outside += estimate.rows.iter().filter(|row| row.p.is_some_and(|p| p < 0.05)).count();
        assert!(!sensitivity.doubted.iter().any(|d| d.is_decisive()), "seed {seed}");
    }
    assert!(outside > 4, "{outside}");
}

#[test]
fn waves_of_one_modulus_that_differ_beyond_their_errors_are_a_contradiction() {
    let across = Some(std::f64::consts::FRAC_PI_2);
    let series = |sv_across: f64, common: f64| {
        let rows = [
            row(2e5, SpeedMode::P, Some(0.0), [420.0, 4.0]),
            row(2e5, SpeedMode::P, across, [415.0, 4.0]),
            row(2e5, SpeedMode::Sv, Some(0.0), [240.0, 2.4]),
            row(2e5, SpeedMode::Sv, across, [sv_across, 2.5]),
            row(2e5, SpeedMode::Sh, across, [256.0, 2.5]),
        ];
        SpeedSeries::of(rows.map(|row| SeriesRow { common_stddev: common, ..row }).to_vec(), Material::GLASS)
    };
    let of = |series: &SpeedSeries| infer_series(series, network(), SeriesPrior::builtin()).unwrap();
    let apart = of(&series(252.0, 0.0));
    assert!((apart.p_twins.unwrap() - 5.4e-4).abs() < 1e-4, "{:?}", apart.p_twins);
    assert!(apart.is_contradictory());
    for near in [series(244.0, 0.0), series(252.0, 0.02)] {
        let near = of(&near);
        assert!(near.p_twins.unwrap() > 0.01 && !near.is_contradictory(), "{:?}", near.p_twins);
    }
    let mut alone = series(252.0, 0.0);
    alone.rows.retain(|row| row.mode != SpeedMode::Sv);
    assert_eq!(of(&alone).p_twins, None);
}
