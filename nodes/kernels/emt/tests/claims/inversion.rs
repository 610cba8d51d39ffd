//! The inversion against the paper's table and against its own forward model.

use crate::table3;
use emt::{Calibration, Form, Gamma, Medium, Observation, Structure, infer_all, models};
use grains::Material;
use proptest::prelude::*;

/// 1e-6 is what the acceptance asks; the moduli are kept to 1 mPa, which costs 1e-9 at most.
#[test]
fn every_row_of_table_iii_comes_back_from_its_implied_moduli() {
    let rows = table3::rows();
    assert_eq!(rows.len(), 16);
    for row in rows {
        for model in models() {
            let e = model.infer(&row.observation(model.name()), &Calibration::PAPER).unwrap();
            let (s, t) = (e.structure, row.structure);
            for (found, table) in [(s.k, t.k), (s.k_hat, t.k_hat), (s.eps, t.eps)] {
                assert!((found - table).abs() < 1e-6, "{} {}: {s:?}", row.label, model.name());
            }
        }
    }
}

/// The other way round: what mixing the two readings of Eq. 16 costs (up to 0.29 in k, on S3 at 50 kPa).
#[test]
fn mixing_the_two_readings_shifts_k_by_the_known_amount() {
    let row = &table3::rows()[8];
    let printed = emt::model("ratio-as-printed").unwrap();
    let s = printed.infer(&row.observation("ratio"), &Calibration::PAPER).unwrap().structure;
    assert!((s.k - 4.64).abs() < 0.005 && (s.k_hat - 4.55).abs() < 0.005, "{s:?}");
    assert!((s.eps - row.structure.eps).abs() < 1e-6);
}

/// Table III's k_EMT is G12 over ψ3 for one contact a grain, Δ = ln(0.636/0.607): S1 agrees within the two printed
/// digits and 2 %. (S3 and S4 do not: the table is inconsistent there.)
#[test]
fn absolute_theory_gives_k_emt_of_sample_s1() {
    for (row, k_emt) in table3::rows().iter().zip([0.31, 0.41, 0.58, 0.75]) {
        let one_contact = Medium {
            material: Material::GLASS,
            solid_fraction: 0.636,
            volume_strain: (0.636f64 / 0.607).ln(),
            k: 1.0,
            eps: row.structure.eps,
            gamma_over_delta: row.g,
        };
        let k = row.observation("ratio").g12 / one_contact.psi(Form::Corrected).psi3;
        assert!((k - k_emt).abs() < 0.005 + 0.02 * k_emt, "{}: {k}", row.label);
    }
}

#[test]
fn k_hat_of_the_corrected_model_depends_on_neither_g_nor_eps() {
    let k_hat = |g| {
        let o = Observation::new(120.0e6, 127.0e6, 144.0e6, 50.0e3, Gamma::given(g));
        emt::model("ratio").unwrap().infer(&o, &Calibration::PAPER).unwrap().structure
    };
    let (a, b) = (k_hat(-0.2), k_hat(0.1));
    assert!((a.k_hat - b.k_hat).abs() < 1e-13, "{a:?} {b:?}");
    assert!((a.eps - b.eps).abs() > 0.2);
}

#[test]
fn models_are_listed_and_answer_in_a_fixed_order() {
    let names: Vec<_> = models().iter().map(|m| m.name()).collect();
    assert_eq!(names, ["ratio", "ratio-as-printed"]);
    let o = table3::rows()[0].observation("ratio");
    let answered: Vec<_> = infer_all(&o, &Calibration::PAPER).into_iter().map(|(name, _)| name).collect();
    assert_eq!(answered, names);
    assert!(emt::model("none such").is_none());
}

proptest! {
    /// Over ε in [−1/2, 1] (positive contact density), g in [−0.45, 0.24] (contacts closed in every direction) and k̂
    /// above the calibration's zero of shear, every model recovers what it predicted.
    #[test]
    fn every_model_inverts_its_own_prediction(
        k in 2.0..10.0f64, k_hat in 3.7..10.0f64, eps in -0.5..=1.0f64, g in -0.45..0.24f64,
        log_p in 2.0..8.0f64, own in any::<bool>(),
    ) {
        let own_constants = Calibration::new("own", [150.0, -3.5, 80.0, -0.2], 4.2).unwrap();
        let calibration = if own { own_constants } else { Calibration::PAPER };
        let truth = Structure { k, k_hat, eps };
        for model in models() {
            let o = model.predict(&truth, Gamma::given(g), 10f64.powf(log_p), &calibration);
            let s = model.infer(&o, &calibration).unwrap().structure;
            for (found, expected) in [(s.k, k), (s.k_hat, k_hat), (s.eps, eps)] {
                prop_assert!((found - expected).abs() < 1e-9, "{}: {truth:?} {s:?}", model.name());
            }
        }
    }

    /// Any positive numbers give an error or a finite estimate.
    #[test]
    fn no_input_gives_a_number_that_is_not_finite(
        log in prop::array::uniform4(-300.0..300.0f64), ratio in 0.0..2.2f64, g in -1.1..0.6f64,
        related in any::<bool>(), relative in 0.0..1.0f64,
    ) {
        let [g12, mut g13, mut theta, p] = log.map(|l| 10f64.powf(l));
        if related {
            (g13, theta) = (ratio * g12, 0.8 * g12);
        }
        let o = Observation::new(g12, g13, theta, p, Gamma::given(g)).with_relative_error(relative);
        for (name, result) in infer_all(&o, &Calibration::PAPER) {
            if let Ok(e) = result {
                let s = e.structure;
                prop_assert!([s.k, s.k_hat, s.eps].iter().all(|v| v.is_finite()), "{name}: {s:?}");
                prop_assert!(e.interval().unwrap().as_flattened().iter().all(|v| v.is_finite()), "{name}: {e:?}");
                // Moduli of 1e-260 Pa underflow to k = 0.
                prop_assert!(s.k >= 0.0 && s.k_hat > 0.0);
            }
        }
    }
}
