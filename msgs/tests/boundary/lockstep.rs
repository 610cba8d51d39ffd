use super::not_finite::refuses_non_finite;
use super::{refuses, refuses_values};
use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{from_cdr, simulated_seconds, stamp, to_cdr};
use grainlab_servo::{ServoInput, ServoRequest};
use proptest::array::uniform6;
use proptest::option;
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;
const NAN: f64 = f64::NAN;

fn finite() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("finite", |x| x.is_finite())
}

fn control() -> impl Strategy<Value = ComponentControl> {
    prop_oneof![
        Just(ComponentControl::Held),
        finite().prop_map(ComponentControl::Stress),
        finite().prop_map(ComponentControl::StrainRate),
    ]
}

fn law() -> impl Strategy<Value = ServoLaw> {
    prop_oneof![
        (1e-9..1e9f64).prop_map(|response_time| ServoLaw::Scaled { response_time }),
        (0.0..1e9f64, 0.0..=1.0f64).prop_map(|(gain, leak)| ServoLaw::Integral { gain, leak }),
        (1e-9..1.0f64, 0.0..=1.0f64).prop_map(|(share, leak)| ServoLaw::Normalised { share, leak }),
    ]
}

prop_compose! {
    fn request()(
        (sequence, step, phase, time) in (any::<u64>(), any::<u64>(), any::<u32>(), 0.0..1e6f64),
        (stress, strain, tangent, rate) in (uniform6(finite()), uniform6(finite()), option::of(uniform6(finite())), uniform6(finite())),
        (controls, law) in (uniform6(control()), law()),
        (rate_limit, control_interval, solid_fraction) in (0.0..1e9f64, 1e-12..1.0f64, 0.01..1.0f64),
        (asymmetry, coordination, unbalanced) in (0.0..1e9f64, 0.0..12.0f64, 0.0..9.0f64),
    ) -> ServoRequest {
        ServoRequest {
            // Times of a whole number of nanoseconds.
            sequence, step, phase, time: simulated_seconds(&stamp(time)),
            input: ServoInput {
                stress: SymTensor::from_voigt(stress), controls, rate, rate_limit, law, tangent, control_interval,
            },
            asymmetry, strain: SymTensor::from_voigt(strain), solid_fraction, coordination, unbalanced,
        }
    }
}

proptest! {
    #[test]
    fn a_request_crosses_the_wire_and_back_bit_for_bit(request in request()) {
        let bytes = to_cdr(&Stress::try_from(&request).unwrap());
        let back = ServoRequest::try_from(&from_cdr::<Stress>(&bytes).unwrap()).unwrap();
        prop_assert_eq!(&back, &request);
        prop_assert_eq!(to_cdr(&Stress::try_from(&back).unwrap()), bytes);
    }

    #[test]
    fn an_answer_crosses_the_wire_and_back(
        sequence in any::<u64>(), rate in uniform6(finite()), saturated in uniform6(any::<bool>()), time in 0.0..1e6f64,
    ) {
        let header = Header { stamp: stamp(time), frame_id: "cell".into() };
        let answer = StrainRate { header, sequence, rate, saturated };
        let back = from_cdr::<StrainRate>(&to_cdr(&answer)).unwrap();
        prop_assert_eq!(back.checked().unwrap(), &answer);
    }
}

fn stress() -> Stress {
    let request = ServoRequest {
        sequence: 3,
        step: 30,
        phase: 1,
        time: 0.5,
        input: ServoInput {
            stress: SymTensor::isotropic(5e4),
            controls: [ComponentControl::Stress(5e4); 6],
            rate: [0.0; 6],
            rate_limit: 1.0,
            law: ServoLaw::Scaled { response_time: 1e-3 },
            tangent: Some([4e8; 6]),
            control_interval: 1e-7,
        },
        asymmetry: 0.0,
        strain: SymTensor::default(),
        solid_fraction: 0.63,
        coordination: 5.2,
        unbalanced: 1e-3,
    };
    Stress::try_from(&request).unwrap()
}

#[test]
fn each_fault_of_a_request_is_refused_by_name() {
    refuses_non_finite(&stress(), &["gain", "leak"], |m| ServoRequest::try_from(m));
    refuses(
        &stress(),
        &[
            (|m| m.header.stamp.nanosec = u32::MAX, "Stress.header.stamp.nanosec = 4294967295.0 is refused"),
            (|m| m.asymmetry = -1.0, "Stress.asymmetry = -1.0 is refused: it must be finite and 0 or more"),
            (|m| m.mode[5] = 3, "Stress.mode[5] (xy) = 3 is refused: it must be one of 0 (held), 1 (stress)"),
            (
                |m| m.law = 3,
                "Stress.law = 3 is refused: it must be one of 0 (scaled), 1 (integral), 2 (normalised)",
            ),
            (
                |m| m.response_time = 0.0,
                "Stress.response_time = 0.0 is refused: it must be finite and more than 0",
            ),
            (|m| (m.law, m.leak) = (1, 1.5), "Stress.leak = 1.5 is refused: it must be between 0 and 1"),
            (|m| (m.law, m.gain) = (1, NAN), "Stress.gain = NaN is refused"),
            (|m| (m.law, m.gain) = (2, 0.0), "Stress.gain = 0.0 is refused"),
        ],
        |m| ServoRequest::try_from(m),
    );
    refuses_values!(&stress(), |m| ServoRequest::try_from(m), "Stress", m:
        m.rate_limit => -0.5,
        m.control_interval => 0.0,
        m.solid_fraction => 0.0,
        m.coordination => -1.0,
    );
}

#[test]
fn a_rate_that_is_not_finite_is_refused_with_its_component() {
    refuses(
        &StrainRate::default(),
        &[(|m| m.header.stamp.nanosec = 1_000_000_000, "StrainRate.header.stamp.nanosec")],
        |m| m.checked().cloned(),
    );
}

/// Messages that readers refuse are not written.
#[test]
fn invalid_messages_are_not_published() {
    let sound = ServoRequest::try_from(&stress()).unwrap();
    type Fault = fn(&mut ServoRequest);
    let faults: [(Fault, &str); 9] = [
        (|r| r.input.stress.zz = NAN, "stress.zz = NaN"),
        (|r| r.input.rate[1] = INF, "rate[1] (yy) = inf"),
        (|r| r.input.tangent = Some([NAN; 6]), "tangent.xx = NaN"),
        (|r| r.input.control_interval = INF, "control_interval = inf"),
        (|r| r.asymmetry = NAN, "asymmetry = NaN"),
        (|r| r.strain.xy = -INF, "strain.xy = -inf"),
        (|r| r.solid_fraction = NAN, "solid_fraction = NaN"),
        (|r| r.coordination = NAN, "coordination = NaN"),
        (|r| r.unbalanced = INF, "unbalanced_force_ratio = inf"),
    ];
    for (fault, found) in faults {
        let mut request = sound;
        fault(&mut request);
        let error = Stress::try_from(&request).unwrap_err().to_string();
        assert!(error.starts_with(&format!("Stress.{found}")), "{error}");
    }
    let answer = StrainRate { rate: [INF; 6], ..StrainRate::default() };
    assert!(answer.checked().unwrap_err().to_string().starts_with("StrainRate.rate[0] (xx) = inf"));
}
