use crate::s1;
use crate::speeds::upright;
use grainlab_emt_inversion::{EmtInversion, Settings, microstructure_of_moduli, microstructure_of_speeds};
use grainlab_msgs::msg::{Microstructure, Moduli, WaveSpeeds};
use grainlab_msgs::topics;
use grainlab_node_kit::{Demand, Hub, Level, Names, Node, Publisher, RosArgs, Statistics, Subscription};

#[test]
fn a_latched_set_of_moduli_is_inverted_by_a_node_that_comes_late_and_a_refused_one_is_answered() {
    let hub = Hub::new(1);
    let mut bus = hub.bus(Names::new("source").unwrap());
    let source: Publisher<Moduli> = Publisher::advertise(&mut bus, &topics::MODULI).unwrap();
    let found: Subscription<Microstructure> =
        Subscription::subscribe(&mut bus, &topics::MICROSTRUCTURE, Demand::reliable(8)).unwrap();
    source.publish(&mut bus, &s1()).unwrap();
    let mut node_bus = hub.bus(Names::new("emt_inversion").unwrap());
    let mut node = EmtInversion::new(&mut node_bus, Settings::default()).unwrap();
    node.step(&mut node_bus).unwrap();
    let (message, _) = found.take_valid(&mut bus).unwrap().unwrap();
    assert_eq!(message, microstructure_of_moduli(&s1(), &Settings::default()).message);
    source.publish(&mut bus, &Moduli { g12: vec![f64::NAN], ..s1() }).unwrap();
    node.step(&mut node_bus).unwrap();
    let (refusal, _) = found.take_valid(&mut bus).unwrap().unwrap();
    assert!(refusal.estimates.iter().all(|e| e.warnings[0].contains("g12 = NaN is refused")), "{refusal:?}");
    assert_eq!((node_bus.received()[1].refused, node.health().level), (1, Level::Warn));
    source.publish(&mut bus, &s1()).unwrap();
    node.step(&mut node_bus).unwrap();
    assert_eq!(found.take_valid(&mut bus).unwrap().map(|(m, _)| m), Some(message));
}

#[test]
fn moduli_and_the_wave_speeds_of_a_remapped_instrument_are_answered_side_by_side() {
    let hub = Hub::new(1);
    let mut instrument = hub.bus(Names::in_namespace("source", "/instrument").unwrap());
    let mut lab = hub.bus(Names::new("analyzer").unwrap());
    let speeds: Publisher<WaveSpeeds> = Publisher::advertise(&mut instrument, &topics::WAVE_SPEEDS).unwrap();
    let moduli: Publisher<Moduli> = Publisher::advertise(&mut lab, &topics::MODULI).unwrap();
    let found: Subscription<Microstructure> =
        Subscription::subscribe(&mut lab, &topics::MICROSTRUCTURE, Demand::reliable(8)).unwrap();
    let settings = Settings::default();
    let remap = ["--ros-args", "-r", "wave_speeds:=/instrument/wave_speeds"].map(String::from);
    let (remapped, _) = RosArgs::parse(&remap).unwrap();
    let start = |names| {
        let mut bus = hub.bus(names);
        (EmtInversion::new(&mut bus, settings.clone()).unwrap(), bus)
    };
    let (mut node, mut bus) = start(Names::from_args("emt_inversion", &remapped).unwrap());
    speeds.publish(&mut instrument, &upright()).unwrap();
    moduli.publish(&mut lab, &s1()).unwrap();
    node.step(&mut bus).unwrap();
    let mut answers = Vec::new();
    while let Some((answer, _)) = found.take_valid(&mut lab).unwrap() {
        answers.push(answer);
    }
    let expected = [
        microstructure_of_moduli(&s1(), &settings).message,
        microstructure_of_speeds(&upright(), &settings).message,
    ];
    assert_eq!(answers, expected);
    // An invalid message is answered, and counted on its topic.
    speeds.publish(&mut instrument, &WaveSpeeds { density: 0.0, ..upright() }).unwrap();
    node.step(&mut bus).unwrap();
    let refused: Vec<(String, u64)> = bus.received().into_iter().map(|r| (r.topic, r.refused)).collect();
    let expected = [("/packing_report", 0), ("/moduli", 0), ("/instrument/wave_speeds", 1)];
    assert_eq!(refused, expected.map(|(topic, count)| (topic.to_owned(), count)));
    assert_eq!(node.health().level, Level::Warn);
    // Without the remap no message of the instrument arrives.
    drop((node, bus));
    let (mut other, mut bus) = start(Names::new("emt_inversion").unwrap());
    other.step(&mut bus).unwrap();
    assert_eq!(bus.received().iter().map(|r| r.taken).collect::<Vec<_>>(), [0, 1, 0]);
}

#[test]
fn a_burst_of_shots_is_inverted_whole_and_what_is_lost_of_a_longer_one_is_counted() {
    let hub = Hub::new(1);
    let mut bus = hub.bus(Names::new("source").unwrap());
    let source: Publisher<WaveSpeeds> = Publisher::advertise(&mut bus, &topics::WAVE_SPEEDS).unwrap();
    let found: Subscription<Microstructure> =
        Subscription::subscribe(&mut bus, &topics::MICROSTRUCTURE, Demand::reliable(4000)).unwrap();
    let mut node_bus = hub.bus(Names::new("emt_inversion").unwrap());
    let mut node = EmtInversion::new(&mut node_bus, Settings::default()).unwrap();
    // Refused data are answered at once.
    let mut burst = |shots: usize| {
        for n in 0..shots {
            let shot = WaveSpeeds { name: format!("shot {n}"), density: 0.0, ..upright() };
            source.publish(&mut bus, &shot).unwrap();
        }
        node.step(&mut node_bus).unwrap();
        let answers = std::iter::from_fn(|| found.take_valid(&mut bus).unwrap()).count();
        let missed = node.health().value("missed").unwrap().to_owned();
        (answers, missed)
    };
    assert_eq!(burst(200), (200, "0".into()));
    assert_eq!(burst(1030), (1024, "6".into()));
}
