//! The thread that answers services while the node computes.

use super::servers::NodeServers;
use super::sim_time::{ClockReader, SimTime};
use crate::bus_error::{BusError, create_error};
use crate::parameters::Parameters;
use mio::{Events, Poll, Token, Waker};
use ros2_client::Node;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

const REQUESTS: Token = Token(0);
const CLOCK: Token = Token(1);
const STOP: Token = Token(2);

/// Answers the services of one node until this is dropped.
pub(crate) struct ServiceThread {
    stop: Arc<AtomicBool>,
    waker: Waker,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl ServiceThread {
    pub(crate) fn start(
        node: &Arc<Mutex<Node>>,
        declared: Parameters,
        time: SimTime,
    ) -> Result<Self, BusError> {
        let io = |e: std::io::Error| create_error("service thread", &e);
        let clock = ClockReader::new(node, declared.clone(), time);
        let mut servers = NodeServers::new(node, declared)?;
        let poll = Poll::new().map_err(io)?;
        servers.register(poll.registry(), REQUESTS).map_err(io)?;
        let waker = Waker::new(poll.registry(), STOP).map_err(io)?;
        let stop = Arc::new(AtomicBool::new(false));
        let its = Arc::clone(&stop);
        let thread = std::thread::Builder::new()
            .name("ROS services".into())
            .spawn(move || serve(&servers, clock, poll, &its))
            .map_err(io)?;
        Ok(Self { stop, waker, thread: Some(thread) })
    }
}

fn serve(servers: &NodeServers, mut clock: ClockReader, mut poll: Poll, stop: &AtomicBool) {
    let mut events = Events::with_capacity(16);
    while !stop.load(Ordering::Acquire) {
        // Requests that came before the registration raise no event.
        servers.answer();
        if let Err(error) = clock.update(poll.registry(), CLOCK) {
            log::error!("use_sim_time has no effect: {error}");
        }
        if let Err(error) = poll.poll(&mut events, None)
            && error.kind() != std::io::ErrorKind::Interrupted
        {
            log::error!("services ended: {error}");
            return;
        }
    }
}

impl Drop for ServiceThread {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        if let Err(error) = self.waker.wake() {
            log::error!("cannot wake the service thread: {error}");
        }
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            log::error!("the service thread panicked");
        }
    }
}
