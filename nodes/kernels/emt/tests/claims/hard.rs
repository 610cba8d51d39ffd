//! Cases at the edges of the domains of the models, by name, with their results.

use crate::{PAPER_MODELS, model};
use grainlab_core::notes::{Code, Note, Status};
use grainlab_core::results::{InferredQuantity, Microstructure};
use grainlab_emt::{
    Calibration, Conditions, EmtError, Inversion, Measured, Modulus, Observation, StrainRatio,
};

/// G12, G13 = `ratio` G12 and Θ of a packing of some k̂ near 5.
fn with_ratio(ratio: f64) -> Observation {
    let mut o =
        Observation::from_g12_g13_theta(100.0e6, ratio * 100.0e6, 160.0e6, 100.0e3, StrainRatio::given(0.0));
    o.conditions.solid_fraction = Some(Measured::exact(0.636));
    o
}

fn infer(name: &str, o: &Observation) -> Result<Inversion, EmtError> {
    model(name).infer(o, &Calibration::PAPER)
}

/// ε = 35 a/(21 − 7 a) = 2.46 at r = 1.99: a warning that it is outside.
/// The quantity that no packing has.
fn no_packing(refused: &EmtError) -> Option<&str> {
    match refused {
        EmtError::NoAnswer(why) if why.is(Code::NoPacking) => Some(&why.subjects()[0]),
        _ => None,
    }
}

#[test]
fn a_shear_ratio_of_1_99_is_outside_every_range_and_reported() {
    for name in PAPER_MODELS {
        // With the usual Θ, no k̂ gives so large a shear modulus; with a larger one at the usual pressure, no packing has such a k.
        let mut o = with_ratio(1.99);
        o.moduli = o.moduli.with(Modulus::Theta, 50.0 * 160.0e6);
        assert!(infer(name, &o).is_err_and(|e| no_packing(&e) == Some("k")), "{name}");
        o.conditions.pressure = Measured::exact(1e10);
        let e = infer(name, &o).unwrap();
        assert!((e.structure.eps.unwrap() - 35.0 * 0.99 / (21.0 - 7.0 * 0.99)).abs() < 1e-10, "{name}");
        assert_eq!(e.status(), Status::Extrapolated);
        assert!(e.notes.iter().any(|w| w.is(Code::EpsOutOfRange)));
        assert!(e.notes.iter().any(|w| w.is(Code::RatioUnusual)));
    }
}

#[test]
fn a_shear_ratio_of_2_or_more_is_refused_and_a_negative_one_is_no_modulus() {
    for name in PAPER_MODELS {
        for ratio in [2.0, 2.5, 1e9] {
            assert_eq!(infer(name, &with_ratio(ratio)).unwrap_err(), Note::ratio_out_of_range(ratio).into());
        }
        let e = infer(name, &with_ratio(-1.0)).unwrap_err();
        assert_eq!(e, EmtError::NotPositive { quantity: "G13", value: -100.0e6 });
    }
}

/// s = (ρ/α)(G12/Θ) = 75/170 G12/Θ at r = 1; k̂ = (3.66 − s/2)/(1 − s).
#[test]
fn as_s_goes_to_1_k_hat_grows_beyond_every_packing_and_from_1_on_there_is_none() {
    let with = |s: f64| {
        let mut o = with_ratio(1.0);
        o.moduli = o.moduli.with(Modulus::Theta, 75.0 / 170.0 * 100.0e6 / s);
        o
    };
    for name in PAPER_MODELS.into_iter().filter(|name| *name != "emt") {
        let k_hat = |s: f64| (3.66 - 0.5 * s) / (1.0 - s);
        let e = infer(name, &with(0.75)).unwrap();
        assert!((e.structure.k_hat.unwrap() / k_hat(0.75) - 1.0).abs() < 1e-6, "{name}");
        assert!(e.notes.iter().any(|w| w.is(Code::CoordinationImpossible)));
        assert_eq!(e.status(), Status::Extrapolated);
        for s in [0.9, 0.999, 1.0 - 1e-9] {
            let refused = infer(name, &with(s)).unwrap_err();
            let EmtError::NoAnswer(why) = &refused else { panic!("{name}: {refused}") };
            match no_packing(&refused) {
                Some("k") => {}
                Some("k_hat") => assert!((why.values()[0] / k_hat(s) - 1.0).abs() < 1e-6, "{name}"),
                _ => panic!("{name}: {refused}"),
            }
        }
        for s in [1.0 + 1e-12, 1.5, 100.0] {
            let e = infer(name, &with(s)).unwrap_err();
            let EmtError::NoAnswer(why) = &e else { panic!("{name}: {e}") };
            let limit = why.value("limit").filter(|_| why.is(Code::ShearTooStiff)).unwrap();
            assert!((limit - 170.0 / 75.0).abs() < 1e-14 && e.to_string().contains("`paper`"), "{e}");
        }
    }
}

#[test]
fn k_hat_of_3_67_and_4_79_come_back_with_a_warning() {
    for name in PAPER_MODELS.into_iter().filter(|name| *name != "emt") {
        for k_hat in [3.67, 4.79] {
            let conditions = Conditions { gamma: StrainRatio::given(-0.05), ..Conditions::at(100.0e3) };
            let structure = Microstructure::paper(5.0, k_hat, 0.05);
            let moduli = model(name).predict(&structure, &conditions, &Calibration::PAPER).unwrap();
            let e = infer(name, &Observation::new(moduli, conditions)).unwrap();
            assert!((e.structure.k_hat.unwrap() - k_hat).abs() < 1e-12, "{name}");
            let below = Note::below_calibration("k_hat", e.structure.k_hat.unwrap(), 4.8);
            let expected = [below, Note::contact_law_assumed(), Note::data_error_unknown()];
            assert_eq!((e.notes.as_slice(), e.status()), (&expected[..], Status::Extrapolated));
        }
    }
}

/// k and k̂ are undetermined; ε is the same as with Θ.
#[test]
fn without_theta_eps_alone_is_determined() {
    let all = with_ratio(1.02).with_relative_error(0.01);
    let mut o = all.clone();
    o.moduli = o.moduli.without(Modulus::Theta);
    for name in PAPER_MODELS {
        let (e, with_theta) = (infer(name, &o).unwrap(), infer(name, &all).unwrap());
        assert_eq!(e.structure.eps, with_theta.structure.eps);
        if name == "emt" {
            // It does not use Θ.
            assert_eq!(e.structure, with_theta.structure);
            continue;
        }
        assert_eq!(
            e.structure,
            Microstructure { eps: e.structure.eps, ..Microstructure::default() },
            "{name}"
        );
        assert!(e.stddev(InferredQuantity::Eps).unwrap() > 0.01);
        assert!(e.stddev(InferredQuantity::K).is_none() && e.information(InferredQuantity::KHat).is_none());
        assert_eq!(e.condition_number(), Some(1.0));
    }
}
