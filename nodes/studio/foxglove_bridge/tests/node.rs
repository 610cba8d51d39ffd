//! The node on the bus in memory, without a client.

use grainlab_foxglove_bridge::{BridgeSettings, FoxgloveBridge, parameters};
use grainlab_msgs::msg::Stress;
use grainlab_msgs::topics;
use grainlab_node_kit::{Bus, Hub, Names, Node, Parameters, Publisher, RosArgs};

fn names(name: &str) -> Names {
    Names::from_args(name, &RosArgs::default()).unwrap()
}

fn settings(arguments: &[&str]) -> Result<BridgeSettings, String> {
    let arguments: Vec<String> = arguments.iter().map(ToString::to_string).collect();
    let (ros, _) = RosArgs::parse(&arguments).unwrap();
    let values =
        Parameters::resolve(&parameters(), "foxglove_bridge", &names("foxglove_bridge"), &ros).unwrap();
    BridgeSettings::of(&values).map_err(|e| e.to_string())
}

#[test]
fn without_a_client_topics_are_found_and_none_is_received() {
    let hub = Hub::new(1);
    let (mut talker, mut bus) = (hub.bus(names("talker")), hub.bus(names("foxglove_bridge")));
    let stress: Publisher<Stress> = Publisher::advertise(&mut talker, &topics::STRESS).unwrap();
    talker.advertise(&topics::PACKING).unwrap();
    talker.advertise(&topics::PACKING_CHUNK).unwrap();
    let mut node =
        FoxgloveBridge::new(&mut bus, settings(&["--ros-args", "-p", "port:=0"]).unwrap()).unwrap();
    assert!(node.port() > 0);
    stress.publish(&mut talker, &Stress::default()).unwrap();
    node.step(&mut bus).unwrap();
    assert_eq!(node.health().message, "0 clients, 0 of 2 topics", "parts of packings are no topic");
    assert!(bus.received().is_empty());
    drop(talker);
    hub.advance(std::time::Duration::from_secs(1));
    node.step(&mut bus).unwrap();
    assert_eq!(node.health().message, "0 clients, 0 of 0 topics");
}

#[test]
fn values_that_are_not_valid_are_named() {
    let fault = |argument: &str| settings(&["--ros-args", "-p", argument]).unwrap_err();
    assert!(fault("address:=localhost").contains("\"localhost\" is not an IP address"));
    assert!(fault("msg_path:=[/does/not/exist]").contains("no folder /does/not/exist"));
    assert!(settings(&["--ros-args", "-p", "address:=::1"]).is_ok());
}
