//! Liveliness of processes by heartbeats: DDS keeps a crashed process matched for up to a minute.

use crate::bus::Bus;
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::sample::SampleInfo;
use crate::typed::Subscription;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::{Exit, Report, topics};
use std::collections::BTreeMap;
use std::time::Duration;

/// The period of heartbeats is 1 s. A node that computes sends none, so silence alone does not prove a crash.
pub const SILENCE: Duration = Duration::from_secs(5);

/// Maximum number of peers; beyond it, the one silent for longest is removed.
const KEPT: usize = 512;

/// Queue of heartbeats between two calls: one minute of all peers.
const BACKLOG: u32 = 512;

/// The known state of one process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Peer {
    /// Last report of the process.
    pub report: Report,
    /// The GUID prefix of its writers.
    pub participant: [u8; 12],
    /// Time of its last heartbeat, in [`Bus::now`].
    pub last_heard: Duration,
}

/// The liveliness of a peer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Liveliness {
    /// A heartbeat arrived within [`SILENCE`].
    Alive,
    /// No heartbeat for this long: it computes, or it has crashed.
    Silent(Duration),
    /// It has ended with this exit.
    Left(Exit),
}

impl Peer {
    /// Liveliness at `now`, in [`Bus::now`].
    pub fn liveliness(&self, now: Duration) -> Liveliness {
        let silent = now.saturating_sub(self.last_heard);
        match self.report.exit {
            Some(exit) => Liveliness::Left(exit),
            None if silent > SILENCE => Liveliness::Silent(silent),
            None => Liveliness::Alive,
        }
    }
}

/// All processes that publish on `/diagnostics`, this one included.
#[derive(Debug)]
pub struct PeerWatch {
    subscription: Subscription<DiagnosticArray>,
    by_participant: BTreeMap<[u8; 12], Peer>,
}

impl PeerWatch {
    /// Subscribes to `/diagnostics`.
    pub fn subscribe(bus: &mut dyn Bus) -> Result<Self, BusError> {
        let subscription = Subscription::subscribe(bus, &topics::DIAGNOSTICS, Demand::best_effort(BACKLOG))?;
        Ok(Self { subscription, by_participant: BTreeMap::new() })
    }

    /// Processes the heartbeats since the last call, and passes the origin and report of each sample to the
    /// caller.
    pub fn update(
        &mut self,
        bus: &mut dyn Bus,
        mut each: impl FnMut(&SampleInfo, &Report),
    ) -> Result<(), BusError> {
        while let Some((message, info)) = self.subscription.take_valid(bus)? {
            let last_heard = bus.now();
            for report in Report::from_message(&message) {
                each(&info, &report);
                let participant = info.writer.participant();
                if self.by_participant.len() >= KEPT && !self.by_participant.contains_key(&participant) {
                    self.forget_quietest();
                }
                self.by_participant.insert(participant, Peer { report, participant, last_heard });
            }
        }
        Ok(())
    }

    fn forget_quietest(&mut self) {
        let quietest = self.iter().min_by_key(|p| p.last_heard).map(|p| p.participant);
        if let Some(participant) = quietest {
            self.by_participant.remove(&participant);
        }
    }

    /// All peers, sorted by GUID.
    pub fn iter(&self) -> impl Iterator<Item = &Peer> {
        self.by_participant.values()
    }

    /// The peer with this fully qualified node name and the latest heartbeat: a restarted node replaces its
    /// predecessor.
    pub fn find(&self, node: &str) -> Option<&Peer> {
        self.iter().filter(|p| p.report.node == node).max_by_key(|p| p.last_heard)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::{Hub, MemoryBus};
    use crate::names::Names;
    use crate::typed::Publisher;
    use grainlab_msgs::Health;

    fn bus(hub: &Hub) -> MemoryBus {
        hub.bus(Names::new("servo").unwrap())
    }

    fn beat(hub: &Hub, bus: &mut MemoryBus, pid: u32, exit: Option<Exit>, at: u64) {
        hub.advance(Duration::from_secs(at) - hub.now());
        let (node, health) = ("/servo".into(), Health::default());
        let (published, received) = (Vec::new(), Vec::new());
        let report = Report { node, pid, health, exit, published, received };
        let publisher = Publisher::advertise(bus, &topics::DIAGNOSTICS).unwrap();
        publisher.publish(bus, &report.to_message(0)).unwrap();
    }

    #[test]
    fn a_peer_is_alive_then_silent_then_left() {
        let hub = Hub::new(1);
        let (mut reader, mut node) = (bus(&hub), bus(&hub));
        let mut watch = PeerWatch::subscribe(&mut reader).unwrap();
        beat(&hub, &mut node, 1, None, 10);
        watch.update(&mut reader, |_, _| {}).unwrap();
        let life =
            |watch: &PeerWatch, at| watch.find("/servo").map(|p| p.liveliness(Duration::from_secs(at)));
        assert_eq!(life(&watch, 15), Some(Liveliness::Alive));
        assert_eq!(life(&watch, 16), Some(Liveliness::Silent(Duration::from_secs(6))));
        beat(&hub, &mut node, 1, Some(Exit::Done), 20);
        watch.update(&mut reader, |_, _| {}).unwrap();
        assert_eq!(life(&watch, 100), Some(Liveliness::Left(Exit::Done)));
    }

    #[test]
    fn a_restarted_node_hides_its_predecessor() {
        let hub = Hub::new(1);
        let (mut reader, mut old, mut new) = (bus(&hub), bus(&hub), bus(&hub));
        let mut watch = PeerWatch::subscribe(&mut reader).unwrap();
        beat(&hub, &mut old, 9, None, 1);
        watch.update(&mut reader, |_, _| {}).unwrap();
        beat(&hub, &mut new, 3, None, 8);
        watch.update(&mut reader, |_, _| {}).unwrap();
        assert_eq!(watch.iter().count(), 2);
        assert_eq!(watch.find("/servo").map(|p| p.report.pid), Some(3));
    }
}
