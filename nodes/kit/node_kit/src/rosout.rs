//! Log lines on `/rosout`, published between the steps of a node.

use crate::bus::Bus;
use crate::bus_error::{BusError, tolerate_full};
use crate::logging::Logger;
use crate::typed::Publisher;
use grainlab_msgs::rcl_interfaces::Log;
use grainlab_msgs::topics;

/// Publishes the lines of the logger in the order of their stamps.
pub(crate) struct Rosout {
    publisher: Publisher<Log>,
    logger: Option<&'static Logger>,
}

impl Rosout {
    pub(crate) fn advertise(bus: &mut dyn Bus, logger: Option<&'static Logger>) -> Result<Self, BusError> {
        Ok(Self { publisher: Publisher::advertise(bus, &topics::ROSOUT)?, logger })
    }

    /// Publishes the queued lines.
    pub(crate) fn tend(&self, bus: &mut dyn Bus) -> Result<(), BusError> {
        let Some(logger) = self.logger else { return Ok(()) };
        logger.publish(|line| tolerate_full(self.publisher.publish(bus, line)))
    }

    /// Publishes the last lines; those that follow go to stderr alone.
    pub(crate) fn close(&self, bus: &mut dyn Bus) -> Result<(), BusError> {
        if let Some(logger) = self.logger {
            logger.close();
        }
        self.tend(bus)
    }
}
