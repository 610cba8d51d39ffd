//! The services of a node, asked by a bare ros2-client node.

use grainlab_node_kit::{
    Bus, Exit, FreeDomain, Health, Network, Next, Node, NodeError, NodeSpec, ParameterSpec, Range, RosArgs,
    Scope, run_node,
};
use ros2_client::parameters::raw::{ParameterEvent, SetParametersResult};
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::rcl_interfaces::{
    DescribeParametersRequest, DescribeParametersResponse, GetParametersRequest, GetParametersResponse,
    SetParametersRequest, SetParametersResponse,
};
use ros2_client::ros2::policy;
use ros2_client::{
    Client, Message, MessageTypeName, Name, NodeName, NodeOptions, Parameter, ParameterValue, QosProfile,
    ServiceMapping, ServiceTypeName, Subscription,
};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

const TIME_LIMIT: Duration = Duration::from_secs(20);

/// Computes for long in each step, until the test ends it.
struct Busy;

static END: AtomicBool = AtomicBool::new(false);

impl Node for Busy {
    fn step(&mut self, _: &mut dyn Bus) -> Result<Next, NodeError> {
        while !END.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(5));
        }
        Ok(Next::Finished(Exit::Done))
    }

    fn health(&self) -> Health {
        Health::ok("computes")
    }
}

/// Asks the node until it answers: a server may be matched in one direction before the other.
struct Asker {
    node: ros2_client::Node,
    context: ros2_client::Context,
}

impl Asker {
    fn new(network: Network) -> Self {
        let context = network.context().unwrap();
        let options = NodeOptions::new().enable_rosout(false);
        let node = context.new_node(NodeName::new("/", "asker").unwrap(), options).unwrap();
        Self { node, context }
    }

    fn call<Req: Message + Clone + 'static, Resp: Message + 'static>(
        &mut self,
        service: &str,
        type_name: &str,
        request: &Req,
    ) -> Resp {
        let qos = QosProfile::publisher_default()
            .reliability_reliable(WhenFull::DEFAULT)
            .history(History::KeepLast { depth: 10 });
        let name = Name::new("/busy", service).unwrap();
        let service_type = ServiceTypeName::new("rcl_interfaces", type_name);
        let client: Client<Req, Resp> = self
            .node
            .create_client(ServiceMapping::Enhanced, &name, &service_type, qos.clone(), qos)
            .unwrap();
        let start = Instant::now();
        while start.elapsed() < TIME_LIMIT {
            let asked = client.send_request(request.clone()).unwrap();
            let sent = Instant::now();
            while sent.elapsed() < Duration::from_millis(500) {
                match client.receive_response() {
                    Ok(Some((id, response))) if id == asked => return response,
                    _ => std::thread::sleep(Duration::from_millis(5)),
                }
            }
        }
        panic!("no answer of {service}");
    }

    fn set(&mut self, name: &str, value: ParameterValue) -> SetParametersResult {
        let parameter = Parameter { name: name.into(), value };
        let request = SetParametersRequest { parameter: vec![parameter.into()] };
        let mut response: SetParametersResponse = self.call("set_parameters", "SetParameters", &request);
        response.results.remove(0)
    }

    fn get(&mut self, name: &str) -> ParameterValue {
        let request = GetParametersRequest { names: vec![name.into()] };
        let mut response: GetParametersResponse = self.call("get_parameters", "GetParameters", &request);
        response.values.remove(0).into()
    }

    /// The durability that the writers of `/parameter_events` offer.
    fn durability_of_events(&self) -> Vec<Option<policy::Durability>> {
        let writers = self.context.domain_participant().discovered_writers();
        let data = writers.into_iter().map(|writer| writer.publication_topic_data);
        let of_events = data.filter(|data| data.topic_name == "rt/parameter_events");
        of_events.map(|data| data.qos().durability()).collect()
    }

    fn events(&mut self) -> Subscription<ParameterEvent> {
        let qos = QosProfile::publisher_default()
            .reliability_reliable(WhenFull::DEFAULT)
            .durability(Durability::Volatile)
            .history(History::KeepLast { depth: 10 });
        let name = Name::parse("/parameter_events").unwrap();
        let message_type = MessageTypeName::new("rcl_interfaces", "ParameterEvent");
        let topic = self.node.create_topic(&name, message_type, &qos).unwrap();
        self.node.create_subscription(&topic, Some(qos)).unwrap()
    }
}

#[test]
fn parameters_are_read_described_and_set_while_the_node_computes() {
    let claimed = FreeDomain::take().expect("a free domain");
    let domain = claimed.network().domain.to_string();
    // SAFETY: this is the only test of this process, and no other thread runs yet.
    unsafe { std::env::set_var("ROS_DOMAIN_ID", domain) };
    let spec = NodeSpec {
        name: "busy",
        summary: "computes",
        scope: Scope::OwnRun,
        parameters: vec![
            ParameterSpec::new("scene", "demo", "scene"),
            ParameterSpec::new("wait", 0.1, "time between repetitions, s")
                .within(Range::Positive)
                .changeable(),
        ],
    };
    let node = std::thread::spawn(move || {
        let args = RosArgs { stderr: false, rosout: false, ..RosArgs::default() };
        run_node(&spec, &args, |_, _| Ok(Box::new(Busy)))
    });

    let mut asker = Asker::new(claimed.network());
    assert_eq!(asker.get("wait"), ParameterValue::Double(0.1));
    assert_eq!(asker.get("nothing"), ParameterValue::NotSet);
    let request = DescribeParametersRequest { names: vec!["wait".into()] };
    let described: DescribeParametersResponse =
        asker.call("describe_parameters", "DescribeParameters", &request);
    assert_eq!(described.values[0].description, "time between repetitions, s");

    let events = asker.events();
    // Asked and answered often enough that its other endpoints are discovered.
    let offered = asker.durability_of_events();
    assert!(
        !offered.is_empty() && offered.iter().all(|d| *d == Some(policy::Durability::Volatile)),
        "{offered:?}"
    );
    assert!(asker.set("wait", ParameterValue::Double(0.5)).successful);
    assert_eq!(asker.get("wait"), ParameterValue::Double(0.5));
    // An integer is taken for a double, as `ros2 param set` sends it.
    assert!(asker.set("wait", ParameterValue::Integer(2)).successful);
    for (name, value, reason) in [
        ("wait", ParameterValue::Double(-1.0), "greater than 0"),
        ("wait", ParameterValue::String("x".into()), "type"),
        ("scene", ParameterValue::String("s1".into()), "read-only"),
        ("scenes", ParameterValue::String("s1".into()), "not allowed"),
    ] {
        let refused = asker.set(name, value);
        assert!(!refused.successful && refused.reason.contains(reason), "{refused:?}");
    }

    let start = Instant::now();
    let mut changes = Vec::new();
    while changes.len() < 2 && start.elapsed() < TIME_LIMIT {
        while let Ok(Some((event, _))) = events.take() {
            assert_eq!(event.node, "/busy");
            changes.extend(event.changed_parameters.into_iter().map(|p| p.value.double_value));
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(changes.ends_with(&[2.0]), "the events tell the changes: {changes:?}");

    END.store(true, Ordering::Relaxed);
    assert_eq!(node.join().unwrap(), Exit::Done);
}
