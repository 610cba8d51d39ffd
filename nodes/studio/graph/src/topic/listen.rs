//! Subscribes to a topic of any type.

use crate::graph::{is_reliable, is_transient_local};
use crate::names::{absolute, unknown};
use crate::observer::Observer;
use grainlab_console::Failure;
use grainlab_msgs::{Qos, Topic, topics};
use grainlab_node_kit::{Bus, DdsBus, Demand, Exit, Sample, Source, Wake, tool_bus};
use std::time::{Duration, Instant};

/// Samples that may wait for this process: a second of the fastest topic.
const DEPTH: u32 = 20_000;

/// Packings that may wait for this process.
const PACKINGS: u32 = 16;

/// A subscription to one topic, of which no type needs to be known.
pub(crate) struct Listener {
    bus: DdsBus,
    source: Source,
    /// Name and type.
    pub(crate) topic: Topic,
}

impl Listener {
    /// Finds the topic and its type, and subscribes with what its publishers offer.
    ///
    /// `whole` asks for every sample, latched ones included; else losses are accepted, and no publisher keeps anything for
    /// this process.
    pub(crate) fn open(name: &str, whole: bool, patience: Duration) -> Result<Self, Failure> {
        let name = absolute(name);
        let graph = Observer::join()?.settled(patience);
        let all = graph.topics();
        let Some(entry) = all.get(name.as_str()) else {
            return Err(unknown("topic", &name, all.keys().copied()));
        };
        let types = entry.types();
        let type_name = match types.first() {
            Some(one) if types.len() == 1 => one,
            _ => {
                let list = types.into_iter().collect::<Vec<_>>().join(" and ");
                return Err(Failure::failed(format!("{name} has more than one type: {list}")));
            }
        };
        let offers = |policy: fn(&ros2_client::QosProfile) -> bool| {
            !entry.publishers.is_empty() && entry.publishers.iter().all(|p| policy(&p.qos))
        };
        let reliable = whole && offers(is_reliable);
        let qos = Qos { reliable, depth: DEPTH, transient_local: reliable && offers(is_transient_local) };
        let Some(topic) = Topic::outside_contract(&name, type_name, qos) else {
            return Err(Failure::failed(format!("{name} has the type {type_name}, which is no ROS message")));
        };
        let mut bus = tool_bus("grainlab_topic")?;
        let demand = if reliable { Demand::reliable(DEPTH) } else { Demand::best_effort(DEPTH) };
        let source = match (whole, topic.info == topics::PACKING.info) {
            (true, true) => Source::open(&mut bus, &topic, Demand { depth: PACKINGS, ..demand }),
            _ => bus.subscribe(&topic, demand).map(Source::Samples),
        };
        Ok(Self { bus, source: source.map_err(Failure::failed)?, topic })
    }

    /// Waits until a publisher is matched: a window begins when samples can arrive.
    pub(crate) fn wait_for_publisher(&mut self, patience: Duration) -> Result<(), Failure> {
        let end = Instant::now() + patience;
        while self.bus.writers(self.source.id()) == 0 && Instant::now() < end {
            if self.bus.wait(end.saturating_duration_since(Instant::now())) == Wake::Shutdown {
                return Err(Failure::new(Exit::Interrupted, "interrupted"));
            }
        }
        Ok(())
    }

    /// The samples that arrive before `end`; an interruption is an error with exit 130.
    pub(crate) fn until(
        &mut self,
        end: Instant,
        mut each: impl FnMut(Sample) -> Result<bool, Failure>,
    ) -> Result<(), Failure> {
        loop {
            while let Some(sample) = self.source.take(&mut self.bus).map_err(Failure::failed)? {
                if !each(sample)? {
                    return Ok(());
                }
            }
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(());
            }
            if self.bus.wait(left.min(self.source.patience(self.bus.now()))) == Wake::Shutdown {
                return Err(Failure::new(Exit::Interrupted, "interrupted"));
            }
        }
    }
}
