//! The bus in memory, the run loop and large messages, in virtual time.

mod bulk;
mod bus;
mod drive;

use grainlab_node_kit::{Hub, MemoryBus, Names};
use std::time::Duration;

const MS: Duration = Duration::from_millis(1);

/// The bus of a node in the namespace `/lab`.
fn bus_of(hub: &Hub, node: &str) -> MemoryBus {
    hub.bus(Names::in_namespace(node, "/lab").unwrap())
}
