//! The analyzer node on the bus in memory, with a packing of known properties.

use grainlab_core::Material;
use grainlab_core::results::PackingReport;
use grainlab_fabric_analyzer::{FabricAnalyzer, MeasureError, Settings, measure, parameters};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::msg::{self, ElasticStiffness, Packing};
use grainlab_msgs::{to_cdr, topics};
use grainlab_node_kit::{Bus, Demand, Hub, Level, Names, Node, Parameters, Publisher, RosArgs, Subscription};
use grainlab_testkit::packings::{DIAMETER, OVERLAP, lattice};

fn message(overlap: f64) -> Packing {
    packing_message(&lattice(overlap), "lattice", vec![1, 2, 3])
}

/// Packings that the node refused.
fn refused(bus: &dyn Bus) -> u64 {
    bus.received().iter().filter(|r| r.topic == "/packing").map(|r| r.refused).sum()
}

#[test]
fn a_simple_cubic_lattice_has_the_moduli_of_its_springs() {
    let packing = message(OVERLAP);
    let measured = measure(&packing, &Settings::default()).unwrap();
    assert_eq!((&measured.message.header, measured.message.source_step), (&packing.header, 12));
    assert_eq!(PackingReport::try_from(&measured.message).as_ref(), Ok(&measured.report));
    let (report, contacts) = (&measured.report, &measured.report.contacts);
    assert_eq!((contacts.coordination, contacts.mechanical_coordination), (6.0, 6.0));
    assert_eq!(contacts.rattlers, 0);
    // C_iiii = k_n l²/V = k_n/l with l = V^(1/3); nothing relaxes by symmetry. The solve stops at 1e-9.
    let edge = DIAMETER - OVERLAP;
    let c11 = Material::GLASS.normal_stiffness(DIAMETER / 4.0, OVERLAP) / edge;
    let found = report.stiffness().unwrap().tensor.0[(0, 0)];
    assert!((found / c11 - 1.0).abs() < 1e-8, "{found} {c11}");
    // Three contacts of force F over the faces: p = F/l².
    let pressure = Material::GLASS.normal_force(DIAMETER / 4.0, OVERLAP) / (edge * edge);
    assert!((report.pressure() / pressure - 1.0).abs() < 1e-12);
}

#[test]
fn a_packing_that_is_none_or_cannot_be_analysed_says_why() {
    let mut broken = message(OVERLAP);
    broken.contact_pair[1] = 1;
    let error = measure(&broken, &Settings::default()).unwrap_err();
    assert!(
        matches!(error, MeasureError::Refused(_)) && error.to_string().contains("names grain 1"),
        "{error}"
    );
    let mut broken = message(OVERLAP);
    (broken.contact_normal[0], broken.contact_normal[2]) = (1.0, 0.0);
    let error = measure(&broken, &Settings::default()).unwrap_err();
    assert!(error.to_string().contains("normal"), "{error}");
}

#[test]
fn without_a_network_there_is_a_report_with_the_reason_and_a_warning() {
    let hub = Hub::new(1);
    let mut bus = hub.bus(Names::new("source").unwrap());
    let source: Publisher<Packing> = Publisher::advertise(&mut bus, &topics::PACKING).unwrap();
    let reports: Subscription<msg::PackingReport> =
        Subscription::subscribe(&mut bus, &topics::PACKING_REPORT, Demand::reliable(8)).unwrap();
    source.publish(&mut bus, &message(-OVERLAP)).unwrap();
    let mut node_bus = hub.bus(Names::new("fabric_analyzer").unwrap());
    let mut node = FabricAnalyzer::new(&mut node_bus, Settings::default()).unwrap();
    node.step(&mut node_bus).unwrap();
    let (gas, _) = reports.take_valid(&mut bus).unwrap().unwrap();
    assert_eq!((gas.contacts.contacts, gas.stiffness.len()), (0, 0));
    assert_eq!(gas.jamming, msg::PackingReport::NO_CONTACTS);
    let health = node.health();
    assert!(health.level == Level::Warn && health.message.contains("no contact network"), "{health:?}");
    source.publish(&mut bus, &message(OVERLAP)).unwrap();
    node.step(&mut node_bus).unwrap();
    assert_eq!(reports.take_valid(&mut bus).unwrap().unwrap().0.stiffness.len(), 1);
    assert_eq!((node.health().level, refused(&node_bus)), (Level::Ok, 0));
}

#[test]
fn a_packing_that_overlaps_beyond_every_contact_law_has_a_report_without_moduli_and_counts_as_failed() {
    let hub = Hub::new(3);
    let mut bus = hub.bus(Names::new("source").unwrap());
    let source: Publisher<Packing> = Publisher::advertise(&mut bus, &topics::PACKING).unwrap();
    let reports: Subscription<msg::PackingReport> =
        Subscription::subscribe(&mut bus, &topics::PACKING_REPORT, Demand::reliable(8)).unwrap();
    source.publish(&mut bus, &message(0.12 * DIAMETER)).unwrap();
    let mut node_bus = hub.bus(Names::new("fabric_analyzer").unwrap());
    let mut node = FabricAnalyzer::new(&mut node_bus, Settings::default()).unwrap();
    node.step(&mut node_bus).unwrap();
    let (deep, _) = reports.take_valid(&mut bus).unwrap().unwrap();
    assert_eq!((deep.jamming, deep.stiffness.len()), (msg::PackingReport::TOO_DEEP, 0));
    assert_eq!((deep.contacts.contacts, deep.contacts.coordination), (3, 6.0));
    let health = node.health();
    assert!(health.level == Level::Warn && health.message.contains("there are no moduli"), "{health:?}");
    assert!(health.values.contains(&("failed".to_owned(), "1".to_owned())), "{health:?}");
}

#[test]
fn a_malformed_packing_is_refused_by_name_and_the_next_one_is_analysed() {
    let hub = Hub::new(2);
    let mut bus = hub.bus(Names::new("source").unwrap());
    let source: Publisher<Packing> = Publisher::advertise(&mut bus, &topics::PACKING).unwrap();
    let reports: Subscription<msg::PackingReport> =
        Subscription::subscribe(&mut bus, &topics::PACKING_REPORT, Demand::reliable(8)).unwrap();
    let mut node_bus = hub.bus(Names::new("fabric_analyzer").unwrap());
    let mut node = FabricAnalyzer::new(&mut node_bus, Settings::default()).unwrap();
    let short = Packing { radius: Vec::new(), ..message(OVERLAP) };
    let not_finite = Packing { time: f64::NAN, ..message(OVERLAP) };
    let cut = to_cdr(&message(OVERLAP))[..200].to_vec();
    for (count, (body, word)) in (1..).zip([
        (to_cdr(&short), "Packing.position"),
        (to_cdr(&not_finite), "time[0]"),
        (cut, "truncated"),
    ]) {
        bus.publish(source.id(), &body).unwrap();
        node.step(&mut node_bus).unwrap();
        let health = node.health();
        assert!(health.level == Level::Warn && health.message.contains(word), "{word}: {health:?}");
        assert_eq!(refused(&node_bus), count);
        source.publish(&mut bus, &message(OVERLAP)).unwrap();
        node.step(&mut node_bus).unwrap();
        assert_eq!(node.health().level, Level::Ok);
        assert!(reports.take_valid(&mut bus).unwrap().is_some());
    }
}

#[test]
fn the_method_asked_for_is_used_and_said() {
    let with = |method: &str| {
        let args = ["--ros-args", "-p", &format!("method:={method}")].map(String::from);
        let (ros, _) = RosArgs::parse(&args).unwrap();
        let names = Names::from_args("fabric_analyzer", &ros).unwrap();
        let parameters = Parameters::resolve(&parameters(), "fabric_analyzer", &names, &ros).unwrap();
        measure(&message(OVERLAP), &Settings::try_from(&parameters).unwrap())
    };
    let [network, probe] = ["network", "probe"].map(|method| with(method).unwrap().message);
    let [network, probe] = [&network.stiffness[0], &probe.stiffness[0]];
    let expected = [ElasticStiffness::METHOD_FROZEN_NETWORK, ElasticStiffness::METHOD_PROBE];
    assert_eq!([network.method, probe.method], expected);
    // C44 of the lattice, k_t/(2 D), up to terms of the pressure.
    let c44 = [network, probe].map(|s| s.stiffness[21]);
    assert!(c44[0] > 0.0 && (c44[1] / c44[0] - 1.0).abs() < 1e-2, "{c44:?}");
    assert!(network.stddev.iter().all(|s| *s > 0.0));
    // Smooth grains on such a lattice slip past each other under any pressure.
    let unstable = with("prestressed").unwrap().message;
    assert_eq!((unstable.stiffness.len(), unstable.jamming), (0, msg::PackingReport::UNSOLVED));
}

#[test]
fn the_declared_defaults_are_the_typed_ones() {
    let settings = Settings::try_from(&Parameters::defaults(&parameters())).unwrap();
    assert_eq!(settings, Settings::default());
}

#[test]
fn an_axis_that_is_no_direction_and_a_tolerance_that_is_too_fine_are_refused() {
    let set = |axis: &str| {
        let args = ["--ros-args", "-p", axis].map(String::from);
        let (ros, _) = RosArgs::parse(&args).unwrap();
        let names = Names::from_args("fabric_analyzer", &ros).unwrap();
        let parameters = Parameters::resolve(&parameters(), "fabric_analyzer", &names, &ros).unwrap();
        Settings::try_from(&parameters)
    };
    assert!(set("axis:=[1, 0, 1]").is_ok());
    for axis in ["axis:=[0, 0, 0]", "axis:=[1, 0]"] {
        assert!(set(axis).unwrap_err().to_string().contains("not a direction"), "{axis}");
    }
    assert!(set("tolerance:=0.0").is_ok() && set("tolerance:=1e-13").is_ok());
    assert!(set("tolerance:=1e-14").unwrap_err().to_string().contains("1e-14 is below 1e-13"));
}
