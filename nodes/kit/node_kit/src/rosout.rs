//! Log lines on `/rosout`: published while the node computes, too.

use crate::bus::{Bus, Sender};
use crate::bus_error::BusError;
use crate::logging::Logger;
use crate::typed::Publisher;
use grainlab_msgs::rcl_interfaces::Log;
use grainlab_msgs::{to_cdr, topics};
use std::thread::JoinHandle;

/// Publishes the lines of the logger in the order of their stamps: at once, by a thread of its own, or by
/// [`Rosout::tend`] on a bus without [`Bus::sender`].
pub(crate) struct Rosout {
    publisher: Publisher<Log>,
    logger: Option<&'static Logger>,
    /// `None` without a sender, and after its end.
    thread: Option<JoinHandle<Result<(), BusError>>>,
}

impl Rosout {
    /// Advertises `/rosout` and publishes every line from now on, and those that are queued.
    pub(crate) fn start(bus: &mut dyn Bus, logger: Option<&'static Logger>) -> Result<Self, BusError> {
        let publisher = Publisher::advertise(bus, &topics::ROSOUT)?;
        let thread = match (logger, bus.sender(publisher.id())) {
            (Some(logger), Some(sender)) => {
                let thread = std::thread::Builder::new().name("rosout".into());
                let spawned = thread.spawn(move || publish_all(logger, &sender));
                let error = |e: std::io::Error| BusError::Network {
                    what: "start the thread of /rosout".into(),
                    reason: e.to_string(),
                };
                Some(spawned.map_err(error)?)
            }
            _ => None,
        };
        Ok(Self { publisher, logger, thread })
    }

    /// Publishes what is queued where no thread does, and returns the error of a thread that failed.
    pub(crate) fn tend(&mut self, bus: &mut dyn Bus) -> Result<(), BusError> {
        if self.thread.as_ref().is_some_and(|thread| !thread.is_finished()) {
            return Ok(());
        }
        self.join()?;
        let Some(logger) = self.logger else { return Ok(()) };
        logger.drain().iter().try_for_each(|line| tolerate_full(self.publisher.publish(bus, line)))
    }

    /// Publishes the last lines; those that follow go to stderr alone.
    pub(crate) fn close(&mut self, bus: &mut dyn Bus) -> Result<(), BusError> {
        if let Some(logger) = self.logger {
            logger.close();
        }
        self.join()?;
        self.tend(bus)
    }

    fn join(&mut self) -> Result<(), BusError> {
        self.thread.take().map_or(Ok(()), |thread| {
            thread.join().unwrap_or_else(|_| {
                log::error!("the thread of /rosout panicked");
                Ok(())
            })
        })
    }
}

impl Drop for Rosout {
    /// A writer must not outlast its bus, and the thread has one.
    fn drop(&mut self) {
        if self.thread.is_some() {
            if let Some(logger) = self.logger {
                logger.close();
            }
            if let Err(error) = self.join() {
                log::error!("{error}");
            }
        }
    }
}

fn publish_all(logger: &Logger, sender: &Sender) -> Result<(), BusError> {
    while let Some(lines) = logger.wait_for_lines() {
        lines.iter().try_for_each(|line| tolerate_full(sender.publish(&to_cdr(line))))?;
    }
    Ok(())
}

/// A crashed reader must not end the node: the bus counts what it could not send.
pub(crate) fn tolerate_full(published: Result<i64, BusError>) -> Result<(), BusError> {
    match published {
        Ok(_) | Err(BusError::Full { .. }) => Ok(()),
        Err(error) => Err(error),
    }
}
