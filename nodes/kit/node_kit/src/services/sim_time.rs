//! The time of `/clock`, followed while the parameter `use_sim_time` is true.

use super::declared::Declared;
use crate::bus_error::BusError;
use crate::dds::create_error;
use grainlab_msgs::rosgraph_msgs::Clock;
use grainlab_msgs::topics;
use mio::{Interest, Registry, Token};
use ros2_client::builtin_interfaces::Time;
use ros2_client::{MessageTypeName, Name, Node, QosProfile, Subscription};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The node's time by `/clock`, ns since 1970. Clones share it.
#[derive(Clone, Debug, Default)]
pub(crate) struct SimTime {
    nanos: Arc<AtomicU64>,
}

impl SimTime {
    /// The time of the last message; 0 before the first, as in ROS 2.
    pub(crate) fn nanos(&self) -> u64 {
        self.nanos.load(Ordering::Relaxed)
    }
}

/// The subscription to `/clock`, which exists while `use_sim_time` is true.
pub(super) struct ClockReader {
    time: SimTime,
    declared: Declared,
    node: Arc<Mutex<Node>>,
    clock: Option<Subscription<Clock>>,
}

impl ClockReader {
    pub(super) fn new(node: &Arc<Mutex<Node>>, declared: Declared, time: SimTime) -> Self {
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
            self.time.nanos.store(nanos.max(0) as u64, Ordering::Relaxed);
            self.node().set_sim_time(Time::from_nanos(nanos).into());
        }
        Ok(())
    }

    fn node(&self) -> std::sync::MutexGuard<'_, Node> {
        self.node.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn subscribe(&self) -> Result<Subscription<Clock>, BusError> {
        let failed = |reason: String| BusError::Network { what: "subscribe /clock".into(), reason };
        let name = Name::parse(topics::CLOCK.name).map_err(|e| failed(format!("{e:?}")))?;
        let message_type = MessageTypeName::new(topics::CLOCK.info.package, topics::CLOCK.info.name);
        let qos = QosProfile::subscription_default();
        let mut node = self.node();
        let topic = node.create_topic(&name, message_type, &qos).map_err(|e| failed(e.to_string()))?;
        node.create_subscription(&topic, Some(qos)).map_err(|e| failed(e.to_string()))
    }
}
