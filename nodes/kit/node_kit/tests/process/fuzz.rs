//! Mutated and forged datagrams to every port of the domain: memory stays bounded, exchanges continue, and
//! processes end when stopped.
//!
//! `NODE_KIT_FUZZ=100000` sends this number instead of a few thousand.

use super::flood::{flood, learn, overheard, ports};
use super::rtps::{Datagram, ports_in_use, send, sniffer};
use super::{Role, TIME_LIMIT, claim};
use grainlab_buskit::pingpong::bus_ping;
use grainlab_node_kit::{DdsBus, Names, Network};
use std::net::{Ipv4Addr, UdpSocket};
use std::time::{Duration, Instant};

/// Maximum resident memory of the process under attack.
const MEMORY_MB: u64 = 200;

/// Default number of datagrams.
const FEW: usize = 6000;

/// Time for the process to end after SIGINT.
const END: Duration = Duration::from_secs(15);

/// Kilobytes of a line of `/proc/PID/status`.
fn memory_mb(pid: u32, line: &str) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap();
    let found = status.lines().find(|l| l.starts_with(line)).unwrap();
    found.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() / 1024
}

fn asks(network: Network, name: &str) -> DdsBus {
    let mut bus = DdsBus::open(network, Names::new(name).unwrap()).unwrap();
    assert_eq!(bus_ping(&mut bus, 20).unwrap().len(), 20, "{name} is not answered");
    bus
}

#[test]
fn forged_heartbeats_gaps_and_fragments_cost_no_sample() {
    let claimed = claim();
    let network = claimed.network();
    let victim = Role::start("victim", network);
    let listener = Role::start("our_listener", network);
    let mut partner = asks(network, "partner");
    std::thread::sleep(Duration::from_secs(1));
    let exchanges = bus_ping(&mut partner, 200).unwrap().len();
    assert_eq!(exchanges, 200);
    let (_, writers) = learn(network.domain);
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let first = 7400 + 250 * network.domain;
    for port in ports_in_use(first..first + 250) {
        for (prefix, writer) in &writers {
            let writer = *writer;
            let forged = [
                Datagram::from(prefix).heartbeat(writer, 1, 1 << 40, 1_000_000),
                Datagram::from(prefix).gap(writer, 1, 200_000_000, 0),
                Datagram::from(prefix).data_frag(writer, 1_000_000, 1, 1024, 2_000_000_000),
                Datagram::from(prefix).data_frag(writer, 1_000_000, 1, 1024, 16 << 20),
            ];
            for datagram in forged {
                send(&socket, &datagram.0, port);
            }
        }
    }
    assert_eq!(bus_ping(&mut partner, 200).unwrap().len(), 200, "the exchange goes on");
    let peak = memory_mb(victim.child.id(), "VmHWM:").max(memory_mb(listener.child.id(), "VmHWM:"));
    assert!(peak < MEMORY_MB, "{peak} MB");
    let (code, out, err) = listener.end();
    assert_eq!(code, Some(0), "{err}");
    // Two topics, two rounds since the process has joined.
    let received = out.split("received ").nth(1).and_then(|r| r.split_whitespace().next()).unwrap();
    assert!(received.parse::<usize>().unwrap() >= 4 * exchanges, "{out}");
    assert!(out.contains("missing 0"), "{out}");
}

#[test]
fn mutated_and_forged_datagrams_take_no_memory_and_end_nothing() {
    let datagrams = std::env::var("NODE_KIT_FUZZ").map_or(FEW, |n| n.parse().unwrap());
    let claimed = claim();
    let network = claimed.network();
    let sniffer = sniffer(ports(network.domain));
    if sniffer.is_none() {
        eprintln!("no right to hear packets: forged datagrams only, no mutated ones");
    }
    let victim = Role::start("victim", network);
    let mut partner = asks(network, "partner");
    let originals = overheard(sniffer.as_ref(), network.domain);
    assert!(sniffer.is_none() || originals.len() > 50, "{} heard", originals.len());
    let (readers, writers) = learn(network.domain);
    assert!(readers.len() > 5 && writers.len() > 5, "{} readers, {} writers", readers.len(), writers.len());

    flood(network.domain, datagrams, &originals, &readers, &writers);

    let pid = victim.child.id();
    let peak = memory_mb(pid, "VmHWM:");
    assert!(peak < MEMORY_MB, "the victim took {peak} MB");
    // Forged announcements may have separated two processes that knew each other; DDS has no protection
    // against that. A process that joins later is not affected.
    let begin = Instant::now();
    asks(network, "newcomer");
    let newcomer = begin.elapsed();
    let begin = Instant::now();
    let again = bus_ping(&mut partner, 20).unwrap().len();
    eprintln!(
        "{datagrams} datagrams: peak {peak} MB; newcomer served after {newcomer:.1?}, partner {again} of 20 after {:.1?}",
        begin.elapsed()
    );

    let begin = Instant::now();
    victim.signal(libc::SIGINT);
    let (code, _, stderr) = victim.end();
    assert!(begin.elapsed() < END, "it ended after {:?}", begin.elapsed());
    assert_eq!(code, Some(0), "{stderr}");
    if let Ok(path) = std::env::var("NODE_KIT_FUZZ_LOG") {
        std::fs::write(path, &stderr).unwrap();
    }
    assert!(stderr.lines().count() < 2000, "{} lines in its log", stderr.lines().count());
    assert!(END < TIME_LIMIT);
}
