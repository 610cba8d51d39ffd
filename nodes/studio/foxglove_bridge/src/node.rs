//! The node itself.

use crate::server::Server;
use crate::settings::BridgeSettings;
use crate::topics::Topics;
use grainlab_node_kit::{Bus, Exit, Health, Next, Node, NodeError};
use std::time::Duration;

/// Period at which topics are looked for.
const LOOK: Duration = Duration::from_millis(200);

/// The bridge: every topic of a known type is a channel, received while a client subscribes to it.
pub struct FoxgloveBridge {
    server: Server,
    topics: Topics,
    next_look: Duration,
}

impl FoxgloveBridge {
    /// Listens for clients.
    ///
    /// # Errors
    /// If the port is in use, the address is none of this host, or the system cannot start a thread.
    pub fn new(bus: &mut dyn Bus, settings: BridgeSettings) -> Result<Self, NodeError> {
        let BridgeSettings { address, port, definitions } = settings;
        let server = Server::start(address, port, bus.caller())
            .map_err(|e| NodeError::new(Exit::Failure, e.to_string()))?;
        let host = if address.is_ipv6() { format!("[{address}]") } else { address.to_string() };
        log::info!("listening on ws://{host}:{}", server.port());
        if !address.is_loopback() {
            log::warn!(
                "{address} is not of this host alone: without authentication, every program that reaches it reads all topics"
            );
        }
        Ok(Self { server, topics: Topics::new(definitions), next_look: Duration::ZERO })
    }

    /// The port that it listens on.
    pub fn port(&self) -> u16 {
        self.server.port()
    }
}

impl Node for FoxgloveBridge {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let now = bus.now();
        if now >= self.next_look {
            self.next_look = now + LOOK;
            self.topics.follow(bus, &self.server);
        }
        // Before new samples: a client that subscribed gets the latched ones first.
        for request in self.server.requests() {
            self.topics.answer(request);
        }
        self.topics.pass_on(bus)?;
        let now = bus.now();
        Ok(Next::Wait(self.next_look.saturating_sub(now).min(self.topics.patience(now))))
    }

    fn health(&self) -> Health {
        let (topics, received) = self.topics.counts();
        Health::ok(format!("{} clients, {received} of {topics} topics", self.server.clients()))
            .with("port", self.server.port())
            .with("clients", self.server.clients())
            .with("topics", topics)
            .with("subscribed", received)
            .with("samples", self.topics.samples)
    }
}
