//! A process outside the run that publishes forged messages on its topics: a second servo, an analyzer with
//! other results, an old latched result.

use crate::forgery::Forgery;
use crate::stranger::Stranger;
use grainlab_node_kit::{Bus, DdsBus, Names, Network};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// A forger over DDS, on a thread with its own participant; it leaves when it is dropped.
#[derive(Debug)]
pub struct Forger {
    stop: Arc<AtomicBool>,
    sent: Arc<AtomicU64>,
    thread: Option<JoinHandle<()>>,
}

impl Forger {
    /// Starts the forger in this domain on loopback. It publishes `first` once, and then forges every message.
    ///
    /// # Panics
    /// In its thread, if it has no bus.
    pub fn start(domain: u16, forgery: Forgery, first: Option<Vec<u8>>) -> Self {
        let (stop, sent) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
        let (asked, count) = (Arc::clone(&stop), Arc::clone(&sent));
        let thread = std::thread::spawn(move || {
            let names = Names::new("forger").unwrap_or_else(|e| panic!("{e}"));
            let bus =
                DdsBus::open(Network::localhost(domain), names).unwrap_or_else(|e| panic!("no bus: {e}"));
            let own = bus.participant();
            let joined = Stranger::join(bus, forgery, move |writer| *writer != own, 1.0, domain.into());
            let mut stranger = joined.unwrap_or_else(|e| panic!("{e}"));
            if let Some(body) = first {
                stranger.publish(&body, None).unwrap_or_else(|e| panic!("{e}"));
            }
            while !asked.load(Ordering::Relaxed) {
                // The rate is limited: flooding is a different fault. A full reader misses a message.
                let _ = stranger.publish_early();
                let _ = stranger.step();
                count.store(stranger.forged, Ordering::Relaxed);
                stranger.bus.wait(Duration::from_millis(20));
            }
        });
        Self { stop, sent, thread: Some(thread) }
    }

    /// Returns the number of messages forged so far.
    pub fn sent(&self) -> u64 {
        self.sent.load(Ordering::Relaxed)
    }
}

impl Drop for Forger {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            assert!(thread.join().is_ok(), "the forger panicked");
        }
    }
}
