use super::not_finite::refuses_non_finite;
use super::refuses;
use grainlab_core::notes::{Code, Note, Status};
use grainlab_core::results::{self, GammaUsed, InferredQuantity, Interval, Quantities};
use grainlab_msgs::boundary::estimate_message;
use grainlab_msgs::msg::{self, Estimate, Microstructure};
use grainlab_msgs::{from_cdr, to_cdr};

const NAN: f64 = f64::NAN;

/// A model that infers k, k̂ and ε, and not the other two.
fn estimate() -> Estimate {
    let mut e = Estimate {
        model: "ratio".into(),
        calibration: "paper".into(),
        status: Estimate::STATUS_OK,
        gamma_over_delta: vec![-0.0623],
        gamma_over_delta_source: "total".into(),
        k: vec![5.2],
        k_hat: vec![5.1],
        eps: vec![0.06],
        covariance: vec![0.0; 25],
        covariance_model: vec![0.0; 25],
        interval: vec![5.1, 5.3, 4.9, 5.3, 0.0, 0.0, 0.05, 0.07, 0.0, 0.0],
        credible_level: 0.68,
        chi_square: 1.5,
        degrees_of_freedom: 2,
        condition_number: vec![12.0],
        ..Estimate::default()
    };
    for (at, variance) in [(0, 0.01), (6, 0.04), (18, 1e-4)] {
        e.covariance[at] = variance;
        e.covariance_model[at] = 0.5 * variance;
    }
    (e.covariance[1], e.covariance[5]) = (0.004, 0.004);
    // ε: contributions of G12 and G13, reduced by their correlation.
    let of_eps = 3 * grainlab_core::results::INFERENCE_INPUTS.len();
    (e.information[of_eps], e.information[of_eps + 1], e.information[of_eps + 2]) = (0.75, 0.5, -0.25);
    e
}

fn message(estimates: Vec<Estimate>) -> Microstructure {
    Microstructure { source: "moduli".into(), estimates, ..Microstructure::default() }
}

fn read(estimate: Estimate) -> results::Estimate {
    let received: Microstructure = from_cdr(&to_cdr(&message(vec![estimate]))).unwrap();
    received.results().unwrap().remove(0)
}

#[test]
fn an_estimate_has_none_where_the_model_gives_no_value() {
    let e = read(estimate());
    assert_eq!((e.model.as_str(), e.calibration.as_str(), e.status), ("ratio", "paper", Status::Ok));
    assert_eq!(e.gamma, Some(GammaUsed { value: -0.0623, source: "total" }));
    assert_eq!(e.values.0, [Some(5.2), Some(5.1), None, Some(0.06), None]);
    let each = InferredQuantity::ALL;
    assert_eq!(each.map(|q| e.sigma(q)), [Some(0.1), Some(0.2), None, Some(0.01), None]);
    let variances = each.map(|q| e.sigma_model(q).map(|s| s * s));
    assert_eq!(variances, [Some(0.005), Some(0.02), None, Some(5e-5), None]);
    let bounds = Quantities([Some([5.1, 5.3]), Some([4.9, 5.3]), None, Some([0.05, 0.07]), None]);
    assert_eq!(e.interval, Interval { level: Some(0.68), bounds });
    assert_eq!((e.chi_square, e.degrees_of_freedom, e.condition_number), (Some(1.5), Some(2), Some(12.0)));
}

#[test]
fn what_is_left_out_is_not_known_and_a_zero_is_zero() {
    let bare = Estimate { gamma_over_delta_source: "none".into(), eps: vec![0.0], ..Estimate::default() };
    let e = read(bare);
    assert_eq!((e.gamma, e.values.0), (None, [None, None, None, Some(0.0), None]));
    assert_eq!((e.covariance, e.covariance_model, e.interval), (None, None, Interval::default()));
    assert_eq!((e.chi_square, e.degrees_of_freedom, e.condition_number), (None, Some(0), None));
}

#[test]
fn each_quantity_is_read_from_its_own_field() {
    type Field = fn(&mut Estimate) -> &mut Vec<f64>;
    let fields: [Field; 5] =
        [|e| &mut e.k, |e| &mut e.k_hat, |e| &mut e.z, |e| &mut e.eps, |e| &mut e.eps_stiffness];
    for (i, field) in fields.into_iter().enumerate() {
        let mut e = Estimate { gamma_over_delta_source: "none".into(), ..Estimate::default() };
        field(&mut e).push(0.5);
        let expected: Vec<Option<f64>> = (0..5).map(|j| (j == i).then_some(0.5)).collect();
        assert_eq!(read(e.clone()).values.0.to_vec(), expected);
        field(&mut e)[0] = NAN;
        let refused = message(vec![e]).results().unwrap_err().to_string();
        assert_eq!(
            refused,
            format!("Estimate.{} = NaN is refused: it must be finite", InferredQuantity::ALL[i].name())
        );
    }
}

#[test]
fn an_estimate_has_values_unless_it_is_unknown() {
    for (status, expected) in [
        (Estimate::STATUS_EXTRAPOLATED, Status::Extrapolated),
        (Estimate::STATUS_CONTRADICTORY, Status::Contradictory),
    ] {
        let e = read(Estimate { status, ..estimate() });
        assert_eq!((e.status, e.values.0[0]), (expected, Some(5.2)));
    }
    let e = read(Estimate { status: Estimate::STATUS_UNKNOWN, k: vec![NAN], ..estimate() });
    assert_eq!((e.status, e.values, e.degrees_of_freedom), (Status::Unknown, Quantities::default(), None));
    assert!(e.gamma.is_some_and(|gamma| gamma.value == -0.0623), "what it was fed with stays");
}

#[test]
fn an_estimate_crosses_the_wire_and_back_with_its_notes() {
    let mut sent = read(estimate());
    sent.add_notes(&[Note::grains_unknown(), Note::state_outside_calibration("p/E*", 1e-3, 1e-7, 1.6e-4)]);
    assert!(sent.status == Status::Extrapolated && sent.notes[0].is(Code::StateOutsideCalibration));
    let message = estimate_message(&sent);
    assert!(message.warnings[0].starts_with("p/E* = 1.00e-3 is outside"), "{:?}", message.warnings);
    assert_eq!(read(message), sent);
}

/// Recordings of versions 0.2.0 and before.
#[test]
fn sentences_without_notes_are_notes_the_first_of_which_is_the_reason_of_the_status() {
    let warnings = vec!["far".to_owned(), "and old".to_owned()];
    let e = read(Estimate { status: Estimate::STATUS_EXTRAPOLATED, warnings, ..estimate() });
    let severities: Vec<_> = e.notes.iter().map(|note| (note.severity(), note.to_string())).collect();
    assert_eq!(severities, [(Status::Extrapolated, "far".to_owned()), (Status::Ok, "and old".to_owned())]);
    let silent = read(Estimate { status: Estimate::STATUS_CONTRADICTORY, ..estimate() });
    assert_eq!((silent.status, silent.notes.len()), (Status::Contradictory, 0));
}

#[test]
fn each_fault_of_an_estimate_is_refused_by_name() {
    refuses_non_finite(&message(vec![estimate()]), &[], |m| m.results());
    refuses(
        &message(vec![estimate()]),
        &[
            (|m| m.estimates[0].status = 4, "Estimate.status = 4 is refused: it must be one of 0 (ok)"),
            (
                |m| m.estimates[0].notes = vec![msg::Note { severity: 4, ..msg::Note::default() }],
                "Estimate.notes[0].severity = 4 is refused: it must be one of 0 (ok)",
            ),
            (
                |m| m.estimates[0].notes = vec![msg::Note { severity: 1, ..msg::Note::default() }],
                "Estimate.status = ok is refused: it must be the worst status of the notes",
            ),
            (
                |m| m.estimates[0].gamma_over_delta_source = "plastic".into(),
                "Estimate.gamma_over_delta_source = \"plastic\" is refused: it must be one of total, elastic",
            ),
            (
                |m| m.estimates[0].gamma_over_delta_source = "none".into(),
                "Estimate.gamma_over_delta has 1 entries and is refused: it must have 0 (one strain ratio",
            ),
            (
                |m| {
                    m.estimates[0] =
                        Estimate { gamma_over_delta_source: "none".into(), ..Estimate::default() }
                },
                "Estimate.number of known quantities = 0.0 is refused: it must be 1 or more",
            ),
            (|m| m.estimates[0].covariance[18] = -1.0, "Estimate.covariance[18] = -1.0 is refused"),
            (
                |m| m.estimates[0].covariance[5] = 0.003,
                "Estimate.covariance[5] = 0.003 is refused: it must be symmetric",
            ),
            (
                |m| m.estimates[0].covariance[12] = 0.01,
                "Estimate.covariance[12] = 0.01 is refused: it must be 0, because its quantity is not known",
            ),
            (
                |m| m.estimates[0].covariance_model[24] = 0.01,
                "Estimate.covariance_model[24] = 0.01 is refused: it must be 0, because",
            ),
            (
                |m| m.estimates[0].covariance_model[0] = 0.02,
                "Estimate.covariance_model[0] = 0.02 is refused: it must be at most the same entry",
            ),
            (
                |m| m.estimates[0].interval[6] = 0.08,
                "Estimate.interval[6] = 0.08 is refused: it must be at most",
            ),
            (|m| m.estimates[0].interval[5] = 1.0, "Estimate.interval[4] = 0.0 is refused: it must be 0 as"),
            (|m| m.estimates[0].credible_level = 68.0, "Estimate.credible_level = 68.0 is refused"),
            (|m| m.estimates[0].chi_square = -1.0, "Estimate.chi_square = -1.0 is refused"),
            (
                |m| m.estimates[0].degrees_of_freedom = 0,
                "Estimate.chi_square = 1.5 is refused: it must be 0 where degrees_of_freedom is 0",
            ),
            (|m| m.estimates[0].condition_number[0] = 0.5, "Estimate.condition_number = 0.5 is refused"),
            (
                |m| m.estimates[0].information[28] = 1.0,
                "Estimate.information[28] = 1.0 is refused: it must be 0, because",
            ),
            (
                |m| m.estimates[0].information[43] = 0.5,
                "Estimate.sum of information[39..52] = 1.5 is refused: it must be 1",
            ),
        ],
        |m| m.results(),
    );
}
