//! The models of rock physics: contacts in all directions alike.

use crate::model;
use grainlab_core::Material;
use grainlab_core::results::{InferredQuantity, Microstructure};
use grainlab_emt::{
    Calibration, Conditions, EmtError, Measured, Moduli, Modulus, Observation, Status, Warning,
};

const MODELS: [&str; 2] = ["hertz-mindlin", "johnson"];
const K: f64 = 5.2;

fn state(stress_ratio: Option<f64>) -> Conditions {
    Conditions {
        solid_fraction: Some(Measured::exact(0.63)),
        stress_ratio: stress_ratio.map(Measured::exact),
        ..Conditions::at(100.0e3)
    }
}

fn predicted(name: &str, stress_ratio: f64) -> Moduli {
    let structure = Microstructure::default().with(InferredQuantity::K, K);
    model(name).predict(&structure, &state(Some(stress_ratio)), &Calibration::PAPER).unwrap()
}

fn get(moduli: &Moduli, modulus: Modulus) -> f64 {
    moduli.get(modulus).unwrap()
}

#[test]
fn at_isotropic_stress_both_are_one_model() {
    let [first, others @ ..] = MODELS.map(|name| predicted(name, 0.0).values());
    for other in others {
        for (a, b) in first.iter().flatten().zip(other.iter().flatten()) {
            assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        }
    }
}

#[test]
fn contact_anisotropy_is_unknown_and_the_estimate_says_so() {
    for name in MODELS {
        let observed = Observation::new(predicted("johnson", 0.2), state(Some(0.2)));
        let e = model(name).infer(&observed, &Calibration::PAPER).unwrap();
        assert_eq!(e.structure.eps, None, "{name}");
        assert!(e.warnings.contains(&Warning::IsotropicContacts) && e.status == Status::Ok, "{name}: {e:?}");
    }
    let text = Warning::IsotropicContacts.to_string();
    assert!(text.contains("eps is unknown, not zero"), "{text}");
}

/// G of a share f of contacts that stick lies on the line from Walton's smooth to his rough spheres.
#[test]
fn the_shear_modulus_gives_the_share_of_contacts_that_stick() {
    let rough = predicted("hertz-mindlin", 0.0);
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
            let e = model("hertz-mindlin").infer(&observed, &Calibration::PAPER).unwrap();
            assert!((e.structure.k.unwrap() - K).abs() < 1e-9, "{:?}", e.structure);
            let share = e.warnings.iter().find_map(|w| match w {
                Warning::StickingShare { share } => Some(*share),
                _ => None,
            });
            assert!((share.unwrap() - f).abs() < 1e-9, "{share:?} for {f}");
            assert_eq!(e.status, status, "{f}: {:?}", e.warnings);
        }
    }
}

#[test]
fn without_a_bulk_modulus_there_is_no_coordination_number() {
    let shear_alone = Moduli::NONE.with(Modulus::G12, 80.0e6).with(Modulus::G13, 90.0e6);
    for name in MODELS {
        let e = model(name).infer(&Observation::new(shear_alone, state(Some(0.0))), &Calibration::PAPER);
        assert!(matches!(e, Err(EmtError::Missing { missing: "Theta", .. })), "{name}: {e:?}");
    }
    let no_bulk = Moduli::NONE.with(Modulus::C33, 100.0e6).with(Modulus::G13, 90.0e6);
    let e = model("hertz-mindlin").infer(&Observation::new(no_bulk, state(None)), &Calibration::PAPER);
    assert!(matches!(e, Err(EmtError::Unstable { modulus: "Theta", .. })), "{e:?}");
}

#[test]
fn a_larger_stress_along_the_axis_makes_the_axis_stiffer() {
    let mut before = (f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
    for q in [-0.6, -0.3, -0.05, 0.0, 0.05, 0.3, 0.6, 1.2] {
        let moduli = predicted("johnson", q);
        let p = (get(&moduli, Modulus::C33) / get(&moduli, Modulus::C11)).ln();
        let s = (get(&moduli, Modulus::G13) / get(&moduli, Modulus::G12)).ln();
        let observed = Observation::new(moduli, state(Some(q)));
        let e = model("johnson").infer(&observed, &Calibration::PAPER).unwrap();
        let stiffer = e.structure.eps_stiffness.unwrap();
        assert!(p > before.0 && s > before.1 && stiffer > before.2, "q/p {q}: {p} {s} {stiffer}");
        assert!(q == 0.0 || (p * q > 0.0 && s * q > 0.0 && stiffer * q > 0.0), "{q}");
        before = (p, s, stiffer);
    }
}

#[test]
fn an_unknown_stress_ratio_is_taken_as_isotropic_and_one_that_opens_contacts_is_refused() {
    let moduli = predicted("johnson", 0.0);
    let e = model("johnson").infer(&Observation::new(moduli, state(None)), &Calibration::PAPER).unwrap();
    assert!(e.warnings.contains(&Warning::StressRatioUnknown));
    for q in [-0.8, 1.6] {
        let e = model("johnson").infer(&Observation::new(moduli, state(Some(q))), &Calibration::PAPER);
        assert!(matches!(e, Err(EmtError::OutsideDomain { quantity: "q/p", .. })), "{q}: {e:?}");
    }
}

/// Grains twice as stiff at twice the pressure are the same pack.
#[test]
fn only_the_pressure_over_the_stiffness_of_the_grains_counts() {
    let double = Material { shear_modulus: 2.0 * Material::GLASS.shear_modulus, ..Material::GLASS };
    for name in MODELS {
        let base = predicted(name, 0.1);
        let conditions =
            Conditions { pressure: Measured::exact(200.0e3), material: Some(double), ..state(Some(0.1)) };
        let structure = Microstructure::default().with(InferredQuantity::K, K);
        let scaled = model(name).predict(&structure, &conditions, &Calibration::PAPER).unwrap();
        for (a, b) in base.values().into_iter().flatten().zip(scaled.values().into_iter().flatten()) {
            assert!((b / a / 2.0 - 1.0).abs() < 1e-12, "{name}: {a} {b}");
        }
    }
}
