use crate::s1;
use emt_inversion::{EmtInversion, Settings, microstructure_message};
use grainlab_msgs::msg::{Microstructure, Moduli};
use grainlab_msgs::topics;
use node_kit::{Bus, Demand, Hub, Level, Names, Node, Publisher, Subscription};

#[test]
fn a_latched_set_of_moduli_is_inverted_by_a_node_that_comes_late_and_a_broken_one_is_refused() {
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
    assert_eq!(message, microstructure_message(&s1(), &Settings::default()).unwrap());
    source.publish(&mut bus, &Moduli { g12: f64::NAN, ..s1() }).unwrap();
    node.step(&mut node_bus).unwrap();
    assert!(found.take_valid(&mut bus).unwrap().is_none());
    assert_eq!((node_bus.received()[0].refused, node.health().level), (1, Level::Warn));
    source.publish(&mut bus, &s1()).unwrap();
    node.step(&mut node_bus).unwrap();
    assert_eq!(found.take_valid(&mut bus).unwrap().map(|(m, _)| m), Some(message));
}
