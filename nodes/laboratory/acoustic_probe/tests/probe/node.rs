use crate::sample::{measurement, message};
use grainlab_acoustic_probe::{AcousticProbe, MeasureError, Settings, measure, messages};
use grainlab_core::Material;
use grainlab_core::notes::Code;
use grainlab_msgs::boundary::WaveSpeedsReading;
use grainlab_msgs::msg::{Packing, WaveSpeeds, Waveform};
use grainlab_msgs::{to_cdr, topics};
use grainlab_node_kit::{
    Bus, Demand, Hub, Level, MemoryBus, Names, Node, Publisher, Statistics, Subscription,
};
use grainlab_testkit::packings::{DIAMETER, OVERLAP, lattice};

/// A publisher of packings that receives the results.
struct Source {
    bus: MemoryBus,
    packings: Publisher<Packing>,
    speeds: Subscription<WaveSpeeds>,
    waveforms: Subscription<Waveform>,
}

impl Source {
    fn new(hub: &Hub) -> Self {
        let mut bus = hub.bus(Names::new("source").unwrap());
        let packings = Publisher::advertise(&mut bus, &topics::PACKING).unwrap();
        let speeds = Subscription::subscribe(&mut bus, &topics::WAVE_SPEEDS, Demand::reliable(8)).unwrap();
        let waveforms = Subscription::subscribe(&mut bus, &topics::WAVEFORM, Demand::reliable(8)).unwrap();
        Self { bus, packings, speeds, waveforms }
    }

    fn heard(&mut self) -> (Vec<WaveSpeeds>, Vec<Waveform>) {
        let speeds = std::iter::from_fn(|| Some(self.speeds.take_valid(&mut self.bus).unwrap()?.0)).collect();
        let waveforms =
            std::iter::from_fn(|| Some(self.waveforms.take_valid(&mut self.bus).unwrap()?.0)).collect();
        (speeds, waveforms)
    }
}

/// A probe that returns [`measurement`] for every packing with contacts.
fn probe(bus: &mut MemoryBus) -> AcousticProbe {
    let work = |message: &Packing| {
        let packing = grainlab_core::Packing::try_from(message).map_err(MeasureError::Refused)?;
        let step = packing.step;
        if packing.contacts.is_empty() {
            return measure(message, &Settings::default());
        }
        messages(&message.header, &packing, &measurement())
            .map_err(|reason| MeasureError::Result { step, reason })
    };
    AcousticProbe::measuring(bus, work).unwrap()
}

fn value(node: &AcousticProbe, key: &str) -> String {
    node.health().value(key).unwrap().to_owned()
}

#[test]
fn speeds_go_out_with_header_step_and_what_an_instrument_knows() {
    let hub = Hub::new(1);
    let mut source = Source::new(&hub);
    let packing = message(OVERLAP);
    source.packings.publish(&mut source.bus, &packing).unwrap();
    let mut bus = hub.bus(Names::new("acoustic_probe").unwrap());
    let mut node = probe(&mut bus);
    node.step(&mut bus).unwrap();
    let (speeds, waveforms) = source.heard();
    let ([speeds], [waveform]) = (&speeds[..], &waveforms[..]) else { panic!("{speeds:?} {waveforms:?}") };
    assert_eq!((&speeds.header, speeds.source_step), (&packing.header, 12));
    assert_eq!((&waveform.header, waveform.source_step), (&packing.header, 12));
    let reading = WaveSpeedsReading::try_from(speeds).unwrap();
    assert_eq!(reading.speeds, measurement().waves);
    assert_eq!(
        (reading.density, reading.density_stddev, reading.axis),
        (1500.0, Some(5.0), measurement().axis)
    );
    // Three contacts of force F over the faces: p = F/l².
    let edge = DIAMETER - OVERLAP;
    let pressure = Material::GLASS.normal_force(DIAMETER / 4.0, OVERLAP) / (edge * edge);
    assert!((reading.pressure / pressure - 1.0).abs() < 1e-12);
    let phi = std::f64::consts::PI / 6.0 * (DIAMETER / edge).powi(3);
    assert!((reading.solid_fraction.unwrap() / phi - 1.0).abs() < 1e-12);
    assert_eq!(reading.grain_shear_modulus, Material::GLASS.shear_modulus);
    assert!(reading.notes[0].is(Code::LeftOut), "{:?}", reading.notes);
    assert_eq!(waveform.checked().unwrap().channel, ["receiver 1", "receiver 2"]);
    assert_eq!(waveform.sample[4..], [0.0, 1e-6, 0.0, -1e-6]);
    assert_eq!((value(&node, "measured"), value(&node, "speeds")), ("1".into(), "2".into()));
}

#[test]
fn a_packing_that_carries_no_wave_is_declined_and_the_next_one_is_measured() {
    let hub = Hub::new(2);
    let mut source = Source::new(&hub);
    source.packings.publish(&mut source.bus, &message(-OVERLAP)).unwrap();
    let mut bus = hub.bus(Names::new("acoustic_probe").unwrap());
    let mut node = probe(&mut bus);
    node.step(&mut bus).unwrap();
    let (speeds, traces) = source.heard();
    let [declined] = &speeds[..] else { panic!("{speeds:?}") };
    assert!(declined.speeds.is_empty() && traces.is_empty() && declined.source_step == 12, "{declined:?}");
    assert!(WaveSpeedsReading::try_from(declined).unwrap().notes[0].is(Code::NoContacts));
    let health = node.health();
    assert!(health.level == Level::Warn && health.message.contains("no contact network"), "{health:?}");
    assert_eq!(value(&node, "without_network"), "1");
    source.packings.publish(&mut source.bus, &message(OVERLAP)).unwrap();
    node.step(&mut bus).unwrap();
    assert_eq!((source.heard().0.len(), node.health().level), (1, Level::Ok));
}

#[test]
fn a_malformed_packing_is_refused_by_name_and_the_next_one_is_measured() {
    let hub = Hub::new(3);
    let mut source = Source::new(&hub);
    let mut bus = hub.bus(Names::new("acoustic_probe").unwrap());
    let mut node = probe(&mut bus);
    let not_finite = Packing { time: f64::NAN, ..message(OVERLAP) };
    let cut = to_cdr(&message(OVERLAP))[..200].to_vec();
    for (count, (body, word)) in (1..).zip([(to_cdr(&not_finite), "time[0]"), (cut, "truncated")]) {
        source.bus.publish(source.packings.id(), &body).unwrap();
        node.step(&mut bus).unwrap();
        let health = node.health();
        assert!(health.level == Level::Warn && health.message.contains(word), "{word}: {health:?}");
        let refused: u64 = bus.received().iter().filter(|r| r.topic == "/packing").map(|r| r.refused).sum();
        assert_eq!(refused, count);
        source.packings.publish(&mut source.bus, &message(OVERLAP)).unwrap();
        node.step(&mut bus).unwrap();
        assert_eq!((source.heard().0.len(), node.health().level), (1, Level::Ok));
    }
}

#[test]
fn a_gas_is_declined_by_the_measurement_itself() {
    let declined = measure(&message(-OVERLAP), &Settings::default()).unwrap().declined;
    assert!(matches!(declined, Some(MeasureError::NoStiffness { step: 12, .. })), "{declined:?}");
}

#[test]
fn a_speed_that_no_reader_would_take_is_not_sent() {
    let mut found = measurement();
    found.waves[1].wave.speed = f64::NAN;
    let packing = lattice(OVERLAP);
    let error = messages(&message(OVERLAP).header, &packing, &found).unwrap_err().to_string();
    assert!(error.starts_with("WaveSpeeds.speeds[1].speed = NaN is refused"), "{error}");
}
