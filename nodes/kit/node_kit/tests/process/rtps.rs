//! RTPS datagrams built by hand (RTPS 2.5, section 9.4), and those captured from other processes.

use std::net::UdpSocket;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd};

/// A reproducible random number generator (xorshift).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    pub(super) fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }

    pub(super) fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }
}

/// A datagram under construction.
pub(super) struct Datagram(pub(super) Vec<u8>);

impl Datagram {
    /// The header, with the GUID prefix of the claimed sender.
    pub(super) fn from(prefix: &[u8]) -> Self {
        let mut bytes = b"RTPS\x02\x04\x01\x12".to_vec();
        bytes.extend_from_slice(prefix);
        Self(bytes)
    }

    fn submessage(mut self, kind: u8, flags: u8, body: &[u8]) -> Self {
        self.0.extend_from_slice(&[kind, flags | 1]);
        self.0.extend_from_slice(&(body.len() as u16).to_le_bytes());
        self.0.extend_from_slice(body);
        self
    }

    pub(super) fn heartbeat(self, writer: [u8; 4], first: i64, last: i64, count: i32) -> Self {
        let body = [&[0; 4][..], &writer, &sequence(first), &sequence(last), &count.to_le_bytes()].concat();
        self.submessage(0x07, 0, &body)
    }

    pub(super) fn gap(self, writer: [u8; 4], start: i64, base: i64, bits: u32) -> Self {
        let body = [&[0; 4][..], &writer, &sequence(start), &sequence(base), &number_set(bits)].concat();
        self.submessage(0x08, 0, &body)
    }

    pub(super) fn data(self, writer: [u8; 4], number: i64, payload: &[u8]) -> Self {
        let body = [&[0, 0, 16, 0][..], &[0; 4], &writer, &sequence(number), payload].concat();
        self.submessage(0x15, 0x04, &body)
    }

    pub(super) fn data_frag(
        self,
        writer: [u8; 4],
        number: i64,
        fragment: u32,
        size: u16,
        whole: u32,
    ) -> Self {
        let mut body = [&[0, 0, 28, 0][..], &[0; 4], &writer, &sequence(number)].concat();
        body.extend_from_slice(&fragment.to_le_bytes());
        body.extend_from_slice(&1u16.to_le_bytes());
        body.extend_from_slice(&size.to_le_bytes());
        body.extend_from_slice(&whole.to_le_bytes());
        body.resize(body.len() + usize::from(size), 7);
        self.submessage(0x16, 0, &body)
    }

    pub(super) fn acknack(self, reader: [u8; 4], writer: [u8; 4], base: i64, bits: u32, count: i32) -> Self {
        let body = [&reader[..], &writer, &sequence(base), &number_set(bits), &count.to_le_bytes()].concat();
        self.submessage(0x06, 0, &body)
    }

    pub(super) fn nack_frag(
        self,
        reader: [u8; 4],
        writer: [u8; 4],
        number: i64,
        base: u32,
        count: i32,
    ) -> Self {
        let body = [
            &reader[..],
            &writer,
            &sequence(number),
            &base.to_le_bytes(),
            &number_set(256),
            &count.to_le_bytes(),
        ]
        .concat();
        self.submessage(0x12, 0, &body)
    }
}

fn sequence(number: i64) -> [u8; 8] {
    let mut bytes = [0; 8];
    bytes[..4].copy_from_slice(&((number >> 32) as i32).to_le_bytes());
    bytes[4..].copy_from_slice(&(number as u32).to_le_bytes());
    bytes
}

/// Count and bitmap of a number set, all bits set.
fn number_set(bits: u32) -> Vec<u8> {
    let mut bytes = bits.to_le_bytes().to_vec();
    bytes.resize(4 + 4 * bits.div_ceil(32).min(16) as usize, 0xff);
    bytes
}

/// A copy with some bytes changed, cut short or made longer.
pub(super) fn mutated(original: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for _ in 0..=random.below(6) {
        // The magic is kept: a datagram without it is ignored.
        let place = 4 + random.below(bytes.len().saturating_sub(4));
        let Some(byte) = bytes.get_mut(place) else { break };
        *byte = match random.below(4) {
            0 => 0,
            1 => 0xff,
            2 => *byte ^ (1 << random.below(8)),
            _ => random.next() as u8,
        };
    }
    match random.below(10) {
        0 => bytes.truncate(random.below(bytes.len())),
        1 => bytes.extend((0..random.below(200)).map(|i| i as u8)),
        _ => {}
    }
    bytes
}

/// Captures the UDP datagrams that other processes send over loopback to these ports; `None` without the
/// right to.
pub(super) fn sniffer(ports: std::ops::Range<u16>) -> Option<OwnedFd> {
    const ALL: i32 = (libc::ETH_P_IP as u16).to_be() as i32;
    // SAFETY: a new socket or -1, nothing else.
    let socket = unsafe { libc::socket(libc::AF_PACKET, libc::SOCK_DGRAM | libc::SOCK_NONBLOCK, ALL) };
    // SAFETY: the descriptor is new and has no other owner.
    let socket = (socket >= 0).then(|| unsafe { OwnedFd::from_raw_fd(socket) })?;
    keep_ports(&socket, ports);
    Some(socket)
}

/// Lets the system drop everything but UDP to these ports: the traffic of other domains would fill the
/// socket.
fn keep_ports(socket: &OwnedFd, ports: std::ops::Range<u16>) {
    let line = |code: u32, jt, jf, k| libc::sock_filter { code: code as u16, jt, jf, k };
    let (load, indexed, jump) = (libc::BPF_LD, libc::BPF_IND, libc::BPF_JMP);
    let mut program = [
        line(load | libc::BPF_B | libc::BPF_ABS, 0, 0, 9),
        line(jump | libc::BPF_JEQ, 0, 5, 17),
        line(libc::BPF_LDX | libc::BPF_B | libc::BPF_MSH, 0, 0, 0),
        line(load | libc::BPF_H | indexed, 0, 0, 2),
        line(jump | libc::BPF_JGE, 0, 2, ports.start.into()),
        line(jump | libc::BPF_JGE, 1, 0, ports.end.into()),
        line(libc::BPF_RET, 0, 0, u32::MAX),
        line(libc::BPF_RET, 0, 0, 0),
    ];
    let filter = libc::sock_fprog { len: program.len() as u16, filter: program.as_mut_ptr() };
    // SAFETY: the program has the stated length, and is read before the call returns.
    let done = unsafe {
        libc::setsockopt(
            socket.as_raw_fd(),
            libc::SOL_SOCKET,
            libc::SO_ATTACH_FILTER,
            (&raw const filter).cast(),
            size_of_val(&filter) as u32,
        )
    };
    assert_eq!(done, 0, "{}", std::io::Error::last_os_error());
}

/// The payload of the next captured UDP datagram to one of `ports`, if any.
pub(super) fn heard(socket: &OwnedFd, ports: std::ops::Range<u16>) -> Option<Vec<u8>> {
    let mut frame = vec![0u8; 65_536];
    loop {
        // SAFETY: the buffer has the stated length.
        let length = unsafe { libc::recv(socket.as_raw_fd(), frame.as_mut_ptr().cast(), frame.len(), 0) };
        let length = usize::try_from(length).ok()?;
        let header = usize::from(frame[0] & 15) * 4;
        let is_udp = length > header + 8 && frame[9] == 17;
        if is_udp && ports.contains(&u16::from_be_bytes([frame[header + 2], frame[header + 3]])) {
            return Some(frame[header + 8..length].to_vec());
        }
    }
}

/// UDP ports in use on this host out of `ports`.
pub(super) fn ports_in_use(ports: std::ops::Range<u16>) -> Vec<u16> {
    let table = std::fs::read_to_string("/proc/net/udp").unwrap_or_default();
    let port = |line: &str| {
        let address = line.split_whitespace().nth(1)?;
        u16::from_str_radix(address.split_once(':')?.1, 16).ok()
    };
    let mut found: Vec<u16> = table.lines().filter_map(port).filter(|p| ports.contains(p)).collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// Sends one datagram to a port of this host; errors are ignored.
pub(super) fn send(socket: &UdpSocket, bytes: &[u8], port: u16) {
    let _ = socket.send_to(bytes, ("127.0.0.1", port));
}
