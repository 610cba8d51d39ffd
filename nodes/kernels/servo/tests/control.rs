//! One request, one response.

use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
use grainlab_servo::{ServoInput, control, critical_gain};
use proptest::prelude::*;

const TANGENT: [f64; 6] = [200.0e6, 200.0e6, 200.0e6, 70.0e6, 70.0e6, 70.0e6];
const SCALED: ServoLaw = ServoLaw::Scaled { response_time: 1.0e-4 };
const EQ_1: ServoLaw = ServoLaw::Integral { gain: 1.0e-6, leak: 0.0 };
const NORMALISED: ServoLaw = ServoLaw::Normalised { share: 0.3, leak: 0.0 };

/// Every component at its stress target of 50 kPa (diagonal) or 0, with a tangent of 200 and 70 MPa.
fn at_target(law: ServoLaw) -> ServoInput {
    ServoInput {
        stress: SymTensor::isotropic(50.0e3),
        controls: std::array::from_fn(|i| ComponentControl::Stress(if i < 3 { 50.0e3 } else { 0.0 })),
        rate: [0.0; 6],
        rate_limit: 2.0,
        law,
        tangent: Some(TANGENT),
        control_interval: 2.0e-8,
    }
}

#[test]
fn every_law_compresses_towards_50_kpa_from_below_and_extends_from_above() {
    for law in [SCALED, EQ_1, NORMALISED] {
        let mut request = at_target(law);
        assert_eq!(control(&request).unwrap().rate, [0.0; 6]);
        request.stress = SymTensor::isotropic(49.0e3);
        assert!(control(&request).unwrap().rate[..3].iter().all(|&r| r < 0.0));
        request.stress = SymTensor::isotropic(51.0e3);
        assert!(control(&request).unwrap().rate[..3].iter().all(|&r| r > 0.0));
    }
}

/// dσ_xy = −2 C_xyxy dE_xy: a shear target is met within one response time only if the factor 2 is in the law.
#[test]
fn scaled_rate_removes_the_error_in_one_response_time_on_and_off_the_diagonal() {
    let mut request = at_target(SCALED);
    request.stress = SymTensor { xx: 50.0e3, yy: 50.0e3, zz: 52.0e3, yz: 0.0, xz: 0.0, xy: 1.0e3 };
    let rate = control(&request).unwrap().rate;
    assert!((rate[2] * 1.0e-4 * 200.0e6 - 2.0e3).abs() < 1e-9);
    assert!((2.0 * rate[5] * 1.0e-4 * 70.0e6 - 1.0e3).abs() < 1e-9);
}

#[test]
fn eq_1_adds_gain_times_error_to_the_rate_in_force_and_leaks() {
    let mut request = at_target(EQ_1);
    request.stress.zz = 51.0e3;
    request.rate[2] = 0.5;
    assert!((control(&request).unwrap().rate[2] - 0.501).abs() < 1e-15);
    request.law = ServoLaw::Integral { gain: 1.0e-6, leak: 0.1 };
    assert!((control(&request).unwrap().rate[2] - 0.451).abs() < 1e-15);
}

/// All three normal components servoed: K = 200 + 2 (200 − 2·70) MPa; a shear alone: K = 2·70 MPa.
#[test]
fn the_normalised_law_is_eq_1_with_its_share_of_the_critical_gain_of_each_component() {
    let mut request = at_target(ServoLaw::Normalised { share: 0.3, leak: 0.1 });
    request.rate_limit = 1.0e6;
    request.stress.zz = 51.0e3;
    request.stress.xy = 1.0e3;
    request.rate[2] = 0.5;
    let rate = control(&request).unwrap().rate;
    let kick = |k: f64| 0.3 * 3.8 / (k * 2.0e-8) * 1.0e3;
    assert!((rate[2] - (0.45 + kick(320.0e6))).abs() < 1e-9 * rate[2]);
    assert!((rate[5] - kick(140.0e6)).abs() < 1e-9 * rate[5]);
    let gain = critical_gain(&TANGENT, &request.controls, request.control_interval, 0.1);
    assert!((0.3 * gain * 1.0e3 - kick(320.0e6)).abs() < 1e-9 * kick(320.0e6));
}

#[test]
fn without_a_tangent_only_the_integral_law_answers() {
    for law in [SCALED, NORMALISED] {
        let request = ServoInput { tangent: None, ..at_target(law) };
        assert!(control(&request).unwrap_err().to_string().contains("tangent stiffness"));
        let held = ServoInput { controls: [ComponentControl::Held; 6], ..request };
        assert_eq!(control(&held).unwrap().rate, [0.0; 6]);
    }
    let mut request = at_target(EQ_1);
    request.stress.zz = 51.0e3;
    let known = control(&request).unwrap();
    assert_eq!(control(&ServoInput { tangent: None, ..request }).unwrap(), known);
}

#[test]
fn without_contacts_or_targets_no_gain_is_critical() {
    let request = at_target(EQ_1);
    assert_eq!(critical_gain(&[0.0; 6], &request.controls, 1.0e-6, 0.0), f64::INFINITY);
    assert_eq!(critical_gain(&TANGENT, &[ComponentControl::Held; 6], 1.0e-6, 0.0), f64::INFINITY);
}

#[test]
fn a_gain_of_eq_1_from_the_critical_one_on_is_refused_with_both_named() {
    let mut request = at_target(EQ_1);
    let critical = critical_gain(&TANGENT, &request.controls, request.control_interval, 0.0);
    request.law = ServoLaw::Integral { gain: 0.999 * critical, leak: 0.0 };
    assert!(control(&request).is_ok());
    request.law = ServoLaw::Integral { gain: critical, leak: 0.0 };
    let error = control(&request).unwrap_err().to_string();
    assert!(error.contains("gain = ") && error.contains("control_period"), "{error}");
}

#[test]
fn rates_beyond_the_limit_are_cut_off_and_flagged_one_by_one() {
    let mut request = at_target(SCALED);
    request.stress.xx = 500.0e3;
    request.controls[1] = ComponentControl::StrainRate(-7.0);
    request.controls[3] = ComponentControl::StrainRate(1.5);
    let a = control(&request).unwrap();
    assert_eq!((a.rate[0], a.rate[1], a.rate[3]), (2.0, -2.0, 1.5));
    assert_eq!(a.saturated, [true, true, false, false, false, false]);
}

#[test]
fn held_components_do_not_move_whatever_their_stress_and_rate() {
    let mut request = at_target(EQ_1);
    request.controls = [ComponentControl::Held; 6];
    request.rate = [1.0; 6];
    request.stress = SymTensor::isotropic(1.0e9);
    assert_eq!(control(&request).unwrap().rate, [0.0; 6]);
}

#[test]
fn without_contacts_laws_that_use_the_stiffness_drive_at_the_limit_towards_the_target() {
    for law in [SCALED, NORMALISED] {
        let mut request = at_target(law);
        request.stress = SymTensor::default();
        request.tangent = Some([0.0; 6]);
        let a = control(&request).unwrap();
        assert_eq!(a.rate, [-2.0, -2.0, -2.0, 0.0, 0.0, 0.0]);
        assert_eq!(a.saturated, [true, true, true, false, false, false]);
    }
}

/// The error and K τ both overflow: ∞/∞ must not reach the simulation.
#[test]
fn errors_and_stiffnesses_beyond_the_largest_number_do_not_make_nan() {
    let mut request = at_target(ServoLaw::Scaled { response_time: 1.0e10 });
    request.stress.zz = f64::MAX;
    request.controls[2] = ComponentControl::Stress(-f64::MAX);
    request.tangent = Some([f64::MAX; 6]);
    assert_eq!(control(&request).unwrap().rate[2], 0.0);
}

#[test]
fn each_fault_has_its_own_error_and_names_the_value() {
    let shown = |change: &dyn Fn(&mut ServoInput)| {
        let mut request = at_target(SCALED);
        change(&mut request);
        control(&request).unwrap_err().to_string()
    };
    assert!(shown(&|r| r.stress.yz = f64::NAN).contains("stress[yz]"));
    assert!(shown(&|r| r.rate[5] = f64::INFINITY).contains("rate[xy]"));
    assert!(shown(&|r| r.tangent = Some([f64::NAN; 6])).contains("tangent[xx]"));
    assert!(shown(&|r| r.controls[2] = ComponentControl::StrainRate(f64::NAN)).contains("setpoint[zz]"));
    assert!(shown(&|r| r.tangent = Some([0.0, -1.0, 0.0, 0.0, 0.0, 0.0])).contains("tangent[yy] = -1e0"));
    assert!(shown(&|r| r.rate_limit = 0.0).contains("rate_limit = 0e0 1/s must be positive"));
    assert!(shown(&|r| r.rate_limit = f64::NAN).contains("rate_limit = NaN"));
    assert!(shown(&|r| r.control_interval = -1.0).contains("control_interval = -1e0 s must be positive"));
    assert!(
        shown(&|r| r.law = ServoLaw::Scaled { response_time: 0.0 }).contains("response_time = 0e0 s must")
    );
    let integral = |gain, leak| shown(&|r| r.law = ServoLaw::Integral { gain, leak });
    assert!(integral(0.0, 0.0).contains("gain = 0e0 1/(Pa s) must be positive"));
    assert!(integral(1.0, 1.5).contains("leak = 1.5"));
    assert!(integral(1.0, f64::NAN).contains("leak = NaN"));
    assert!(shown(&|r| r.control_interval = 2.0e-4).contains("is not below twice response_time"));
    let share = |share| shown(&|r| r.law = ServoLaw::Normalised { share, leak: 0.0 });
    assert!([0.0, 1.0, f64::NAN].into_iter().all(|s| share(s).contains("is outside (0, 1)")));
}

#[test]
fn a_phase_without_stress_targets_does_not_need_a_valid_law() {
    let mut request = at_target(ServoLaw::Scaled { response_time: 0.0 });
    request.controls = [ComponentControl::StrainRate(-1.0); 6];
    assert_eq!(control(&request).unwrap().rate, [-1.0; 6]);
}

#[test]
fn only_a_component_with_a_stress_target_is_the_servos_to_choose() {
    let mut request = at_target(SCALED);
    request.controls[1] = ComponentControl::Held;
    request.controls[2] = ComponentControl::StrainRate(-0.5);
    assert_eq!(request.allows(&[2.0, 0.0, -0.5, -1.0, 0.0, 0.1]), Ok(()));
    for (rate, reason) in [
        (
            [0.0, 0.0, -0.5, -2.1, 0.0, 0.0],
            "rate yz = -2.1 1/s is beyond the rate limit of the request, 2 1/s",
        ),
        ([0.0, 1e-6, -0.5, 0.0, 0.0, 0.0], "rate yy = 0.000001 1/s, where the request imposes 0 1/s"),
        ([0.0, 0.0, 0.5, 0.0, 0.0, 0.0], "rate zz = 0.5 1/s, where the request imposes -0.5 1/s"),
    ] {
        assert_eq!(request.allows(&rate).unwrap_err().to_string(), reason);
    }
}

fn component() -> impl Strategy<Value = ComponentControl> {
    prop_oneof![
        Just(ComponentControl::Held),
        any::<f64>().prop_map(ComponentControl::Stress),
        any::<f64>().prop_map(ComponentControl::StrainRate),
    ]
}

fn law() -> impl Strategy<Value = ServoLaw> {
    prop_oneof![
        any::<f64>().prop_map(|response_time| ServoLaw::Scaled { response_time }),
        (any::<f64>(), 0.0..=1.0f64).prop_map(|(gain, leak)| ServoLaw::Integral { gain, leak }),
        (1e-9..1.0f64, 0.0..=1.0f64).prop_map(|(share, leak)| ServoLaw::Normalised { share, leak }),
    ]
}

proptest! {
    /// `any::<f64>()` covers every normal and subnormal magnitude of both signs. Quantities that must not be
    /// negative take the magnitude, so that most requests are valid.
    #[test]
    fn any_answer_is_finite_within_the_limit_allowed_and_the_same_twice(
        stress in any::<[f64; 6]>(), rate in any::<[f64; 6]>(), tangent in any::<[f64; 6]>(),
        controls in prop::array::uniform6(component()), law in law(),
        rate_limit in any::<f64>(), control_interval in any::<f64>(),
    ) {
        let law = match law {
            ServoLaw::Scaled { response_time } => ServoLaw::Scaled { response_time: response_time.abs() },
            ServoLaw::Integral { gain, leak } => ServoLaw::Integral { gain: gain.abs(), leak },
            normalised => normalised,
        };
        let request = ServoInput {
            stress: SymTensor::from_voigt(stress), controls, rate, law,
            rate_limit: rate_limit.abs(),
            tangent: Some(tangent.map(f64::abs)),
            control_interval: control_interval.abs(),
        };
        let first = control(&request);
        prop_assert_eq!(&first, &control(&request));
        prop_assume!(first.is_ok());
        let a = first.unwrap();
        prop_assert_eq!(request.allows(&a.rate), Ok(()));
        for i in 0..6 {
            prop_assert!(a.rate[i].abs() <= request.rate_limit);
            prop_assert!(!a.saturated[i] || a.rate[i].abs() == request.rate_limit);
        }
    }
}
