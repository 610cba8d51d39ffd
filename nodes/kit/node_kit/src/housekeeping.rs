//! Work of every node between its steps: heartbeats, log lines, and the check of the DDS threads.

use crate::bus::Bus;
use crate::bus_error::{BusError, tolerate_full};
use crate::logging::Logger;
use crate::node::Node;
use crate::rosout::Rosout;
use crate::typed::Publisher;
use crate::watchdog;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::{Exit, Guid, Published, Received, Report, topics};
use std::time::Duration;

/// Time between two heartbeats, and from the start to the first: `/diagnostics` keeps nothing for late joiners, and a
/// recorder that is not discovered yet would miss it and count it as lost.
pub const HEARTBEAT: Duration = Duration::from_secs(1);

/// Period at which a node that never waits updates its view of the graph.
const LOOK: Duration = Duration::from_millis(100);

/// Time for which an ending process waits for its readers' acknowledgements: a recorder that was suspended has some
/// megabytes to request again. A crashed one costs this time.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// Errors of the run loop.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The DDS threads of this process have ended or hang; the bus must not even be dropped, which would wait for them.
    #[error(transparent)]
    Dds(#[from] watchdog::DdsFailure),
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
}

/// Heartbeats, log lines and watchdog of one process.
pub(crate) struct Housekeeping {
    node_name: String,
    diagnostics: Publisher<DiagnosticArray>,
    diagnostics_writer: Option<Guid>,
    pub(crate) rosout: Rosout,
    next_beat: Duration,
    next_look: Duration,
    /// The domain was said to be full.
    crowded: bool,
}

impl Housekeeping {
    pub(crate) fn new(
        bus: &mut dyn Bus,
        node_name: &str,
        logger: Option<&'static Logger>,
    ) -> Result<Self, BusError> {
        let diagnostics = Publisher::advertise(bus, &topics::DIAGNOSTICS)?;
        let diagnostics_writer = bus.published().last().map(|p| p.writer);
        Ok(Self {
            node_name: node_name.into(),
            diagnostics,
            diagnostics_writer,
            rosout: Rosout::advertise(bus, logger)?,
            next_beat: bus.now() + HEARTBEAT,
            next_look: bus.now() + LOOK,
            crowded: false,
        })
    }

    /// Does the tasks that are due and returns the time until the next heartbeat.
    pub(crate) fn tend(&mut self, node: &mut dyn Node, bus: &mut dyn Bus) -> Result<Duration, DriveError> {
        self.rosout.tend(bus)?;
        let now = bus.now();
        if now >= self.next_beat {
            self.report(node, bus, None)?;
            watchdog::check()?;
            if !self.crowded
                && let Some(sentence) = bus.crowding()
            {
                self.crowded = true;
                log::warn!("{sentence}");
            }
            self.next_beat = now + HEARTBEAT;
        }
        Ok(self.next_beat.saturating_sub(now))
    }

    /// True if a node that never waits has to poll the bus, so that it follows the graph.
    pub(crate) fn look_due(&mut self, now: Duration) -> bool {
        let due = now >= self.next_look;
        if due {
            self.next_look = now + LOOK;
        }
        due
    }

    fn report(&self, node: &dyn Node, bus: &mut dyn Bus, exit: Option<Exit>) -> Result<(), BusError> {
        let (node, health) = (self.node_name.clone(), node.health());
        let (published, received) = (self.published(bus), received(bus));
        let report = Report { node, pid: std::process::id(), health, exit, published, received };
        let message = report.to_message(bus.node_nanos());
        tolerate_full(self.diagnostics.publish(bus, &message))
    }

    /// The statistics of writers. That of the reports includes the one that is about to be published.
    fn published(&self, bus: &dyn Bus) -> Vec<Published> {
        let mut published = bus.published();
        for writer in published.iter_mut().filter(|w| Some(w.writer) == self.diagnostics_writer) {
            writer.count += 1;
        }
        published
    }

    /// Publishes the last log lines, then the last report: nothing is published after it, so its counts are final.
    pub(crate) fn leave(&mut self, node: &dyn Node, bus: &mut dyn Bus, exit: Exit) -> Result<(), BusError> {
        log::info!("leaving: {exit}");
        self.rosout.close(bus)?;
        self.report(node, bus, Some(exit))?;
        bus.flush(LAST_WORDS);
        Ok(())
    }
}

/// The statistics of subscriptions, summed by topic.
fn received(bus: &dyn Bus) -> Vec<Received> {
    let mut received: Vec<Received> = Vec::new();
    for entry in bus.received() {
        match received.iter_mut().find(|r| r.topic == entry.topic) {
            Some(sum) => {
                sum.taken = sum.taken.max(entry.taken);
                sum.refused += entry.refused;
            }
            None => received.push(entry),
        }
    }
    received
}
