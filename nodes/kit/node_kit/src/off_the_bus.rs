//! Runs in one process, which tools on the bus cannot see: a mark of each on this host.

use std::os::linux::net::SocketAddrExt;
use std::os::unix::net::{SocketAddr, UnixDatagram};

/// Begin of the name of an abstract socket, which the kernel removes with its process.
const PREFIX: &str = "grainlab/one_process/";

/// The mark of this process, until it is dropped.
#[derive(Debug)]
pub struct OffTheBus {
    _mark: Option<UnixDatagram>,
}

impl OffTheBus {
    /// Marks this process. Without the mark, a tool does not name the run; nothing else depends on it.
    pub fn enter() -> Self {
        let name = format!("{PREFIX}{}", std::process::id());
        let socket = SocketAddr::from_abstract_name(name).and_then(|name| UnixDatagram::bind_addr(&name));
        Self { _mark: socket.ok() }
    }

    /// A sentence about the runs of this host that are not on any bus, if there are some.
    pub fn note() -> Option<String> {
        let sockets = std::fs::read_to_string("/proc/net/unix").unwrap_or_default();
        let pids: Vec<&str> = sockets.lines().filter_map(|l| Some(l.split_once(PREFIX)?.1)).collect();
        (!pids.is_empty()).then(|| {
            let (runs, pids) = (grainlab_console::count(pids.len(), "run"), pids.join(", "));
            format!("{runs} on this host in one process, not on the bus: no tool sees them (pid {pids})")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_off_the_bus_is_named_while_it_is_there() {
        let pid = std::process::id().to_string();
        let named = || OffTheBus::note().is_some_and(|note| note.contains(&pid));
        let mark = OffTheBus::enter();
        assert!(named());
        drop(mark);
        assert!(!named());
    }
}
