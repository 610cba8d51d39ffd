//! The model of rock physics: contacts in all directions alike.

use crate::model;
use grainlab_core::Material;
use grainlab_core::notes::{Code, Note, Status};
use grainlab_core::results::{InferredQuantity, Microstructure};
use grainlab_emt::{Calibration, Conditions, EmtError, Measured, Moduli, Modulus, Observation};
use std::f64::consts::PI;

const NAME: &str = "hertz-mindlin";
const K: f64 = 5.2;

fn state(stress_ratio: Option<f64>) -> Conditions {
    Conditions {
        solid_fraction: Some(Measured::exact(0.63)),
        stress_ratio: stress_ratio.map(Measured::exact),
        ..Conditions::at(100.0e3)
    }
}

fn predicted(conditions: &Conditions) -> Moduli {
    let structure = Microstructure::default().with(InferredQuantity::K, K);
    model(NAME).predict(&structure, conditions, &Calibration::PAPER).unwrap()
}

fn get(moduli: &Moduli, modulus: Modulus) -> f64 {
    moduli.get(modulus).unwrap()
}

/// K = [k²φ²G²p/(18π²(1−ν)²)]^⅓ and G/K = (3/5)(5−4ν)/(2−ν).
#[test]
fn the_moduli_are_those_of_hertz_mindlin_and_walton() {
    for nu in [0.0, 0.2, 0.35, 0.5] {
        let grains = Material { poisson_ratio: nu, ..Material::GLASS };
        let conditions = Conditions { material: Some(grains), ..state(None) };
        let (phi, p) = (0.63, conditions.pressure.value);
        let bulk = (K * K * phi * phi * grains.shear_modulus.powi(2) * p
            / (18.0 * PI * PI * (1.0 - nu) * (1.0 - nu)))
            .cbrt();
        let shear = 0.6 * (5.0 - 4.0 * nu) / (2.0 - nu) * bulk;
        let found = predicted(&conditions);
        for (modulus, expected) in [
            (Modulus::Theta, bulk),
            (Modulus::G12, shear),
            (Modulus::G13, shear),
            (Modulus::C11, bulk + 4.0 / 3.0 * shear),
            (Modulus::C33, bulk + 4.0 / 3.0 * shear),
            (Modulus::C13, bulk - 2.0 / 3.0 * shear),
        ] {
            assert!((get(&found, modulus) - expected).abs() < 1e-13 * bulk, "nu {nu}: {modulus}");
        }
        let e = model(NAME).infer(&Observation::new(found, conditions), &Calibration::PAPER).unwrap();
        assert!((e.structure.k.unwrap() / K - 1.0).abs() < 1e-13, "nu {nu}: {:?}", e.structure);
    }
}

#[test]
fn contact_anisotropy_is_unknown_and_the_estimate_says_so() {
    let observed = Observation::new(predicted(&state(Some(0.2))), state(Some(0.2)));
    let e = model(NAME).infer(&observed, &Calibration::PAPER).unwrap();
    assert_eq!(e.structure.eps, None);
    assert!(e.notes.contains(&Note::isotropic_contacts()) && e.status() == Status::Ok, "{e:?}");
    let text = Note::isotropic_contacts().to_string();
    assert!(text.contains("eps is unknown, not zero"), "{text}");
}

/// G of a share f of contacts that stick lies on the line from Walton's smooth to his rough spheres.
#[test]
fn the_shear_modulus_gives_the_share_of_contacts_that_stick() {
    let rough = predicted(&state(None));
    let theta = get(&rough, Modulus::Theta);
    for (f, status) in
        [(0.0, Status::Ok), (0.4, Status::Ok), (1.3, Status::Extrapolated), (-0.2, Status::Extrapolated)]
    {
        let shear = 0.6 * theta * (1.0 - f) + f * get(&rough, Modulus::G12);
        let p = theta + 4.0 / 3.0 * shear;
        let all = Moduli::paper(shear, shear, theta)
            .with(Modulus::C11, p)
            .with(Modulus::C33, p)
            .with(Modulus::C13, p - 2.0 * shear);
        let one_wave_each = Moduli::NONE.with(Modulus::C33, p).with(Modulus::G13, shear);
        for moduli in [all, all.without(Modulus::C13).without(Modulus::C11), one_wave_each] {
            let observed = Observation::new(moduli, state(None));
            let e = model(NAME).infer(&observed, &Calibration::PAPER).unwrap();
            assert!((e.structure.k.unwrap() - K).abs() < 1e-9, "{:?}", e.structure);
            let share = e.notes.iter().find_map(|note| note.value("share"));
            assert!((share.unwrap() - f).abs() < 1e-9, "{share:?} for {f}");
            assert_eq!(e.status(), status, "{f}: {:?}", e.notes);
        }
    }
}

#[test]
fn without_a_bulk_modulus_there_is_no_coordination_number() {
    let shear_alone = Moduli::NONE.with(Modulus::G12, 80.0e6).with(Modulus::G13, 90.0e6);
    let e = model(NAME).infer(&Observation::new(shear_alone, state(None)), &Calibration::PAPER);
    assert!(matches!(e, Err(EmtError::Missing { missing: "Theta", .. })), "{e:?}");
    let no_bulk = Moduli::NONE.with(Modulus::C33, 100.0e6).with(Modulus::G13, 90.0e6);
    let e = model(NAME).infer(&Observation::new(no_bulk, state(None)), &Calibration::PAPER);
    assert!(e.as_ref().is_err_and(|e| e.is(Code::Unstable) && e.to_string().contains("Theta")), "{e:?}");
}

/// Grains twice as stiff at twice the pressure are the same pack.
#[test]
fn only_the_pressure_over_the_stiffness_of_the_grains_counts() {
    let double = Material { shear_modulus: 2.0 * Material::GLASS.shear_modulus, ..Material::GLASS };
    let conditions = Conditions { pressure: Measured::exact(200.0e3), material: Some(double), ..state(None) };
    let (base, scaled) = (predicted(&state(None)), predicted(&conditions));
    for (a, b) in base.values().into_iter().flatten().zip(scaled.values().into_iter().flatten()) {
        assert!((b / a / 2.0 - 1.0).abs() < 1e-12, "{a} {b}");
    }
}
