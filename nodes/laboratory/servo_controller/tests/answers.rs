//! The servo node on the bus in memory.

use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::{to_cdr, topics};
use grainlab_node_kit::{
    Actor, Bus, Demand, Hub, Level, MemoryBus, Names, Node, Publisher, Statistics, Subscription, run_until,
};
use grainlab_servo::{ServoInput, ServoRequest};
use grainlab_servo_controller::{Refusal, ServoController, answer};
use std::time::Duration;

/// 10 kPa too little compression on zz, 200 MPa of tangent stiffness and 0.1 ms of response time: −0.5 per second.
fn question(sequence: u64) -> Stress {
    let mut controls = [ComponentControl::Held; 6];
    controls[2] = ComponentControl::Stress(50e3);
    Stress::try_from(&ServoRequest {
        sequence,
        step: 20 * sequence,
        phase: 3,
        time: 1e-6 * sequence as f64,
        input: ServoInput {
            stress: SymTensor::isotropic(40e3),
            controls,
            rate: [0.0; 6],
            rate_limit: 10.0,
            law: ServoLaw::Scaled { response_time: 1e-4 },
            tangent: Some([200e6; 6]),
            control_interval: 1e-6,
        },
        asymmetry: 0.0,
        strain: SymTensor::default(),
        solid_fraction: 0.64,
        coordination: 5.0,
        unbalanced: 1e-3,
    })
    .unwrap()
}

/// A simulator that only sends requests.
struct Asker {
    bus: MemoryBus,
    stress: Publisher<Stress>,
    strain_rate: Subscription<StrainRate>,
}

impl Asker {
    fn new(hub: &Hub) -> Self {
        let mut bus = hub.bus(Names::new("asker").unwrap());
        let stress = Publisher::advertise(&mut bus, &topics::STRESS).unwrap();
        let strain_rate =
            Subscription::subscribe(&mut bus, &topics::STRAIN_RATE, Demand::best_effort(64)).unwrap();
        Self { bus, stress, strain_rate }
    }

    fn answers(&mut self) -> Vec<StrainRate> {
        std::iter::from_fn(|| self.strain_rate.take_valid(&mut self.bus).unwrap()).map(|(a, _)| a).collect()
    }
}

#[test]
fn an_answer_carries_header_and_sequence_of_its_question() {
    let mut stress = question(7);
    stress.header.frame_id = "another".into();
    let answered = answer(&stress).unwrap();
    assert_eq!((&answered.header, answered.sequence), (&stress.header, 7));
    // Exact up to one division.
    assert!((answered.rate[2] + 0.5).abs() < 1e-15 && answered.rate[0] == 0.0);
}

#[test]
fn the_same_question_has_the_same_answer_from_any_servo_in_any_order() {
    let hub = Hub::new(1);
    let mut asker = Asker::new(&hub);
    for sequence in [3, 1, 3] {
        let mut bus = hub.bus(Names::new("servo_controller").unwrap());
        let servo = ServoController::new(&mut bus, 1).unwrap();
        let mut actors = [Actor::new(Box::new(servo), bus)];
        for sequence in [sequence, 2, sequence] {
            asker.stress.publish(&mut asker.bus, &question(sequence)).unwrap();
        }
        run_until(&hub, &mut actors, hub.now() + Duration::from_secs(1), |_| false);
        let answers = asker.answers();
        assert_eq!(answers.iter().map(|a| a.sequence).collect::<Vec<_>>(), [sequence, 2, sequence]);
        for a in &answers {
            assert_eq!(to_cdr(a), to_cdr(&answer(&question(a.sequence)).unwrap()));
        }
    }
}

#[test]
fn requests_that_cannot_be_answered_are_counted_and_the_node_continues() {
    let hub = Hub::new(1);
    let mut asker = Asker::new(&hub);
    let mut bus = hub.bus(Names::new("servo_controller").unwrap());
    let mut servo = ServoController::new(&mut bus, 1).unwrap();
    let not_finite = Stress {
        stress: grainlab_msgs::msg::SymmetricTensor { zz: f64::NAN, ..Default::default() },
        ..question(1)
    };
    // The law would overshoot: a response time of 0.1 ms with requests every 0.3 ms.
    let unstable = Stress { control_interval: 3e-4, ..question(2) };
    assert!(matches!(answer(&not_finite), Err(Refusal::Boundary(_))));
    assert!(matches!(answer(&unstable), Err(Refusal::Servo { sequence: 2, .. })));
    asker.stress.publish(&mut asker.bus, &not_finite).unwrap();
    asker.stress.publish(&mut asker.bus, &unstable).unwrap();
    asker.bus.publish(asker.stress.id(), &[0, 1, 0, 0, 9]).unwrap();
    servo.step(&mut bus).unwrap();
    assert!(asker.answers().is_empty());
    assert_eq!(bus.received()[0].refused, 2, "the unstable one is a message, and is not refused as such");
    let health = servo.health();
    assert_eq!(health.level, Level::Warn);
    assert!(health.message.contains("request 2"), "{}", health.message);
    asker.stress.publish(&mut asker.bus, &question(3)).unwrap();
    servo.step(&mut bus).unwrap();
    assert_eq!(asker.answers().len(), 1);
    assert_eq!(servo.health().level, Level::Ok);
    // Those between did not arrive: a player does not repeat them.
    asker.stress.publish(&mut asker.bus, &question(7)).unwrap();
    servo.step(&mut bus).unwrap();
    let health = servo.health();
    assert!(
        health.level == Level::Warn && health.message.contains("3 stresses did not arrive"),
        "{}",
        health.message
    );
}

#[test]
fn the_first_answer_waits_for_its_readers_and_no_later_one_does() {
    let hub = Hub::new(1);
    let mut asker = Asker::new(&hub);
    let mut bus = hub.bus(Names::new("servo_controller").unwrap());
    let mut servo = ServoController::new(&mut bus, 2).unwrap();
    for sequence in [1, 2] {
        asker.stress.publish(&mut asker.bus, &question(sequence)).unwrap();
        servo.step(&mut bus).unwrap();
    }
    assert!(asker.answers().is_empty(), "there is one reader");
    let late = Asker::new(&hub);
    servo.step(&mut bus).unwrap();
    assert_eq!(asker.answers().iter().map(|a| a.sequence).collect::<Vec<_>>(), [1, 2]);
    drop(late);
    asker.stress.publish(&mut asker.bus, &question(3)).unwrap();
    servo.step(&mut bus).unwrap();
    assert_eq!(asker.answers().len(), 1);
}
