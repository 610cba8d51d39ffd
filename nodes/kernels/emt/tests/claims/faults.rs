//! Every error and every warning.

use emt::{
    Calibration, EmtError, Estimate, Gamma, GammaSource, Observation, Status, Structure, Warning, infer_all,
};
use grains::{Anisotropy, Mat3};

fn sound() -> Observation {
    Observation::new(121.7e6, 127.4e6, 144.4e6, 50.0e3, Gamma::given(-0.0623))
}

/// What both models say to a changed observation; they must agree.
fn fault(change: impl Fn(&mut Observation)) -> EmtError {
    let mut o = sound();
    change(&mut o);
    let mut errors = infer_all(&o, &Calibration::PAPER).into_iter().map(|(_, result)| result.unwrap_err());
    let (corrected, printed) = (errors.next().unwrap(), errors.next().unwrap());
    assert_eq!(std::mem::discriminant(&corrected), std::mem::discriminant(&printed));
    corrected
}

fn estimate(o: &Observation) -> Estimate {
    emt::model("ratio").unwrap().infer(o, &Calibration::PAPER).unwrap()
}

/// The estimate from what a structure is predicted to have.
fn of_structure(k: f64, k_hat: f64, eps: f64, g: f64) -> Estimate {
    let model = emt::model("ratio").unwrap();
    estimate(&model.predict(&Structure { k, k_hat, eps }, Gamma::given(g), 100.0e3, &Calibration::PAPER))
}

#[test]
fn a_sound_observation_has_neither_errors_nor_warnings() {
    let e = estimate(&sound());
    assert_eq!((e.status, e.warnings.len()), (Status::Ok, 0));
    assert_eq!((e.model, e.calibration.as_str(), e.gamma.source), ("ratio", "paper", GammaSource::Given));
}

#[test]
fn numbers_that_are_not_finite_are_named() {
    assert!(fault(|o| o.g12 = f64::NAN).to_string().contains("G12"));
    assert!(fault(|o| o.g13 = f64::INFINITY).to_string().contains("G13"));
    assert!(fault(|o| o.theta = f64::NAN).to_string().contains("Theta"));
    assert!(fault(|o| o.pressure = f64::NEG_INFINITY).to_string().contains("pressure"));
    for change in [
        (|o: &mut Observation| o.gamma.value = f64::NAN) as fn(&mut Observation),
        |o| o.gamma.stddev = f64::NAN,
        |o| o.pressure_stddev = f64::INFINITY,
        |o| o.covariance = Some(Mat3::from_element(f64::NAN)),
    ] {
        assert!(matches!(fault(change), EmtError::NotFinite { .. }));
    }
}

#[test]
fn moduli_and_pressure_must_be_positive() {
    for change in [
        (|o: &mut Observation| o.g12 = 0.0) as fn(&mut Observation),
        |o| o.g13 = -1.0,
        |o| o.theta = 0.0,
        |o| o.pressure = -50.0e3,
    ] {
        assert!(matches!(fault(change), EmtError::NotPositive { .. }));
    }
}

#[test]
fn uncertainties_must_be_uncertainties() {
    assert!(matches!(fault(|o| o.pressure_stddev = -1.0), EmtError::NegativeStddev { .. }));
    assert!(matches!(fault(|o| o.gamma.stddev = -0.1), EmtError::NegativeStddev { .. }));
    let skew = Mat3::new(1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0) * 1e12;
    assert!(fault(|o| o.covariance = Some(skew)).to_string().contains("symmetric"));
    let indefinite = Mat3::new(1.0, 2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0) * 1e12;
    assert!(fault(|o| o.covariance = Some(indefinite)).to_string().contains("negative eigenvalue"));
    // Fully correlated errors are a covariance, of rank one.
    let mut o = sound();
    o.covariance = Some(Mat3::from_element(1e12));
    assert!(estimate(&o).stddev().is_some());
}

#[test]
fn shear_ratios_outside_the_theory_are_refused() {
    for ratio in [2.0, 2.5] {
        assert!(matches!(fault(|o| o.g13 = ratio * o.g12), EmtError::RatioOutOfRange { .. }));
    }
    let just_inside = Observation { g13: 1.99 * 3.0e6, g12: 3.0e6, ..sound() };
    assert!(matches!(estimate(&just_inside).status, Status::Extrapolated));
}

#[test]
fn strain_ratios_that_turn_contacts_inside_out_are_refused() {
    for g in [-1.0, -1.5, 0.5, 3.0] {
        assert!(matches!(fault(|o| o.gamma.value = g), EmtError::GammaOutOfRange { .. }));
    }
}

/// At g = −0.9 the formula has its pole at a = 0.89; beyond it the solution is no contact distribution at all.
#[test]
fn ratios_that_no_anisotropy_gives_at_that_strain_are_refused() {
    let change = |o: &mut Observation| (o.gamma.value, o.g13) = (-0.9, 1.95 * o.g12);
    assert!(matches!(fault(change), EmtError::NoAnisotropy { .. }));
}

/// k̂ → ∞ where G12/Θ = α/ρ = 2.27 for r = 1, g = 0.
#[test]
fn shear_too_stiff_beside_bulk_is_refused_with_the_limit() {
    let with = |share: f64| {
        let theta = 100.0e6;
        Observation::new(
            share * 170.0 / 75.0 * theta,
            share * 170.0 / 75.0 * theta,
            theta,
            50.0e3,
            Gamma::given(0.0),
        )
    };
    let refused = emt::model("ratio").unwrap().infer(&with(1.0 + 1e-12), &Calibration::PAPER).unwrap_err();
    let EmtError::ShearTooStiff { limit, .. } = &refused else { panic!("{refused}") };
    assert!((limit - 170.0 / 75.0).abs() < 1e-14);
    assert!(refused.to_string().contains("`paper`"));
    let near = estimate(&with(0.999));
    assert!(near.warnings.iter().any(|w| matches!(w, Warning::CoordinationImpossible { .. })));
}

#[test]
fn each_warning_fires_outside_its_range_and_marks_the_estimate_extrapolated() {
    let warned = |e: Estimate, expected: fn(&Warning) -> bool| {
        assert!(e.warnings.iter().any(expected), "{:?}", e.warnings);
        assert_eq!(e.status, Status::Extrapolated);
    };
    warned(of_structure(4.9, 4.79, 0.0, 0.0), |w| matches!(w, Warning::CoordinationBelowFit { .. }));
    warned(of_structure(3.7, 3.67, 0.0, 0.0), |w| matches!(w, Warning::CoordinationBelowFit { .. }));
    warned(of_structure(5.5, 5.5, -0.6, 0.0), |w| matches!(w, Warning::EpsOutOfRange { .. }));
    warned(of_structure(5.5, 5.5, 1.1, 0.0), |w| matches!(w, Warning::RatioUnusual { .. }));
    warned(of_structure(5.5, 5.5, 0.1, -0.35), |w| matches!(w, Warning::GammaLarge { .. }));
    warned(of_structure(5.5, 5.5, 0.1, 0.26), |w| matches!(w, Warning::ContactsOpen { .. }));
    warned(of_structure(5.5, 5.5, 0.1, -0.51), |w| matches!(w, Warning::ContactsOpen { .. }));
    let inside = of_structure(5.5, 5.5, 0.99, 0.0);
    assert_eq!((inside.status, inside.warnings.len()), (Status::Ok, 0));
}

#[test]
fn gamma_is_taken_from_the_total_strain_then_from_the_contacts_then_as_zero_with_a_warning() {
    let measured = Anisotropy { total: Some(-0.06), elastic: Some(0.01), contact: Some(0.02) };
    let of = |a: &Anisotropy| (Gamma::preferred(a).source, Gamma::preferred(a).value);
    assert_eq!(of(&measured), (GammaSource::Total, -0.06));
    assert_eq!(of(&Anisotropy { total: None, ..measured }), (GammaSource::Contact, 0.02));
    assert_eq!(of(&Anisotropy::default()), (GammaSource::Zero, 0.0));
    let e = estimate(&Observation { gamma: Gamma::ZERO, ..sound() });
    assert_eq!((e.warnings.as_slice(), e.status), (&[Warning::GammaAssumedZero][..], Status::Ok));
    assert_eq!(e.gamma.to_string(), "gamma/Delta = 0.0000 (not known, taken as 0)");
}

#[test]
fn a_calibration_that_could_not_be_inverted_is_refused_by_name() {
    for (constants, field) in [
        ([0.0, -3.66, 75.0, -0.5], "alpha"),
        ([170.0, 0.5, 75.0, 1.0], "beta"),
        ([170.0, -3.66, f64::NAN, -0.5], "rho"),
        ([170.0, -3.66, 75.0, -3.66], "zeta"),
    ] {
        let e = Calibration::new("mine", constants, 4.8).unwrap_err();
        assert_eq!(e.field, field);
        assert!(e.to_string().contains("`mine`"));
    }
}
