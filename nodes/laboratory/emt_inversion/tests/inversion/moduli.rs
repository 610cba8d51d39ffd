use crate::{corrected, message, of_data, of_packing, of_ratio, report_of, s1};
use grainlab_core::results::{InferredQuantity, Microstructure, NoStiffness, PackingReport, StrainRatios};
use grainlab_core::{Stiffness, TransverseIsotropy, Vec3};
use grainlab_emt::{Calibration, Conditions, Measured, Modulus, StrainRatio};
use grainlab_emt_inversion::{Answer, Axis, Settings, microstructure_of_moduli, microstructure_of_report};
use grainlab_msgs::geometry_msgs::Vector3;
use grainlab_msgs::msg::{self, Estimate, Moduli};
use nalgebra::Rotation3;

/// A medium with the three moduli of S1.
pub(crate) fn s1_medium() -> Stiffness {
    let m = s1();
    let (c33, c13) = (310e6, 65e6);
    let c11 = (9.0 * m.theta[0] - 4.0 * c13 - c33 + 4.0 * m.g12[0]) / 4.0;
    let c12 = c11 - 2.0 * m.g12[0];
    TransverseIsotropy { c11, c12, c13, c33, g13: m.g13[0], g12: m.g12[0], residual: 0.0 }.stiffness()
}

/// A packing in the state of S1 with the whole stiffness of that medium.
pub(crate) fn s1_stiffness() -> PackingReport {
    report_of(&s1_medium())
}

fn with_error(modulus_error: f64) -> Settings {
    Settings { modulus_error, ..Settings::default() }
}

#[test]
fn table_iii_comes_back_with_header_step_source_and_models_in_order() {
    let message = microstructure_of_moduli(&s1(), &Settings::default()).message;
    assert_eq!((&message.header, message.source_step), (&s1().header, 42));
    assert_eq!(message.source, "moduli");
    let names: Vec<&str> = message.estimates.iter().map(|e| e.model.as_str()).collect();
    assert_eq!(names, grainlab_emt::models().iter().map(|m| m.name()).collect::<Vec<_>>());
    let e = of_ratio(message);
    // The table prints three digits; ε is printed to .001.
    assert!(
        (e.k[0] - 5.73).abs() < 5e-3 && (e.k_hat[0] - 5.63).abs() < 5e-3 && (e.eps[0] - 0.016).abs() < 1e-3,
        "{e:?}"
    );
    assert_eq!(
        (!e.k.is_empty(), !e.k_hat.is_empty(), !e.z.is_empty(), !e.eps.is_empty()),
        (true, true, false, true)
    );
    assert_eq!(e.status, Estimate::STATUS_OK);
}

/// Each model with the moduli that it predicts, as a whole stiffness if it predicts one.
#[test]
fn every_model_finds_the_structure_it_was_given_through_the_message() {
    let assumed = [5.2, 5.25, 5.4, 0.05, 0.04];
    let m = Moduli { stress_ratio: vec![0.0], size_spread: vec![0.0], ..s1() };
    let material = grainlab_core::Material { shear_modulus: 29e9, poisson_ratio: 0.2, density: 2500.0 };
    let conditions = Conditions {
        gamma: StrainRatio {
            source: grainlab_emt::StrainRatioSource::Total,
            ..StrainRatio::given(m.strain_ratios.total[0])
        },
        solid_fraction: Some(Measured::exact(m.solid_fraction[0])),
        stress_ratio: Some(Measured::exact(0.0)),
        size_spread: Some(0.0),
        material: Some(material),
        ..Conditions::at(m.pressure)
    };
    let mut whole = 0;
    for (i, model) in grainlab_emt::models().iter().enumerate() {
        let of = |answer: Answer| answer.message.estimates.into_iter().nth(i).unwrap();
        let answer = |moduli: &Moduli| of(microstructure_of_moduli(moduli, &Settings::default()));
        let calibration = Calibration::builtin(&answer(&m).calibration).unwrap();
        let mut structure = Microstructure::default();
        for (q, range) in InferredQuantity::ALL.into_iter().zip(model.domain(calibration).structure) {
            if range.is_some() {
                structure = structure.with(q, assumed[q as usize]);
            }
        }
        let predicted = model.predict(&structure, &conditions, calibration).unwrap();
        let get = |modulus| predicted.get(modulus).unwrap_or_default();
        let [g12, g13, _, c11, c33, c13] = Modulus::ALL.map(get);
        let one = |modulus| predicted.get(modulus).into_iter().collect();
        let [of_g12, of_g13, theta] = [Modulus::G12, Modulus::G13, Modulus::Theta].map(one);
        let e = if predicted.known().count() == 6 {
            whole += 1;
            let t = TransverseIsotropy { c11, c12: c11 - 2.0 * g12, c13, c33, g13, g12, residual: 0.0 };
            let packing = message(&report_of(&t.stiffness()));
            of(microstructure_of_report(&packing, &Settings::default()))
        } else {
            answer(&Moduli { g12: of_g12, g13: of_g13, theta, ..m.clone() })
        };
        let found = [&e.k, &e.k_hat, &e.z, &e.eps, &e.eps_stiffness];
        for q in InferredQuantity::ALL {
            let Some(given) = structure.get(q) else { continue };
            assert!((found[q as usize][0] - given).abs() < 1e-6, "{} {q}: {given} {e:?}", model.name());
        }
    }
    assert!(whole > 0, "our own model takes the whole stiffness");
}

#[test]
fn the_uncertainty_is_that_of_the_model_and_of_the_data_else_of_the_parameter() {
    let assumed = corrected(&s1(), &with_error(0.01));
    assert!(assumed.covariance[0] > 0.0 && assumed.credible_level == 0.95);
    assert!(assumed.interval[0] < assumed.k[0] && assumed.k[0] < assumed.interval[1]);
    let exact = corrected(&s1(), &with_error(0.0));
    assert_eq!(exact.covariance, exact.covariance_model, "the error of the model alone");
    assert_eq!(exact.covariance_model, assumed.covariance_model);
    assert_eq!(exact.k, assumed.k);
    let mut measured = Moduli { covariance: vec![0.0; 9], ..s1() };
    for (place, modulus) in [(0, measured.g12[0]), (4, measured.g13[0]), (8, measured.theta[0])] {
        measured.covariance[place] = (0.02 * modulus).powi(2);
    }
    // Twice the error, four times the variance, whatever the parameter; the propagation is linear.
    let measured = corrected(&measured, &with_error(0.3));
    assert!((of_data(&measured, 0) / of_data(&assumed, 0) - 4.0).abs() < 1e-9);
}

#[test]
fn an_estimate_names_the_strain_ratio_it_used() {
    let of = |change: fn(&mut Moduli)| {
        let mut moduli = s1();
        change(&mut moduli);
        let e = corrected(&moduli, &Settings::default());
        (e.gamma_over_delta, e.gamma_over_delta_source)
    };
    assert_eq!(of(|_| ()), (vec![-0.0623], "total".into()));
    assert_eq!(of(|m| m.strain_ratios.total.clear()), (vec![-0.02], "contact".into()));
    let unknown = |m: &mut Moduli| m.strain_ratios = msg::StrainRatios::default();
    assert_eq!(of(unknown), (vec![0.0], "zero".into()));
}

#[test]
fn data_without_a_solution_have_a_reason_and_no_values() {
    let of = |change: fn(&mut Moduli)| {
        let mut moduli = s1();
        change(&mut moduli);
        let e = corrected(&moduli, &Settings::default());
        assert!(e.k.is_empty() && e.k_hat.is_empty() && e.eps.is_empty() && e.covariance.is_empty());
        assert_eq!(e.information, [0.0; 65]);
        assert_eq!(e.warnings.len(), 1);
        (e.status, e.warnings[0].clone())
    };
    let (status, why) = of(|m| m.g12.clear());
    assert!(status == Estimate::STATUS_UNKNOWN && why.contains("G12"), "{status} {why}");
    let (status, why) = of(|m| m.g12 = vec![-1e8]);
    assert!(status == Estimate::STATUS_UNKNOWN && why.contains("G12"), "{status} {why}");
    let (status, why) = of(|m| m.pressure = 0.0);
    assert!(status == Estimate::STATUS_UNKNOWN && why.contains("pressure"), "{status} {why}");
    let (status, why) = of(|m| m.g13 = vec![2.5 * m.g12[0]]);
    assert!(status == Estimate::STATUS_UNKNOWN && why.contains("G13/G12"), "{status} {why}");
    let (status, why) = of(|m| m.theta = vec![10e6]);
    assert!(status == Estimate::STATUS_UNKNOWN && why.contains("G12/Theta"), "{status} {why}");
}

#[test]
fn a_modulus_that_is_missing_leaves_the_rest_known() {
    let whole = corrected(&s1(), &Settings::default());
    let e = corrected(&Moduli { theta: vec![], solid_fraction: vec![], ..s1() }, &Settings::default());
    assert_eq!(
        (e.status, !e.k.is_empty(), !e.k_hat.is_empty(), !e.eps.is_empty()),
        (Estimate::STATUS_EXTRAPOLATED, false, false, true)
    );
    assert_eq!((&e.eps, e.covariance[18]), (&whole.eps, whole.covariance[18]));
    assert_eq!((e.interval[0], e.interval[6] < e.eps[0]), (0.0, true));
    // A covariance of a missing modulus is ignored.
    let mut measured = Moduli { theta: vec![], ..s1() };
    measured.covariance = vec![1e12, 0.0, 4e11, 0.0, 1e12, 0.0, 4e11, 0.0, 1e12];
    let measured = corrected(&measured, &Settings::default());
    assert!(!measured.eps.is_empty() && measured.covariance[18] > 0.0 && measured.k.is_empty());
}

#[test]
fn of_a_full_stiffness_the_error_is_that_of_five_moduli_and_theta_follows() {
    let (three, six) = (corrected(&s1(), &with_error(0.01)), of_packing(&s1_stiffness(), &with_error(0.01)));
    assert!((six.k[0] - three.k[0]).abs() < 1e-9 && (six.eps[0] - three.eps[0]).abs() < 1e-12);
    // ε needs only G12 and G13. Θ depends mostly on C11, and has a larger error than a measured Θ.
    assert!((of_data(&six, 18) / of_data(&three, 18) - 1.0).abs() < 1e-6);
    let of_k_hat = |e: &Estimate| of_data(e, 6) / of_data(&three, 6);
    assert!(of_k_hat(&six) > 1.1 && of_k_hat(&six) < 1.3, "{}", of_k_hat(&six));
}

#[test]
fn the_answer_to_a_packing_without_a_stiffness_has_no_estimate() {
    let elasticity = Err(NoStiffness::Floppy { contacts: 3 });
    let floppy = message(&PackingReport { elasticity, ..s1_stiffness() });
    for (report, has_estimates) in [(floppy, false), (message(&s1_stiffness()), true)] {
        let Answer { message, refused } = microstructure_of_report(&report, &Settings::default());
        assert_eq!((message.source.as_str(), message.source_step, refused), ("packing_report", 42, None));
        assert_eq!(!message.estimates.is_empty(), has_estimates);
    }
}

/// S1 rotated: its axis e3 is now along this axis.
fn turned(axis: Vec3) -> PackingReport {
    let turn = Rotation3::rotation_between(&Vec3::z(), &axis).unwrap();
    let mut report = report_of(&s1_medium().rotated(turn.matrix()));
    report.fabric.principal_axis.direction = axis;
    report.strain_ratios = StrainRatios::default();
    report
}

#[test]
fn a_rotated_sample_is_inverted_about_the_axis_found_or_given() {
    let axis = Vec3::new(0.6, -0.48, 0.64);
    let zero = PackingReport { strain_ratios: StrainRatios::default(), ..s1_stiffness() };
    let upright = of_packing(&zero, &Settings::default());
    for about in [Axis::Found, Axis::Given(axis), Axis::Given(-axis)] {
        let e = of_packing(&turned(axis), &Settings { axis: about, ..Settings::default() });
        assert!(
            (e.k[0] - upright.k[0]).abs() < 1e-6 && (e.eps[0] - upright.eps[0]).abs() < 1e-9,
            "{about:?} {e:?}"
        );
        assert!(!e.warnings.iter().any(|w| w.contains("not isotropic")), "{:?}", e.warnings);
    }
    let about_e3 = of_packing(&turned(axis), &Settings::default());
    assert!((about_e3.eps[0] - upright.eps[0]).abs() > 0.02, "{}", about_e3.eps[0]);
}

#[test]
fn the_strain_ratio_turns_with_the_axis() {
    let about = |axis: Vec3| {
        of_packing(&s1_stiffness(), &Settings { axis: Axis::Given(axis), ..Settings::default() })
            .gamma_over_delta[0]
    };
    // For a strain symmetric about e3, γ about e1 is −1/2 of that about e3, and zero at the magic angle.
    assert_eq!(about(Vec3::z()), -0.0623);
    assert!((about(Vec3::x()) - 0.5 * 0.0623).abs() < 1e-15);
    assert!(about(Vec3::new(1.0, 1.0, 1.0).normalize()).abs() < 1e-15);
}

/// S1 rotated and measured about its axis: moduli and strain ratio are those of S1, and are not transformed.
#[test]
fn moduli_and_strain_ratio_about_another_axis_are_taken_as_they_are() {
    let axis = Vec3::new(0.6, -0.48, 0.64);
    let upright = of_packing(&s1_stiffness(), &Settings::default());
    let mut lying = turned(axis);
    lying.fabric.reference_axis = axis;
    lying.strain_ratios = s1_stiffness().strain_ratios;
    for about in [Axis::Stated, Axis::Found, Axis::Given(axis), Axis::Given(-axis)] {
        let e = of_packing(&lying, &Settings { axis: about, ..Settings::default() });
        assert_eq!(e.gamma_over_delta, [-0.0623], "{about:?}");
        assert!(
            (e.k[0] - upright.k[0]).abs() < 1e-6 && (e.eps[0] - upright.eps[0]).abs() < 1e-9,
            "{about:?} {e:?}"
        );
    }
    // Without a stiffness no transformation is possible, and the results are the same.
    let three = Moduli { reference_axis: Vector3 { x: axis.x, y: axis.y, z: axis.z }, ..s1() };
    let e = corrected(&three, &Settings::default());
    assert_eq!(e.eps, corrected(&s1(), &Settings::default()).eps);
    for about in [Axis::E3, Axis::Given(Vec3::x())] {
        let settings = Settings { axis: about, ..Settings::default() };
        for e in [of_packing(&lying, &settings), corrected(&three, &settings)] {
            assert_eq!((e.status, !e.k.is_empty()), (Estimate::STATUS_UNKNOWN, false));
            let why = e.warnings.join("; ");
            assert!(why.contains("are about (0.6000, -0.4800, 0.6400)") && why.contains("stated"), "{why}");
        }
    }
}

#[test]
fn moduli_that_cannot_be_turned_to_an_axis_leave_it_undetermined() {
    let e = corrected(&s1(), &Settings { axis: Axis::Given(Vec3::x()), ..Settings::default() });
    assert_eq!(
        (e.status, !e.k.is_empty(), e.gamma_over_delta_source.as_str()),
        (Estimate::STATUS_UNKNOWN, false, "zero")
    );
    let why = e.warnings.join("; ");
    assert!(why.contains("(1.0000, 0.0000, 0.0000)"), "{why}");
    for axis in [Axis::Given(-Vec3::z()), Axis::Found] {
        let e = corrected(&s1(), &Settings { axis, ..Settings::default() });
        assert_eq!(e, corrected(&s1(), &Settings::default()), "an axis has no direction");
    }
}

#[test]
fn what_is_sent_crosses_every_check_of_a_reader() {
    for scale in [1e-200, 1e-9, 1.0, 1e9, 1e200] {
        let odd = message(&report_of(&Stiffness(s1_medium().0 * scale)));
        let message = microstructure_of_report(&odd, &Settings::default()).message;
        assert!(message.results().is_ok(), "{scale}: {message:?}");
    }
}
