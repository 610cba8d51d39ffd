//! The network that all buses of one process share.

use super::alarm::Alarm;
use super::bus::MemoryBus;
use super::faults::Faults;
use super::state::MemoryState;
use super::time::Time;
use crate::admission::Participant;
use crate::identity::Identity;
use crate::names::Names;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A network in memory. Cloning gives another handle to the same one.
#[derive(Clone, Debug)]
pub struct Hub {
    state: Rc<RefCell<MemoryState>>,
}

impl Hub {
    /// An empty network at virtual time zero. The faults follow from the seed.
    pub fn new(seed: u64) -> Self {
        Self::with(seed, Time::default())
    }

    /// An empty network with the clocks of this host. Computations end early once `stop` is true.
    pub fn real_time(stop: Arc<AtomicBool>) -> Self {
        Self::with(0, Time::real(Alarm::new(stop)))
    }

    fn with(seed: u64, time: Time) -> Self {
        Self { state: Rc::new(RefCell::new(MemoryState::new(seed, time))) }
    }

    /// Waits in real time until a worker thread calls, the user asks to stop, or `time` has passed, 50 ms at most.
    pub(crate) fn wait(&self, time: Duration) {
        let alarm = self.state.borrow().time.alarm().cloned();
        alarm.inspect(|alarm| alarm.wait(time));
    }

    /// True once after a call of a worker thread.
    pub(crate) fn was_called(&self) -> bool {
        self.state.borrow().time.alarm().is_some_and(|alarm| alarm.was_called())
    }

    /// A new participant for one node. Dropping it acts as a clean exit and as a crash.
    pub fn bus(&self, names: Names) -> MemoryBus {
        self.bus_as(names, Identity::default())
    }

    /// A new participant with this identity instead of that of a tool.
    pub fn bus_as(&self, names: Names, identity: Identity) -> MemoryBus {
        self.state.borrow_mut().participants += 1;
        let participant = participant_of(&identity, self.state.borrow().participants);
        MemoryBus::new(Rc::clone(&self.state), participant, names, identity)
    }

    /// Faults of one topic, by its resolved name, from now on.
    pub fn set_faults(&self, topic: &str, faults: Faults) {
        self.state.borrow_mut().faults.insert(topic.into(), faults);
    }

    /// Time since the start.
    pub fn now(&self) -> Duration {
        self.state.borrow().time.now()
    }

    /// Advances virtual time.
    pub fn advance(&self, time: Duration) {
        let later = self.now() + time;
        self.state.borrow_mut().time.advance_to(later);
    }

    /// Sets the wall clock of virtual time forward or back; the monotonic time does not change.
    pub fn set_wall_clock(&self, forward_nanos: i64) {
        self.state.borrow_mut().time.wall_offset += forward_nanos;
    }

    /// Time of the next arrival of a sample in transit, if any.
    pub fn next_arrival(&self) -> Option<Duration> {
        self.state.borrow().next_arrival()
    }
}

/// The GUID prefix of the `number`th participant: as on the real bus, but without random bytes.
fn participant_of(identity: &Identity, number: u32) -> Participant {
    let mut bytes = [0; 9];
    bytes[5..].copy_from_slice(&number.to_be_bytes());
    identity.guid_prefix_with(bytes)
}
