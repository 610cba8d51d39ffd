//! Participants that are announced and do not exist: a program of another maker that fills the tables of discovery.

use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time between the announcement of a participant and the announcement of its reader, which is ignored before.
const BETWEEN: Duration = Duration::from_millis(1);

/// A crowd on a thread of its own, which announces its members one after the other, again and again until it is dropped. Each has one
/// reader of `/stress` and a lease of a quarter of an hour.
#[derive(Debug)]
pub struct Crowd {
    /// Rounds that are complete; `u32::MAX` asks for the end.
    rounds: Arc<AtomicU32>,
    thread: Option<JoinHandle<()>>,
}

impl Crowd {
    /// Starts to announce `members` participants on loopback, `per_second` of them each second. A round begins `period` after the one
    /// before, or at its end.
    pub fn start(domain: u16, members: u16, per_second: f64, period: Duration) -> Self {
        let rounds = Arc::new(AtomicU32::new(0));
        let complete = Arc::clone(&rounds);
        let pause = Duration::from_secs_f64(1.0 / per_second).saturating_sub(BETWEEN);
        let thread = std::thread::spawn(move || {
            // Multicast leaves by the interface of the address.
            let socket = UdpSocket::bind("127.0.0.1:0").unwrap_or_else(|e| panic!("no socket: {e}"));
            let group = ("239.255.0.1", 7400 + 250 * domain);
            let send = |datagram: &[u8]| {
                // A full buffer drops a datagram, which the next round repeats.
                let _ = socket.send_to(datagram, group);
            };
            let is_over = || complete.load(Ordering::Relaxed) == u32::MAX;
            for round in 1.. {
                let begin = Instant::now();
                for member in 0..members {
                    send(&participant(member, round));
                    std::thread::sleep(BETWEEN);
                    send(&reader(member));
                    std::thread::sleep(pause);
                    if is_over() {
                        return;
                    }
                }
                let _ = complete.compare_exchange(round - 1, round, Ordering::Relaxed, Ordering::Relaxed);
                while begin.elapsed() < period && !is_over() {
                    std::thread::sleep(BETWEEN);
                }
            }
        });
        Self { rounds, thread: Some(thread) }
    }

    /// Number of times that all members were announced.
    pub fn rounds(&self) -> u32 {
        self.rounds.load(Ordering::Relaxed)
    }
}

impl Drop for Crowd {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            self.rounds.store(u32::MAX, Ordering::Relaxed);
            assert!(thread.join().is_ok(), "the crowd panicked");
        }
    }
}

/// The GUID prefix of a member, as eProsima numbers its own.
fn prefix(member: u16) -> [u8; 12] {
    let [high, low] = member.to_be_bytes();
    [0x01, 0x0f, 0xc4, 0x07, 0xd0, 0, 0, 0, 0, 0, high, low]
}

/// A parameter of a list (RTPS 9.4.2.11).
fn parameter(id: u8, value: &[u8]) -> Vec<u8> {
    let mut padded = value.to_vec();
    padded.resize(value.len().next_multiple_of(4), 0);
    [&[id, 0, padded.len() as u8, 0][..], &padded].concat()
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32 + 1).to_le_bytes()[..], text.as_bytes(), &[0]].concat()
}

/// A message with one sample from a built-in writer (RTPS 8.5) to the readers of the same kind.
fn sample(member: u16, writer: [u8; 4], sequence: u32, parameters: &[Vec<u8>]) -> Vec<u8> {
    let reader = [writer[0], writer[1], writer[2], 0xc7];
    let payload = [&[0, 3, 0, 0][..], &parameters.concat(), &[1, 0, 0, 0]].concat();
    let ids = [&[0, 0, 16, 0][..], &reader, &writer, &[0; 4], &sequence.to_le_bytes()].concat();
    let length = (ids.len() + payload.len()) as u16;
    let header = [&b"RTPS\x02\x03\x01\x0f"[..], &prefix(member), &[0x15, 5]].concat();
    [&header[..], &length.to_le_bytes(), &ids, &payload].concat()
}

/// Announces a participant, which listens on a port that nobody has.
fn participant(member: u16, sequence: u32) -> Vec<u8> {
    let guid = [&prefix(member)[..], &[0, 0, 1, 0xc1]].concat();
    let locator = [&[1, 0, 0, 0, 1, 0, 0, 0][..], &[0; 12], &[127, 0, 0, 1]].concat();
    let parameters = [
        parameter(0x15, &[2, 3, 0, 0]),
        parameter(0x16, &[0x01, 0x0f, 0, 0]),
        parameter(0x50, &guid),
        parameter(0x58, &[0x3f, 0x0c, 0, 0]),
        parameter(0x32, &locator),
        parameter(0x31, &locator),
        parameter(0x02, &[&900_u32.to_le_bytes()[..], &[0; 4]].concat()),
    ];
    sample(member, [0, 1, 0, 0xc2], sequence, &parameters)
}

/// Announces its reader.
fn reader(member: u16) -> Vec<u8> {
    let participant = prefix(member);
    let parameters = [
        parameter(0x5a, &[&participant[..], &[0, 0, 1, 0x04]].concat()),
        parameter(0x50, &[&participant[..], &[0, 0, 1, 0xc1]].concat()),
        parameter(0x05, &text("rt/stress")),
        parameter(0x07, &text("grainlab_msgs::msg::dds_::Stress_")),
    ];
    sample(member, [0, 0, 4, 0xc2], 1, &parameters)
}
