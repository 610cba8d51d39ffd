//! The inversions of the last packing, which a simulator may await before it ends.

use grainlab_msgs::msg::Microstructure;
use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::{Bus, BusError, Demand, Subscription};

/// More microstructures than arrive between two steps of the node.
const BACKLOG: u32 = 64;

/// The latest inverted packing by each topic of data.
pub(crate) struct Inversions {
    /// `None` if no inversion is awaited.
    microstructures: Option<Subscription<Microstructure>>,
    /// Each awaited topic, and the step of the packing whose data were inverted last.
    latest: Vec<(Topic, Option<u64>)>,
}

impl Inversions {
    /// Subscribes if inversions of data of these topics are awaited.
    pub(crate) fn new(bus: &mut dyn Bus, awaited: &[Topic]) -> Result<Self, BusError> {
        let subscribe =
            |bus| Subscription::subscribe(bus, &topics::MICROSTRUCTURE, Demand::reliable(BACKLOG));
        let microstructures = if awaited.is_empty() { None } else { Some(subscribe(bus)?) };
        Ok(Self { microstructures, latest: awaited.iter().map(|topic| (*topic, None)).collect() })
    }

    pub(crate) fn receive(&mut self, bus: &mut dyn Bus) -> Result<(), BusError> {
        let Some(subscription) = &mut self.microstructures else { return Ok(()) };
        while let Some((found, _)) = subscription.take_valid(bus)? {
            let of_source = self.latest.iter_mut().filter(|(topic, _)| topic.name == found.source);
            of_source.for_each(|(_, step)| *step = Some(found.source_step));
        }
        Ok(())
    }

    /// The first topic whose data of the packing of `step` are not inverted.
    pub(crate) fn missing(&self, step: u64) -> Option<&'static str> {
        self.latest.iter().find(|(_, latest)| *latest != Some(step)).map(|(topic, _)| topic.name)
    }
}
