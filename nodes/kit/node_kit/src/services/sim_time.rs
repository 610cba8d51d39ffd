//! The time of `/clock`, followed while the parameter `use_sim_time` is true.

use crate::bus_error::{BusError, create_error};
use crate::lock::lock;
use crate::parameters::Parameters;
use grainlab_msgs::rosgraph_msgs::Clock;
use grainlab_msgs::topics;
use mio::{Interest, Registry, Token};
use ros2_client::builtin_interfaces::Time;
use ros2_client::{MessageTypeName, Name, Node, QosProfile, Subscription};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

/// The node's time by the last message on `/clock`, ns since 1970; 0 before the first, as in ROS 2.
pub(crate) type SimTime = Arc<AtomicU64>;

/// The subscription to `/clock`, which exists while `use_sim_time` is true.
pub(super) struct ClockReader {
    time: SimTime,
    declared: Parameters,
    node: Arc<Mutex<Node>>,
    clock: Option<Subscription<Clock>>,
}

impl ClockReader {
    pub(super) fn new(node: &Arc<Mutex<Node>>, declared: Parameters, time: SimTime) -> Self {
        Self { time, declared, node: Arc::clone(node), clock: None }
    }

    /// Reads what arrived. Subscribes or unsubscribes where the parameter changed.
    pub(super) fn update(&mut self, registry: &Registry, token: Token) -> Result<(), BusError> {
        if !self.declared.use_sim_time() {
            self.clock = None;
            return Ok(());
        }
        if self.clock.is_none() {
            let mut clock = self.subscribe()?;
            registry
                .register(&mut clock, token, Interest::READABLE)
                .map_err(|e| create_error("subscription of /clock", &e))?;
            self.clock = Some(clock);
        }
        while let Some(Ok(Some((message, _)))) = self.clock.as_ref().map(Subscription::take) {
            let stamp = message.clock;
            let nanos = i64::from(stamp.sec) * 1_000_000_000 + i64::from(stamp.nanosec);
            self.time.store(nanos.max(0) as u64, Ordering::Relaxed);
            lock(&self.node).set_sim_time(Time::from_nanos(nanos).into());
        }
        Ok(())
    }

    fn subscribe(&self) -> Result<Subscription<Clock>, BusError> {
        let failed = |reason: String| BusError::Network { what: "subscribe /clock".into(), reason };
        let name = Name::parse(topics::CLOCK.name).map_err(|e| failed(format!("{e:?}")))?;
        let message_type = MessageTypeName::new(topics::CLOCK.info.package, topics::CLOCK.info.name);
        let qos = QosProfile::subscription_default();
        let mut node = lock(&self.node);
        let topic = node.create_topic(&name, message_type, &qos).map_err(|e| failed(e.to_string()))?;
        node.create_subscription(&topic, Some(qos)).map_err(|e| failed(e.to_string()))
    }
}
