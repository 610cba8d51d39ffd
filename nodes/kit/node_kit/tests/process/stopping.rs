//! A process that was stopped and continued (Ctrl-Z and fg, a debugger, job control) continues where it was.

use super::{Role, claim};
use grainlab_buskit::pingpong::bus_ping;
use grainlab_node_kit::{DdsBus, Names};
use std::time::Duration;

const EXCHANGES: u64 = 20;

#[test]
fn a_process_stopped_for_a_moment_still_exchanges() {
    // From before its participant exists to long after discovery; one process per moment.
    for moment in [0, 5, 20, 50, 120, 300, 1500] {
        let claimed = claim();
        let network = claimed.network();
        let child = Role::start("answerer", network);
        std::thread::sleep(Duration::from_millis(moment));
        stop_for(&child, 50);
        let mut bus = DdsBus::open(network, Names::new("asker").unwrap()).unwrap();
        let times = bus_ping(&mut bus, EXCHANGES).unwrap();
        assert_eq!(times.len() as u64, EXCHANGES, "stopped {moment} ms after its start");
        // Again while it exchanges, and for long enough that heartbeats are missed.
        stop_for(&child, 1500);
        let times = bus_ping(&mut bus, EXCHANGES).unwrap();
        assert_eq!(times.len() as u64, EXCHANGES, "stopped once more, {moment} ms");
    }
}

fn stop_for(child: &Role, millis: u64) {
    child.signal(libc::SIGSTOP);
    std::thread::sleep(Duration::from_millis(millis));
    child.signal(libc::SIGCONT);
}
