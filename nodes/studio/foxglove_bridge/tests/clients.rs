//! Clients over sockets, with the bus in memory.

use grainlab_foxglove_bridge::{BridgeSettings, FoxgloveBridge, parameters};
use grainlab_msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus};
use grainlab_msgs::msg::Moduli;
use grainlab_msgs::{to_cdr, topics};
use grainlab_node_kit::{Hub, MemoryBus, Names, Node, Parameters, Publisher, RosArgs};
use serde_json::{Value, json};
use std::io::{Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpStream};
use std::time::{Duration, Instant};
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message, WebSocket, client};

/// Time limit of every wait.
const LIMIT: Duration = Duration::from_secs(20);

/// The bridge beside a process that publishes reports and moduli.
struct Bridge {
    hub: Hub,
    talker: MemoryBus,
    reports: Publisher<DiagnosticArray>,
    moduli: Publisher<Moduli>,
    bus: MemoryBus,
    node: FoxgloveBridge,
}

impl Bridge {
    fn new() -> Self {
        let hub = Hub::new(1);
        let names = |name: &str| Names::from_args(name, &RosArgs::default()).unwrap();
        let (mut talker, mut bus) = (hub.bus(names("talker")), hub.bus(names("foxglove_bridge")));
        let reports = Publisher::advertise(&mut talker, &topics::DIAGNOSTICS).unwrap();
        let moduli = Publisher::advertise(&mut talker, &topics::MODULI).unwrap();
        let (ros, _) = RosArgs::parse(&["--ros-args", "-p", "port:=0"].map(str::to_owned)).unwrap();
        let values = Parameters::resolve(&parameters(), "foxglove_bridge", &names("foxglove_bridge"), &ros);
        let settings = BridgeSettings::of(&values.unwrap()).unwrap();
        let mut node = FoxgloveBridge::new(&mut bus, settings).unwrap();
        node.step(&mut bus).unwrap();
        Self { hub, talker, reports, moduli, bus, node }
    }

    fn step(&mut self) -> String {
        self.node.step(&mut self.bus).unwrap();
        self.node.health().message
    }

    /// Steps until the node reports this.
    fn until(&mut self, health: &str) {
        let begin = Instant::now();
        while self.step() != health {
            assert!(begin.elapsed() < LIMIT, "{} instead of {health}", self.step());
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn report(&mut self, number: u32, text: &str) -> Vec<u8> {
        let name = number.to_string();
        let status = DiagnosticStatus { name, message: text.to_owned(), ..DiagnosticStatus::default() };
        let message = DiagnosticArray { status: vec![status], ..DiagnosticArray::default() };
        self.reports.publish(&mut self.talker, &message).unwrap();
        self.step();
        payload(&message)
    }

    fn socket(&self) -> TcpStream {
        let socket = TcpStream::connect((Ipv4Addr::LOCALHOST, self.node.port())).unwrap();
        socket.set_read_timeout(Some(LIMIT)).unwrap();
        socket
    }

    fn join(&self, subprotocol: &str) -> Result<Client, String> {
        let mut request = format!("ws://127.0.0.1:{}", self.node.port()).into_client_request().unwrap();
        request.headers_mut().insert("sec-websocket-protocol", subprotocol.parse().unwrap());
        client(request, self.socket()).map(|(socket, _)| Client(socket)).map_err(|e| e.to_string())
    }
}

/// A message as the bus carries it: RTPS pads a payload to four bytes.
fn payload(message: &impl grainlab_msgs::Message) -> Vec<u8> {
    let mut bytes = to_cdr(message);
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

struct Client(WebSocket<TcpStream>);

impl Client {
    fn send(&mut self, message: &Value) {
        self.0.send(message.to_string().into()).unwrap();
    }

    fn subscribe(&mut self, id: u32, channel: &Value) {
        self.send(&json!({"op": "subscribe", "subscriptions": [{"id": id, "channelId": channel}]}));
    }

    /// The next text.
    fn told(&mut self) -> Value {
        match self.0.read().unwrap() {
            Message::Text(text) => serde_json::from_str(&text).unwrap(),
            other => panic!("{other:?}"),
        }
    }

    /// Topic and number of the channels, as told first.
    fn channels(&mut self) -> Vec<Value> {
        let info = self.told();
        assert_eq!((&info["op"], &info["name"]), (&json!("serverInfo"), &json!("grainlab")));
        let told = self.told();
        assert_eq!(told["op"], "advertise");
        told["channels"].as_array().unwrap().clone()
    }

    fn channel(&mut self, topic: &str) -> Value {
        self.channels().iter().find(|channel| channel["topic"] == topic).unwrap()["id"].clone()
    }

    /// Subscription and payload of the next message.
    fn data(&mut self) -> (u32, Vec<u8>) {
        match self.0.read().unwrap() {
            Message::Binary(frame) => {
                assert!(frame.len() >= 13 && frame[0] == 1, "{frame:?}");
                (u32::from_le_bytes(frame[1..5].try_into().unwrap()), frame[13..].to_vec())
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_client_gets_the_bytes_of_the_bus_while_it_subscribes_and_nothing_else() {
    for subprotocol in ["foxglove.sdk.v1", "foxglove.websocket.v1", "other, foxglove.sdk.v1"] {
        let mut bridge = Bridge::new();
        let mut client = bridge.join(subprotocol).unwrap();
        let channels = client.channels();
        let offered = channels.iter().find(|channel| channel["topic"] == "/diagnostics").unwrap();
        assert_eq!(
            [&offered["encoding"], &offered["schemaEncoding"], &offered["schemaName"]],
            ["cdr", "ros2msg", "diagnostic_msgs/msg/DiagnosticArray"]
        );
        assert!(offered["schema"].as_str().unwrap().contains("DiagnosticStatus[] status"), "{offered}");
        bridge.until("1 clients, 0 of 2 topics");
        client.subscribe(5, &offered["id"]);
        bridge.until("1 clients, 1 of 2 topics");
        let sent = bridge.report(1, "one");
        assert_eq!(client.data(), (5, sent));
        client.send(&json!({"op": "unsubscribe", "subscriptionIds": [5]}));
        bridge.until("1 clients, 0 of 2 topics");
        bridge.report(2, "two");
        client.subscribe(6, &offered["id"]);
        bridge.until("1 clients, 1 of 2 topics");
        let sent = bridge.report(3, "three");
        assert_eq!(client.data(), (6, sent), "not the one meanwhile");
        client.0.get_ref().shutdown(Shutdown::Both).unwrap();
        bridge.until("0 clients, 0 of 2 topics");
    }
}

#[test]
fn a_topic_that_comes_and_goes_is_told_to_clients() {
    let mut bridge = Bridge::new();
    let mut client = bridge.join("foxglove.sdk.v1").unwrap();
    let channel = client.channel("/moduli");
    client.subscribe(1, &channel);
    bridge.until("1 clients, 1 of 2 topics");
    let names = Names::from_args("another", &RosArgs::default()).unwrap();
    let mut other = bridge.hub.bus(names);
    let _stress: Publisher<grainlab_msgs::msg::Stress> =
        Publisher::advertise(&mut other, &topics::STRESS).unwrap();
    bridge.hub.advance(Duration::from_secs(1));
    bridge.until("1 clients, 1 of 3 topics");
    assert_eq!(client.told()["channels"][0]["topic"], "/stress");
    bridge.talker = other;
    bridge.hub.advance(Duration::from_secs(1));
    bridge.until("1 clients, 0 of 1 topics");
    let gone = [client.told(), client.told()].map(|told| told["channelIds"][0].clone());
    assert!(gone.contains(&channel), "{gone:?}");
}

#[test]
fn a_client_that_subscribes_after_another_one_gets_the_latched_message_once() {
    let mut bridge = Bridge::new();
    let moduli = Moduli { source_step: 7, ..Moduli::default() };
    bridge.moduli.publish(&mut bridge.talker, &moduli).unwrap();
    let mut clients = [0, 1].map(|_| bridge.join("foxglove.sdk.v1").unwrap());
    for client in &mut clients {
        let channel = client.channel("/moduli");
        client.subscribe(3, &channel);
        bridge.until("2 clients, 1 of 2 topics");
        let begin = Instant::now();
        // The subscription may arrive after the step above.
        client.0.get_ref().set_nonblocking(true).unwrap();
        let found = loop {
            bridge.step();
            match client.0.read() {
                Ok(message) => break message.into_data(),
                Err(Error::Io(_)) => std::thread::sleep(Duration::from_millis(1)),
                Err(other) => panic!("{other}"),
            }
            assert!(begin.elapsed() < LIMIT, "nothing came");
        };
        assert_eq!(found[13..], payload(&moduli));
        client.0.get_ref().set_nonblocking(false).unwrap();
    }
    let next = Moduli { source_step: 8, ..Moduli::default() };
    bridge.moduli.publish(&mut bridge.talker, &next).unwrap();
    bridge.step();
    for client in &mut clients {
        assert_eq!(client.data(), (3, payload(&next)));
    }
}

#[test]
fn a_fault_of_a_client_is_told_to_it_and_the_others_are_served() {
    let mut bridge = Bridge::new();
    assert!(bridge.join("foxglove.other").err().unwrap().contains("400"), "no subprotocol in common");
    let mut client = bridge.join("foxglove.sdk.v1").unwrap();
    let channels = client.channels();
    assert_eq!(channels[0]["topic"], "/diagnostics");
    let [reports, moduli] = [0, 1].map(|i| channels[i]["id"].clone());
    for (message, level, answer) in [
        (Message::from("{"), 2, "no message of the protocol"),
        (
            Message::from(json!({"op": "subscribe", "subscriptions": [{"id": -1}]}).to_string()),
            2,
            "no message",
        ),
        (Message::from(vec![1, 0, 0]), 2, "nothing can be published"),
        (Message::from(json!({"op": "getParameters", "parameterNames": []}).to_string()), 1, "subscriptions"),
        (
            Message::from(
                json!({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 1u64 << 40}]}).to_string(),
            ),
            2,
            "no channel 1099511627776",
        ),
        (
            Message::from(json!({"op": "unsubscribe", "subscriptionIds": [9]}).to_string()),
            1,
            "no subscription 9",
        ),
    ] {
        client.0.send(message).unwrap();
        let told = client.told();
        assert_eq!((&told["op"], &told["level"]), (&json!("status"), &json!(level)), "{told}");
        assert!(told["message"].as_str().unwrap().contains(answer), "{told}");
    }
    // No handshake; a text that is too long; an invalid frame.
    let mut noise = bridge.socket();
    noise.write_all(&[0; 64]).unwrap();
    let _ = noise.read(&mut [0; 64]);
    let mut long = bridge.join("foxglove.sdk.v1").unwrap();
    let _ = long.0.send(" ".repeat(2 << 20).into());
    let mut broken = bridge.join("foxglove.sdk.v1").unwrap();
    broken.0.get_mut().write_all(&[0xff; 64]).unwrap();
    bridge.until("1 clients, 0 of 2 topics");
    client.subscribe(1, &reports);
    client.subscribe(2, &reports);
    client.subscribe(1, &moduli);
    bridge.until("1 clients, 1 of 2 topics");
    assert!(client.told()["message"].as_str().unwrap().contains("already"));
    assert!(client.told()["message"].as_str().unwrap().contains("in use"));
    let sent = bridge.report(1, "one");
    assert_eq!(client.data(), (1, sent));
}

#[test]
fn a_client_that_does_not_read_loses_the_oldest_messages_and_holds_up_nobody() {
    const SENT: u32 = 600;
    let text = "x".repeat(1 << 17);
    let mut bridge = Bridge::new();
    let [mut reader, mut stalled] = [0, 1].map(|_| bridge.join("foxglove.sdk.v1").unwrap());
    for client in [&mut reader, &mut stalled] {
        let channel = client.channel("/diagnostics");
        client.subscribe(1, &channel);
        // An answer follows what was asked before.
        client.send(&json!({"op": "getParameters"}));
        client.told();
    }
    bridge.until("2 clients, 1 of 2 topics");
    let mut last = Vec::new();
    for number in 0..SENT {
        last = bridge.report(number, &text);
        assert_eq!(reader.data().1, last, "each one");
    }
    let mut found = 0;
    while stalled.data().1 != last {
        found += 1;
    }
    assert!((255..SENT - 1).contains(&found), "{found} before the last one");
}
