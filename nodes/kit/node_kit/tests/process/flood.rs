//! Mutated and forged datagrams to every port of a domain on loopback.

use super::rtps::{Datagram, Random, heard, mutated, ports_in_use, send};
use grainlab_node_kit::Network;
use std::net::{Ipv4Addr, UdpSocket};
use std::os::fd::OwnedFd;
use std::time::Duration;

/// Numbers that a forged packet may contain.
const CLAIMS: [i64; 9] = [-1, 0, 1, 2, 300, 1 << 20, 200_000_000, 1 << 40, i64::MAX];

/// Endpoints of the domain, as 12 and 4 bytes.
pub(super) type Endpoint = ([u8; 12], [u8; 4]);

/// Readers and writers of a domain on loopback, from discovery.
pub(super) fn learn(domain: u16) -> (Vec<Endpoint>, Vec<Endpoint>) {
    let context = Network::localhost(domain).context().unwrap();
    let spy = context.domain_participant();
    std::thread::sleep(Duration::from_secs(2));
    let split = |bytes: [u8; 16]| (bytes[..12].try_into().unwrap(), bytes[12..].try_into().unwrap());
    let discovered = spy.discovered_writers();
    let mut writers: Vec<Endpoint> =
        discovered.iter().map(|w| split(w.writer_proxy.remote_writer_guid.to_bytes())).collect();
    let discovered = spy.discovered_readers();
    let mut readers: Vec<Endpoint> =
        discovered.iter().map(|r| split(r.reader_proxy.remote_reader_guid.to_bytes())).collect();
    // Built-in endpoints have the same identifiers everywhere.
    for (prefix, _) in writers.clone() {
        for (writer, reader) in [([0, 0, 3, 0xc2], [0, 0, 3, 0xc7]), ([0, 0, 4, 0xc2], [0, 0, 4, 0xc7])] {
            writers.push((prefix, writer));
            readers.push((prefix, reader));
        }
        writers.push((prefix, [0, 1, 0, 0xc2]));
    }
    (readers, writers)
}

/// One forged datagram with existing identities.
fn forged(readers: &[Endpoint], writers: &[Endpoint], random: &mut Random) -> Vec<u8> {
    let (prefix, writer) = random.of(writers);
    let (reader_prefix, reader) = random.of(readers);
    let claim = random.of(&CLAIMS);
    let any = random.next() as i32;
    let count = random.of(&[1, 7, i32::MAX, any]);
    let datagram = Datagram::from(&prefix);
    match random.below(8) {
        0 => datagram.heartbeat(writer, 1, claim, count),
        1 => datagram.heartbeat(writer, random.of(&CLAIMS), claim, count),
        2 => datagram.gap(writer, random.of(&CLAIMS), claim, random.of(&[0, 256, 300])),
        3 => datagram.data(writer, claim, &[0, 1, 0, 0, 1, 2, 3, 4]),
        4 => {
            datagram.data_frag(writer, claim, 1, 1024, random.of(&[1025, 16 << 20, 2_000_000_000, u32::MAX]))
        }
        5 => datagram.data_frag(writer, random.next() as i64 >> 40, 1, 1, random.of(&[2, 1 << 24])),
        6 => Datagram::from(&reader_prefix).acknack(reader, writer, claim, random.of(&[0, 1, 256]), count),
        _ => Datagram::from(&reader_prefix).nack_frag(
            reader,
            writer,
            random.of(&[1, 2, 3]),
            claim as u32,
            count,
        ),
    }
    .0
}

/// Ports that RTPS gives to a domain.
pub(super) fn ports(domain: u16) -> std::ops::Range<u16> {
    let first = 7400 + 250 * domain;
    first..first + 250
}

/// Datagrams of other processes in the domain that are queued in this socket; none without the right to
/// capture.
pub(super) fn overheard(sniffer: Option<&OwnedFd>, domain: u16) -> Vec<Vec<u8>> {
    std::iter::from_fn(|| sniffer.and_then(|s| heard(s, ports(domain)))).collect()
}

/// Sends `count` datagrams, every second one a mutated original if there are any, to the ports in use, about
/// 20,000 per second.
///
/// # Panics
/// If no port of the domain is in use.
pub(super) fn flood(
    domain: u16,
    datagrams: usize,
    originals: &[Vec<u8>],
    readers: &[Endpoint],
    writers: &[Endpoint],
) {
    let targets = ports_in_use(ports(domain));
    assert!(targets.len() >= 4, "{targets:?}");
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let random = &mut Random(0x9e37_79b9_7f4a_7c15);
    for i in 0..datagrams {
        let datagram = if i % 2 == 0 && !originals.is_empty() {
            mutated(&originals[random.below(originals.len())], random)
        } else {
            forged(readers, writers, random)
        };
        send(&socket, &datagram, random.of(&targets));
        if i % 100 == 99 {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}
