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
#[derive(Clone, Debug, Default)]
pub struct Peers {
    by_participant: BTreeMap<[u8; 12], Peer>,
}

impl Peers {
    /// Processes one heartbeat and returns its reports.
    pub fn receive(&mut self, message: &DiagnosticArray, info: &SampleInfo, now: Duration) -> Vec<Report> {
        let reports = Report::from_message(message);
        for report in &reports {
            let participant = info.writer.participant();
            if self.by_participant.len() >= KEPT && !self.by_participant.contains_key(&participant) {
                self.forget_quietest();
            }
            self.by_participant
                .insert(participant, Peer { report: report.clone(), participant, last_heard: now });
        }
        reports
    }

    fn forget_quietest(&mut self) {
        let quietest = self.by_participant.values().min_by_key(|p| p.last_heard).map(|p| p.participant);
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

    /// The peer that owns a writer.
    pub fn owner(&self, participant: [u8; 12]) -> Option<&Peer> {
        self.by_participant.get(&participant)
    }
}

/// [`Peers`] with a subscription to their heartbeats.
#[derive(Debug)]
pub struct PeerWatch {
    subscription: Subscription<DiagnosticArray>,
    peers: Peers,
}

impl PeerWatch {
    /// Subscribes to `/diagnostics`.
    pub fn subscribe(bus: &mut dyn Bus) -> Result<Self, BusError> {
        let subscription = Subscription::subscribe(bus, &topics::DIAGNOSTICS, Demand::best_effort(BACKLOG))?;
        Ok(Self { subscription, peers: Peers::default() })
    }

    /// Processes the heartbeats since the last call, and passes the origin and report of each sample to the
    /// caller.
    pub fn update(
        &mut self,
        bus: &mut dyn Bus,
        mut each: impl FnMut(&SampleInfo, &Report),
    ) -> Result<(), BusError> {
        while let Some((message, info)) = self.subscription.take_valid(bus)? {
            let now = bus.now();
            for report in self.peers.receive(&message, &info, now) {
                each(&info, &report);
            }
        }
        Ok(())
    }

    /// The known peers.
    pub fn peers(&self) -> &Peers {
        &self.peers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::Guid;
    use grainlab_msgs::Health;

    fn beat(pid: u32, exit: Option<Exit>) -> (DiagnosticArray, SampleInfo) {
        let report = Report {
            node: "/servo".into(),
            pid,
            health: Health::default(),
            exit,
            published: Vec::new(),
            received: Vec::new(),
        };
        let writer = Guid([pid as u8; 16]);
        (
            report.to_message(0),
            SampleInfo { writer, sequence: 1, source_time: None, received: 0, about: None },
        )
    }

    #[test]
    fn a_peer_is_alive_then_silent_then_left() {
        let mut peers = Peers::default();
        let (message, info) = beat(1, None);
        peers.receive(&message, &info, Duration::from_secs(10));
        let life = |peers: &Peers, at| peers.find("/servo").map(|p| p.liveliness(Duration::from_secs(at)));
        assert_eq!(life(&peers, 15), Some(Liveliness::Alive));
        assert_eq!(life(&peers, 16), Some(Liveliness::Silent(Duration::from_secs(6))));
        let (message, info) = beat(1, Some(Exit::Done));
        peers.receive(&message, &info, Duration::from_secs(20));
        assert_eq!(life(&peers, 100), Some(Liveliness::Left(Exit::Done)));
    }

    #[test]
    fn a_restarted_node_hides_its_predecessor() {
        let mut peers = Peers::default();
        for (pid, at) in [(9, 1), (3, 8)] {
            let (message, info) = beat(pid, None);
            peers.receive(&message, &info, Duration::from_secs(at));
        }
        assert_eq!(peers.iter().count(), 2);
        assert_eq!(peers.find("/servo").map(|p| p.report.pid), Some(3));
    }
}
