//! The network that all buses of one test share.

use super::bus::MemoryBus;
use super::faults::Faults;
use super::state::MemoryState;
use crate::admission::Participant;
use crate::identity::Identity;
use crate::names::Names;
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

/// A network in memory. Cloning gives another handle to the same one.
#[derive(Clone, Debug)]
pub struct Hub {
    state: Rc<RefCell<MemoryState>>,
}

impl Hub {
    /// An empty network at time zero. The faults follow from the seed.
    pub fn new(seed: u64) -> Self {
        Self { state: Rc::new(RefCell::new(MemoryState::new(seed))) }
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

    /// Virtual time since the start.
    pub fn now(&self) -> Duration {
        self.state.borrow().now
    }

    /// Advances virtual time.
    pub fn advance(&self, time: Duration) {
        self.state.borrow_mut().now += time;
    }

    /// Sets the wall clock forward or back; the monotonic time does not change.
    pub fn set_wall_clock(&self, forward_nanos: i64) {
        self.state.borrow_mut().wall_offset += forward_nanos;
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
