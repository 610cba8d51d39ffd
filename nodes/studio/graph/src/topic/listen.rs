//! Subscribes to a topic of any type.

use super::qos::QosArgs;
use crate::graph::{Graph, TopicEntry};
use crate::names::{absolute, unknown};
use crate::observer::Observer;
use grainlab_console::Failure;
use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::{Bus, DdsBus, Demand, Exit, Graph as _, Sample, Source, Wake, tool_bus};
use std::time::{Duration, Instant};

/// Samples that may wait for this process: a second of the fastest topic.
const DEPTH: u32 = 20_000;

/// Least time of a look at the graph.
const LEAST: Duration = Duration::from_millis(2500);

/// Packings that may wait for this process.
const PACKINGS: u32 = 16;

/// A subscription to one topic, of which no type needs to be known.
pub(crate) struct Listener {
    bus: DdsBus,
    source: Source,
    pub(crate) topic: Topic,
}

impl Listener {
    /// Waits for the topic, and subscribes to it. A type that is given need not be waited for.
    ///
    /// `whole` asks for every sample, latched ones included; else losses are accepted, and no publisher keeps anything for
    /// this process.
    pub(crate) fn open(
        name: &str,
        given: Option<&str>,
        policies: &QosArgs,
        whole: bool,
        patience: Duration,
    ) -> Result<Self, Failure> {
        let name = absolute(name);
        let is_there = |graph: &Graph| graph.topics().contains_key(name.as_str());
        let mut observer = Observer::join()?;
        let mut graph = observer.with(patience, is_there);
        let end = Instant::now() + patience;
        if given.is_none() && !is_there(&graph) && Instant::now() < end {
            grainlab_console::say!("grainlab: waiting for {name}, at most {} s", patience.as_secs_f64());
            while !is_there(&graph) && Instant::now() < end {
                graph = observer.with(end.saturating_duration_since(Instant::now()).max(LEAST), is_there);
            }
        }
        let all = graph.topics();
        let entry = all.get(name.as_str());
        let types = entry.map(TopicEntry::types).unwrap_or_default();
        let list = types.iter().copied().collect::<Vec<_>>().join(" and ");
        let type_name = match (given, types.first()) {
            (Some(given), Some(one)) if types.len() > 1 || given != *one => {
                return Err(Failure::failed(format!("{name} has the type {list}, not {given}")));
            }
            (Some(given), _) => given,
            (None, Some(one)) if types.len() == 1 => one,
            (None, Some(_)) => {
                return Err(Failure::failed(format!("{name} has more than one type: {list}")));
            }
            (None, None) => return Err(unknown("topic", &name, all.keys().copied())),
        };
        let publishers = entry.map(|entry| entry.publishers.as_slice()).unwrap_or_default();
        let qos = policies.requested(publishers, whole, DEPTH);
        let Some(topic) = Topic::outside_contract(&name, type_name, qos) else {
            return Err(Failure::failed(format!("{name} has the type {type_name}, which is no ROS message")));
        };
        let mut bus = tool_bus(&format!("_grainlab_topic_{}", std::process::id()))?;
        let demand = |depth| Demand { reliable: qos.reliable, ..Demand::best_effort(depth) };
        let source = match (whole, topic.info == topics::PACKING.info) {
            (true, true) => Source::open(&mut bus, &topic, demand(PACKINGS)),
            _ => bus.subscribe(&topic, demand(qos.depth)).map(Source::Samples),
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
