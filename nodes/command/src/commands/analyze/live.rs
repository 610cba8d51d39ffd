//! Packings from a live topic.

use super::measure::{Analysis, Found};
use crate::commands::packings::Measure;
use crate::commands::packings::outlet::Outlet;
use crate::commands::packings::sink::{Ending, Sink};
use grainlab_console::{Failure, worse};
use grainlab_core::Packing;
use grainlab_msgs::{Topic, from_cdr, msg, topics};
use grainlab_node_kit::{BulkSubscription, Bus, Demand, Exit, Wake, tool_bus};
use grainlab_recordings::import::Imported;
use std::time::Duration;

/// Packings in the queue while one is measured; megabytes each.
const BACKLOG: u32 = 64;

/// Only a packing or a signal ends the wait.
const IDLE: Duration = Duration::from_secs(3600);

/// Measures packings of `topic` until `count` are measured or a signal arrives. Without a count a signal is
/// the only end, and not an error.
pub(super) fn run(
    topic: &str,
    count: Option<u64>,
    measure: &Analysis,
    outlet: Outlet<Found>,
) -> Result<Exit, Failure> {
    let mut sink = Sink::new(outlet);
    let mut source = Source::subscribe(topic)?;
    let (mut taken, mut exit) = (0, Exit::Done);
    while count.is_none_or(|count| (taken as u64) < count) {
        match source.next()? {
            Next::Packing(imported) => {
                sink.put((0, taken), measure.measure(&source.name, &imported))?;
                taken += 1;
            }
            Next::Refused(reason) => {
                exit = worse(exit, Exit::Failure);
                grainlab_console::say!("grainlab: {}: {reason}", source.name);
            }
            Next::Signal => {
                exit = worse(exit, if count.is_some() { Exit::Interrupted } else { Exit::Done });
                break;
            }
        }
    }
    sink.end(0, Ending { packings: taken, complaints: Vec::new(), exit })?;
    sink.finish()
}

/// A received message.
enum Next {
    Packing(Box<Imported>),
    /// The message is not a valid packing, for this reason.
    Refused(String),
    Signal,
}

/// The subscription, for packings sent whole or in parts.
struct Source {
    bus: grainlab_node_kit::DdsBus,
    packings: BulkSubscription,
    name: String,
}

impl Source {
    fn subscribe(name: &str) -> Result<Self, Failure> {
        let mut bus = tool_bus("analyze")?;
        // Topics of the contract are static; this name must be, too.
        let topic = Topic { name: Box::leak(name.to_owned().into_boxed_str()), ..topics::PACKING };
        let packings = BulkSubscription::subscribe(&mut bus, &topic, Demand::reliable(BACKLOG))
            .map_err(Failure::usage)?;
        let name = packings.topic().to_owned();
        Ok(Self { bus, packings, name })
    }

    /// Waits for the next message or signal.
    fn next(&mut self) -> Result<Next, Failure> {
        loop {
            if let Some(sample) = self.packings.take(&mut self.bus).map_err(Failure::failed)? {
                return Ok(self.read(&sample.body).unwrap_or_else(|reason| {
                    self.bus.count_refused(self.packings.id());
                    Next::Refused(reason)
                }));
            }
            let patience = self.packings.patience(self.bus.now()).min(IDLE);
            if self.bus.wait(patience) == Wake::Shutdown {
                return Ok(Next::Signal);
            }
        }
    }

    fn read(&self, body: &[u8]) -> Result<Next, String> {
        let message: msg::Packing = from_cdr(body).map_err(|e| e.to_string())?;
        let packing = Packing::try_from(&message).map_err(|e| e.to_string())?;
        Ok(Next::Packing(Box::new(Imported {
            step: packing.step,
            packing,
            header: message.header,
            run_state: message.run_state,
            source: self.name.clone(),
            notes: Vec::new(),
        })))
    }
}
