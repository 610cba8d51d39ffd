//! Every error and every warning.

use crate::{PAPER_MODELS, model, ours};
use grainlab_core::contact::{ContactLaw, SpringLaw};
use grainlab_core::notes::{Code, Note, Status};
use grainlab_core::results::StrainRatios;
use grainlab_core::results::{InferredQuantity, Microstructure};
use grainlab_core::{Mat3, Material, Stiffness, TransverseIsotropy};
use grainlab_emt::{
    Calibration, CalibrationError, Conditions, EmtError, Inversion, IsotropicCalibration, Measured, Moduli,
    ModuliCovariance, Modulus, Observation, StrainRatio, StrainRatioSource,
};

fn sound() -> Observation {
    let mut o =
        Observation::from_g12_g13_theta(121.7e6, 127.4e6, 144.4e6, 50.0e3, StrainRatio::given(-0.0623));
    o.conditions.solid_fraction = Some(Measured::exact(0.636));
    o
}

fn set(o: &mut Observation, modulus: Modulus, value: f64) {
    o.moduli = o.moduli.with(modulus, value);
}

/// The result of every model for a changed observation; all must agree.
fn fault(change: impl Fn(&mut Observation)) -> EmtError {
    let mut o = sound();
    change(&mut o);
    let [first, others @ ..] =
        PAPER_MODELS.map(|name| model(name).infer(&o, &Calibration::PAPER).unwrap_err());
    for other in others {
        assert_eq!(std::mem::discriminant(&first), std::mem::discriminant(&other), "{first} {other}");
    }
    first
}

fn estimate(o: &Observation) -> Inversion {
    model("ratio").infer(o, &Calibration::PAPER).unwrap()
}

/// The estimate from the moduli predicted for a structure.
fn of_structure(k: f64, k_hat: f64, eps: f64, g: f64) -> Inversion {
    let conditions = Conditions { gamma: StrainRatio::given(g), ..Conditions::at(100.0e3) };
    let moduli = model("ratio")
        .predict(&Microstructure::paper(k, k_hat, eps), &conditions, &Calibration::PAPER)
        .unwrap();
    estimate(&Observation::new(moduli, conditions))
}

#[test]
fn a_sound_observation_has_no_errors_and_one_warning_if_the_contact_law_is_not_known() {
    let e = estimate(&sound());
    assert_eq!(
        (e.status(), e.notes.as_slice()),
        (Status::Ok, &[Note::contact_law_assumed(), Note::data_error_unknown()][..])
    );
    let mut known = sound().with_relative_error(0.01);
    known.conditions.contact_law = Some("hertz_mindlin".parse().unwrap());
    assert_eq!(estimate(&known).notes, []);
    assert_eq!((e.model, e.calibration.as_str()), ("ratio", "paper"));
    assert_eq!(e.gamma.unwrap().source, StrainRatioSource::Given);
}

/// Every law that the list of laws has or will have, but the one of the calibration.
#[test]
fn models_of_smooth_spheres_have_no_estimate_for_another_contact_law_and_that_of_free_contacts_has() {
    let others = SpringLaw::EXAMPLES.into_iter().filter(|springs| *springs != SpringLaw::HertzMindlin);
    for springs in others {
        for model in grainlab_emt::models() {
            let mut o = sound();
            o.conditions.contact_law = Some(ContactLaw::of(springs));
            let refused = model.infer(&o, ours()).unwrap_err();
            assert_eq!(refused, Note::other_contact_law(springs.name()).into(), "{}", model.name());
            assert!(!refused.is_input_error() && refused.to_string().starts_with("unknown: "), "{refused}");
        }
        let mut o = sound();
        o.conditions.contact_law = Some(ContactLaw::of(springs));
        let found = grainlab_emt::free_contact().infer(&o, ours()).unwrap();
        assert!(found.structure.z.is_some_and(|z| (4.0..6.6).contains(&z)), "{found:?}");
    }
}

/// The stiffness of linear springs does not follow from a material, which a scene with such springs need not have.
#[test]
fn an_estimate_for_linear_springs_does_not_depend_on_the_material_of_the_grains() {
    let of = |factor: f64| {
        let mut o = sound();
        o.conditions.contact_law = Some("linear:1e5,0.5".parse().unwrap());
        o.conditions.material = Some(Material { shear_modulus: factor * 29e9, ..Material::GLASS });
        grainlab_emt::free_contact().infer(&o, ours()).unwrap()
    };
    let [glass, soft, hard] = [1.0, 1e-4, 1e3].map(of);
    for other in [&soft, &hard] {
        let [a, b] = [&glass, other].map(|e| (e.structure.z.unwrap(), e.structure.eps.unwrap()));
        assert!((a.0 - b.0).abs() < 0.02 && (a.1 - b.1).abs() < 0.005, "{a:?} {b:?}");
        assert!(!other.notes.iter().any(|w| w.to_string().contains("p/E*")), "{:?}", other.notes);
    }
}

#[test]
fn no_model_has_an_estimate_for_moduli_without_tangential_springs() {
    for model in grainlab_emt::models() {
        let mut o = sound();
        o.conditions.smooth = true;
        let refused = model.infer(&o, ours());
        assert_eq!(refused.unwrap_err(), Note::smooth_grains().into(), "{}", model.name());
    }
}

#[test]
fn numbers_that_are_not_finite_are_named() {
    for modulus in Modulus::ALL {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(fault(|o| set(o, modulus, value)).to_string().contains(modulus.name()));
        }
    }
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(fault(|o| o.conditions.pressure.value = value).to_string().contains("pressure"));
    }
    for change in [
        (|o: &mut Observation| o.conditions.gamma.value = f64::NAN) as fn(&mut Observation),
        |o| o.conditions.gamma.stddev = f64::NAN,
        |o| o.conditions.pressure.stddev = f64::INFINITY,
        |o| o.conditions.solid_fraction = Some(Measured { value: 0.6, stddev: f64::NAN }),
        |o| o.conditions.material = Some(Material { shear_modulus: f64::NAN, ..Material::GLASS }),
        |o| o.covariance = Some(ModuliCovariance::from_element(f64::NAN)),
    ] {
        assert!(matches!(fault(change), EmtError::NotFinite { .. }));
    }
}

#[test]
fn moduli_and_pressure_must_be_positive() {
    let refused = |name: &str, change: &dyn Fn(&mut Observation)| {
        let e = fault(change);
        assert!(
            matches!(e, EmtError::NotPositive { quantity, .. } if quantity.contains(name)),
            "{name}: {e}"
        );
    };
    for value in [0.0, -1.0] {
        Modulus::ALL
            .into_iter()
            .filter(|m| *m != Modulus::C13)
            .for_each(|m| refused(m.name(), &|o| set(o, m, value)));
        refused("pressure", &|o| o.conditions.pressure.value = value);
        let grains = Material { shear_modulus: value, ..Material::GLASS };
        refused("shear modulus", &|o| o.conditions.material = Some(grains));
    }
}

#[test]
fn states_that_no_packing_has_are_refused() {
    for phi in [0.0, 1.0, -0.6, f64::NAN] {
        let e = fault(|o| o.conditions.solid_fraction = Some(Measured::exact(phi)));
        assert!(matches!(e, EmtError::NoState { .. }), "{e}");
    }
    for ratio in [-1.6, 3.1, f64::NAN] {
        let e = fault(|o| o.conditions.stress_ratio = Some(Measured::exact(ratio)));
        assert!(matches!(e, EmtError::NoState { .. }), "{e}");
    }
    for nu in [-0.1, 0.5 + 1e-9, f64::NAN] {
        let grains = Material { poisson_ratio: nu, ..Material::GLASS };
        let e = fault(|o| o.conditions.material = Some(grains));
        assert!(matches!(e, EmtError::NoState { .. }), "{e}");
    }
}

/// 9 Θ = 4 C11 − 4 G12 + 4 C13 + C33 determines Θ if the others are known.
#[test]
fn moduli_that_leave_another_one_no_stable_value_are_refused_by_its_name() {
    let e = fault(|o| {
        o.moduli = o.moduli.without(Modulus::Theta);
        for (modulus, value) in [(Modulus::C11, 90.0e6), (Modulus::C33, 50.0e6), (Modulus::C13, -80.0e6)] {
            set(o, modulus, value);
        }
    });
    let EmtError::NoAnswer(why) = &e else { panic!("{e}") };
    assert!(why.is(Code::Unstable) && why.names("Theta") && why.values()[0] < 0.0, "{e}");
}

#[test]
fn uncertainties_must_be_uncertainties() {
    assert!(matches!(fault(|o| o.conditions.pressure.stddev = -1.0), EmtError::NegativeStddev { .. }));
    assert!(matches!(fault(|o| o.conditions.gamma.stddev = -0.1), EmtError::NegativeStddev { .. }));
    let relative = |error: f64| fault(|o| o.clone_from(&sound().with_relative_error(error))).to_string();
    assert!(relative(-0.01).contains("the relative error, is negative"));
    assert!([f64::NAN, f64::INFINITY].into_iter().all(|error| relative(error).contains("is not finite")));
    let of = |c: Mat3| sound().with_g12_g13_theta_covariance(&(c * 1e12));
    let skew = of(Mat3::new(1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
    assert!(fault(|o| o.clone_from(&skew)).to_string().contains("symmetric"));
    let indefinite = of(Mat3::new(1.0, 2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0));
    assert!(fault(|o| o.clone_from(&indefinite)).to_string().contains("negative eigenvalue"));
    // The covariance of fully correlated errors, of rank one.
    assert!(estimate(&of(Mat3::from_element(1.0))).stddev(InferredQuantity::K).is_some());
}

#[test]
fn strain_ratios_that_open_contacts_are_refused() {
    for g in [-1.0, -1.5, 0.5, 3.0] {
        assert!(fault(|o| o.conditions.gamma.value = g).is(Code::GammaOutOfRange));
    }
}

/// At g = −0.9 the formula has its pole at a = 0.89; beyond it the solution is not a contact distribution.
#[test]
fn ratios_that_no_anisotropy_gives_at_that_strain_are_refused() {
    let mut o = Observation::from_g12_g13_theta(100.0e6, 195.0e6, 144.4e6, 50.0e3, StrainRatio::given(-0.9));
    o.conditions.solid_fraction = Some(Measured::exact(0.636));
    for name in PAPER_MODELS {
        let e = model(name).infer(&o, &Calibration::PAPER).unwrap_err();
        assert!(e.is(Code::NoAnisotropy), "{name}: {e}");
    }
}

#[test]
fn each_warning_fires_outside_its_range_and_marks_the_estimate_extrapolated() {
    let warned = |e: Inversion, expected: fn(&Note) -> bool| {
        assert!(e.notes.iter().any(expected), "{:?}", e.notes);
        assert_eq!(e.status(), Status::Extrapolated);
    };
    warned(of_structure(5.5, 5.5, 0.1, -0.35), |w| w.is(Code::GammaLarge));
    let with = |change: fn(&mut Observation)| {
        let mut o = sound();
        change(&mut o);
        estimate(&o)
    };
    warned(with(|o| set(o, Modulus::G13, 1.51 * 121.7e6)), |w| w.is(Code::RatioUnusual));
    warned(with(|o| set(o, Modulus::G13, 0.6 * 121.7e6)), |w| w.is(Code::EpsOutOfRange));
    warned(with(|o| o.conditions.gamma.value = 0.26), |w| w.is(Code::ContactsOpen));
    warned(with(|o| o.conditions.gamma.value = -0.51), |w| w.is(Code::ContactsOpen));
    let other = Material { poisson_ratio: 0.3, ..Material::GLASS };
    let mut o = sound();
    o.conditions.material = Some(other);
    warned(estimate(&o), |w| *w == Note::other_grains(0.3, 0.2));
    let law = |text: &str| {
        let mut o = sound();
        o.conditions.contact_law = Some(text.parse().unwrap());
        estimate(&o)
    };
    warned(law("hertz_mindlin:1e4,1e-3,0.1"), |w| w.is(Code::RollingResistance));
    assert_eq!(law("hertz_mindlin").status(), Status::Ok);
    let inside = of_structure(5.5, 5.5, 0.99, 0.0);
    let notes = vec![Note::contact_law_assumed(), Note::data_error_unknown()];
    assert_eq!((inside.status(), inside.notes), (Status::Ok, notes));
}

/// With shear moduli of 60 MPa and a P modulus of 50 MPa, a strain E11 = −E22 would cost no energy.
#[test]
fn moduli_of_no_stable_medium_are_used_with_a_warning() {
    let mut o = sound();
    set(&mut o, Modulus::C11, 100.0e6);
    let e = estimate(&o);
    assert!(e.notes.contains(&Note::not_one_medium()) && e.status() == Status::Contradictory);
}

/// C22 = 1.5 C11 is far from any medium isotropic about e3; the moduli taken are those of the nearest one.
#[test]
fn an_orthotropic_stiffness_is_used_with_a_warning_that_has_its_asymmetry() {
    let medium = TransverseIsotropy::of_constants(240.0e6, 260.0e6, 60.0e6, 95.0e6, 90.0e6);
    let conditions = Conditions { solid_fraction: Some(Measured::exact(0.636)), ..sound().conditions };
    let orthotropic = |share: f64| {
        let mut c = medium.stiffness().0;
        c[(1, 1)] *= 1.0 + share;
        c[(3, 3)] *= 1.0 + share;
        Stiffness(c)
    };
    for name in PAPER_MODELS.into_iter().chain(["relaxed"]) {
        let infer = |share: f64| {
            let o = Observation::of_stiffness(&orthotropic(share), conditions);
            model(name).infer(&o, model(name).default_calibration()).unwrap()
        };
        let warned = |e: &Inversion| {
            e.notes.iter().any(|w| w.is(Code::NotTransverselyIsotropic) && w.values()[0] > 0.05)
        };
        assert!(!warned(&infer(0.0)) && !warned(&infer(0.01)), "{name}");
        let e = infer(0.5);
        // The relaxed network has scatter that so large an asymmetry exceeds.
        let status = if name == "relaxed" { Status::Contradictory } else { Status::Extrapolated };
        assert!(warned(&e) && e.status() == status, "{name}: {:?}", e.notes);
    }
}

#[test]
fn gamma_is_taken_from_the_total_strain_then_from_the_contacts_then_as_zero_with_a_warning() {
    let measured = StrainRatios { total: Some(-0.06), elastic: Some(0.01), contact: Some(0.02) };
    let of = |a: &StrainRatios| (StrainRatio::preferred(a).source, StrainRatio::preferred(a).value);
    assert_eq!(of(&measured), (StrainRatioSource::Total, -0.06));
    assert_eq!(of(&StrainRatios { total: None, ..measured }), (StrainRatioSource::Contact, 0.02));
    assert_eq!(of(&StrainRatios::default()), (StrainRatioSource::Zero, 0.0));
    let mut o = sound();
    o.conditions.gamma = StrainRatio::ZERO;
    let e = estimate(&o);
    assert_eq!(
        (e.notes.as_slice(), e.status()),
        (
            &[Note::contact_law_assumed(), Note::gamma_assumed_zero(), Note::data_error_unknown()][..],
            Status::Ok
        )
    );
    assert_eq!(e.gamma.unwrap().to_string(), "gamma/Delta = 0.0000 (not known, taken as 0)");
}

#[test]
fn a_calibration_that_could_not_be_inverted_is_refused_by_field() {
    for (constants, at_fault) in [
        ([0.0, -3.66, 75.0, -0.5], "alpha"),
        ([170.0, 0.5, 75.0, 1.0], "beta"),
        ([170.0, -3.66, f64::NAN, -0.5], "rho"),
        ([170.0, -3.66, 75.0, -3.66], "zeta"),
    ] {
        let refused = IsotropicCalibration::new(constants, [4.8, 6.0]).unwrap_err();
        let CalibrationError::Constant { field, .. } = refused else { panic!("{refused}") };
        assert_eq!(field, at_fault);
    }
    let upside_down = IsotropicCalibration::new([170.0, -3.66, 75.0, -0.5], [6.0, 4.8]).unwrap_err();
    assert!(matches!(upside_down, CalibrationError::Constant { field: "fitted", .. }));
}

#[test]
fn a_calibration_file_with_an_impossible_number_or_of_an_earlier_version_is_refused() {
    let text = ours().to_toml().unwrap();
    let grains = format!("grains = {}", ours().network().unwrap().grains);
    for (sound, damaged, at_fault) in [
        ("density = 2500.0", "density = 0.0", "material.density"),
        (&*grains, "grains = 0", "network.grains"),
        ("[network]\n", "[network]\nabscissa = \"k\"\n", "must be learned anew"),
    ] {
        assert!(text.contains(sound), "{sound}");
        let refused = Calibration::parse(&text.replace(sound, damaged)).unwrap_err();
        assert!(refused.to_string().contains(at_fault), "{damaged}: {refused}");
    }
}

#[test]
fn what_is_missing_is_named() {
    let without = |name, modulus| {
        let mut o = sound();
        o.moduli = o.moduli.without(modulus);
        model(name).infer(&o, &Calibration::PAPER)
    };
    for name in PAPER_MODELS {
        for (modulus, missing) in [(Modulus::G12, "G12"), (Modulus::G13, "G13")] {
            let e = without(name, modulus).unwrap_err();
            assert_eq!(e, EmtError::Missing { model: name, missing });
            assert!(e.is_input_error());
        }
    }
    let nothing = Observation { moduli: Moduli::NONE, ..sound() };
    assert!(matches!(
        model("ratio").infer(&nothing, &Calibration::PAPER),
        Err(EmtError::Missing { missing: "G12", .. })
    ));
}

#[test]
fn a_modulus_with_a_huge_error_is_one_that_is_not_known() {
    let mut o = sound().with_relative_error(0.01);
    o.conditions.stress_ratio = Some(Measured::exact(0.0));
    o.conditions.size_spread = Some(0.0);
    let relaxed = grainlab_emt::model("relaxed").unwrap();
    let infer = |o: &Observation| relaxed.infer(o, ours()).unwrap();
    let mut without = o.clone();
    without.moduli = without.moduli.without(Modulus::G12);
    let covariance = o.covariance.as_mut().unwrap();
    let at = Modulus::G12 as usize;
    covariance[(at, at)] = 1e30;
    let found = infer(&o);
    assert!(
        found.notes.iter().any(|note| note.is(Code::TakenAsUnknown) && note.names("G12")),
        "{:?}",
        found.notes
    );
    assert_eq!(found.structure, infer(&without).structure);
}

#[test]
fn unknown_errors_of_the_moduli_and_large_ones_of_the_state_are_said() {
    let says = |o: &Observation, wanted: fn(&Note) -> bool| {
        let relaxed = grainlab_emt::model("relaxed").unwrap();
        relaxed.infer(o, ours()).unwrap().notes.iter().any(wanted)
    };
    let no_errors = |w: &Note| w.is(Code::DataErrorUnknown);
    assert!(says(&sound(), no_errors) && !says(&sound().with_relative_error(0.01), no_errors));
    let mut o = sound().with_relative_error(0.01);
    let large = |w: &Note| w.is(Code::StateErrorLarge) && w.names("pressure");
    assert!(!says(&o, large));
    o.conditions.pressure.stddev = 0.5 * o.conditions.pressure.value;
    assert!(says(&o, large));
}

#[test]
fn the_constants_of_the_paper_are_not_used_above_the_packings_that_their_errors_are_known_for() {
    let dense = of_structure(5.5, 8.0, 0.02, -0.05);
    assert_eq!(dense.status(), Status::Extrapolated, "{:?}", dense.notes);
    assert_eq!(of_structure(5.5, 5.6, 0.02, -0.05).status(), Status::Ok);
}

/// q/p of three stresses has no sign. The ratio that models take has one: axial minus lateral stress over pressure.
#[test]
fn a_stress_ratio_with_a_sign_is_called_the_axial_one() {
    let unknown = Note::stress_ratio_unknown().to_string();
    assert!(
        unknown.starts_with("the axial stress ratio is not known") && !unknown.contains("q/p"),
        "{unknown}"
    );
    let mut o = sound();
    o.conditions.stress_ratio = Some(Measured::exact(-0.9));
    let structure = Microstructure { z: Some(5.3), ..Microstructure::paper(4.8, 5.3, 0.02) };
    let refused = model("relaxed").predict(&structure, &o.conditions, ours()).unwrap_err();
    assert!(
        refused.is(Code::BeyondDomain) && refused.to_string().starts_with("the axial stress ratio"),
        "{refused}"
    );
}

/// A size of the grains may be known all the same.
#[test]
fn a_model_that_takes_no_size_of_the_grains_does_not_call_the_size_unknown() {
    for law in ["linear", "rough"] {
        let text = Note::contacts_stated(law).to_string();
        assert!(text.contains("it takes no size of the grains") && !text.contains("not known"), "{text}");
    }
}
