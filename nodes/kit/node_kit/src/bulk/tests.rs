//! Sender and receivers on a simulated network that loses, repeats, reorders and corrupts parts, in virtual time.

use super::limits::{LONGEST, SILENCE, STRIDE, WINDOW};
use super::part::{PartError, Shape, crc_of};
use super::receiver::Receiver;
use super::sender::Sender;
use crate::memory::Dice;
use grainlab_msgs::Guid;
use grainlab_msgs::msg::{PackingChunk, PackingCredit};
use std::time::Duration;

const MS: Duration = Duration::from_millis(1);
const SENDER: Guid = Guid([9; 16]);

fn body(seed: u64, length: usize) -> Vec<u8> {
    let mut dice = Dice::new(seed);
    let random = std::iter::repeat_with(|| dice.below(256) as u8);
    [0, 1, 0, 0].into_iter().chain(random).take(length).collect()
}

fn reader(name: u8) -> Guid {
    Guid([name; 16])
}

enum Packet {
    Part { to: Guid, from: Guid, part: PackingChunk },
    Credit { from: Guid, sequence: i64, credit: PackingCredit },
}

#[derive(Clone, Copy, Default)]
struct Weather {
    lost: f64,
    twice: f64,
    corrupt: f64,
    /// Longest delay, ms.
    delay: usize,
}

struct End {
    id: Guid,
    receiver: Receiver,
    sequence: i64,
    bodies: Vec<Vec<u8>>,
    faults: Vec<PartError>,
    suspended: bool,
}

struct World {
    now: Duration,
    dice: Dice,
    weather: Weather,
    sender: Sender,
    own: Guid,
    ends: Vec<End>,
    packets: Vec<(Duration, Packet)>,
    left: Vec<String>,
    most_ahead: u32,
    parts: std::collections::BTreeSet<(u64, u32)>,
    repeated: usize,
}

impl World {
    fn new(seed: u64, readers: u8, weather: Weather) -> Self {
        let mut world = Self {
            now: Duration::from_secs(1),
            dice: Dice::new(seed),
            weather,
            sender: Sender::new(SENDER),
            own: SENDER,
            ends: Vec::new(),
            packets: Vec::new(),
            left: Vec::new(),
            most_ahead: 0,
            parts: std::collections::BTreeSet::new(),
            repeated: 0,
        };
        (1..=readers).for_each(|name| world.join(name));
        world
    }

    fn join(&mut self, name: u8) {
        let receiver = Receiver::new(self.now);
        let (bodies, faults) = (Vec::new(), Vec::new());
        self.ends.push(End { id: reader(name), receiver, sequence: 0, bodies, faults, suspended: false });
    }

    fn present(&self) -> Vec<Guid> {
        self.ends.iter().map(|end| end.id).collect()
    }

    fn send(&mut self, packet: impl Fn() -> Packet) {
        let copies = if self.dice.unit() < self.weather.twice { 2 } else { 1 };
        for _ in 0..copies {
            if self.dice.unit() < self.weather.lost {
                continue;
            }
            let delay = self.dice.below(self.weather.delay + 1);
            let mut packet = packet();
            if let Packet::Part { part, .. } = &mut packet
                && self.dice.unit() < self.weather.corrupt
            {
                let bit = 1 << self.dice.below(8);
                match self.dice.below(8) {
                    0 => part.index ^= bit,
                    1 => part.count ^= bit,
                    2 => part.body ^= u64::from(bit),
                    3 => part.length ^= 1 << self.dice.below(32),
                    _ => {
                        let at = self.dice.below(part.data.len());
                        part.data[at] ^= bit as u8;
                    }
                }
            }
            self.packets.push((self.now + delay as u32 * MS, packet));
        }
    }

    /// Advances by one millisecond.
    fn tick(&mut self) {
        let mut due: Vec<(Duration, Packet)> = Vec::new();
        let mut place = 0;
        while place < self.packets.len() {
            if self.packets[place].0 <= self.now { due.push(self.packets.remove(place)) } else { place += 1 }
        }
        for (_, packet) in due {
            match packet {
                Packet::Credit { from, sequence, credit } => {
                    self.sender.receive(self.now, from, sequence, &credit)
                }
                Packet::Part { to, from, part } => {
                    let Some(end) = self.ends.iter_mut().find(|end| end.id == to && !end.suspended) else {
                        continue;
                    };
                    let outcome = end.receiver.receive(self.now, from, &part);
                    end.bodies.extend(outcome.whole.map(|(_, body)| body));
                    end.faults.extend(outcome.fault);
                }
            }
        }
        let present = self.present();
        self.left
            .extend(self.sender.apply_time_limits(self.now, &present).into_iter().map(|(_, reason)| reason));
        while let Some(part) = self.sender.next_part(self.now) {
            self.most_ahead = self.most_ahead.max(part.index);
            self.repeated += usize::from(!self.parts.insert((part.body, part.index)));
            for to in present.clone() {
                let from = self.own;
                self.send(|| Packet::Part { to, from, part: part.clone() });
            }
        }
        for place in 0..self.ends.len() {
            let end = &mut self.ends[place];
            if end.suspended {
                continue;
            }
            let (from, credits) = (end.id, end.receiver.credits(self.now));
            for credit in credits {
                self.ends[place].sequence += 1;
                let sequence = self.ends[place].sequence;
                self.send(|| Packet::Credit { from, sequence, credit: credit.clone() });
            }
        }
        self.now += MS;
    }

    fn run_until(&mut self, what: &str, seconds: u32, mut done: impl FnMut(&World) -> bool) {
        for _ in 0..seconds * 1000 {
            if done(self) {
                return;
            }
            self.tick();
        }
        panic!("not within {seconds} s: {what}");
    }

    fn is_busy(&self) -> bool {
        self.sender.is_busy(self.now, &self.present(), self.ends.len())
    }

    fn offer(&mut self, bytes: &[u8]) {
        self.run_until("the body before is delivered", 60, |w| !w.is_busy());
        self.sender.offer(self.now, bytes.to_vec());
    }
}

#[test]
fn every_body_arrives_once_whole_and_in_order_whatever_the_network_does() {
    let (mut faults, mut repeated) = (0, 0);
    for seed in 0..20 {
        let weather = Weather { lost: 0.2, twice: 0.2, corrupt: 0.1, delay: 30 };
        let mut world = World::new(seed, 3, weather);
        // Lengths around multiples of a part, and longer than the range of one credit.
        let lengths = [STRIDE + 1, 9 * STRIDE, 20 * STRIDE - 7, STRIDE];
        let bodies: Vec<Vec<u8>> = (0..4).map(|n| body(seed + n, lengths[n as usize])).collect();
        for bytes in &bodies {
            world.offer(bytes);
        }
        world.run_until("the last body is delivered", 60, |w| !w.is_busy());
        for end in &world.ends {
            assert!(end.bodies == bodies, "seed {seed}");
            faults += end.faults.len();
        }
        assert!(world.left.is_empty(), "seed {seed}: {:?}", world.left);
        repeated += world.repeated;
    }
    assert!(faults > 0 && repeated > 0, "the network had faults");
}

#[test]
fn a_quiet_network_carries_every_part_once() {
    let mut world = World::new(0, 2, Weather { delay: 2, ..Weather::default() });
    let bytes = body(1, 48 * STRIDE);
    (0..100).for_each(|_| world.tick());
    world.offer(&bytes);
    world.run_until("delivery", 5, |w| !w.is_busy());
    assert!(world.ends.iter().all(|end| end.bodies == std::slice::from_ref(&bytes) && end.faults.is_empty()));
    assert_eq!(world.repeated, 0);
}

#[test]
fn no_more_than_the_window_is_in_transit_to_the_slowest_active_reader() {
    let mut world = World::new(0, 2, Weather::default());
    (0..100).for_each(|_| world.tick());
    world.ends[1].suspended = true;
    world.offer(&body(2, 40 * STRIDE));
    (0..2000).for_each(|_| world.tick());
    assert_eq!(world.most_ahead, WINDOW - 1, "the silent one counts as active");
    assert!(world.is_busy() && world.left.is_empty());
}

#[test]
fn the_sender_stops_waiting_for_a_silent_reader_and_the_others_receive_everything() {
    let mut world = World::new(0, 2, Weather::default());
    (0..100).for_each(|_| world.tick());
    let bodies = [body(3, 40 * STRIDE), body(4, 3 * STRIDE)];
    world.offer(&bodies[0]);
    (0..3).for_each(|_| world.tick());
    world.ends[0].suspended = true;
    let stopped = world.now;
    world.run_until("the silent one is no longer waited for", 60, |w| !w.is_busy());
    assert!(world.now - stopped <= SILENCE + Duration::from_secs(1));
    assert_eq!(world.left.len(), 1);
    assert!(world.left[0].contains("no credit for"), "{:?}", world.left);
    // It was only suspended: it receives the latest body.
    world.ends[0].suspended = false;
    world.offer(&bodies[1]);
    world.run_until("both have it", 10, |w| w.ends.iter().all(|end| end.bodies.last() == Some(&bodies[1])));
    assert_eq!(world.ends[1].bodies, bodies);
}

#[test]
fn a_reader_that_is_cut_off_for_ten_seconds_receives_every_message() {
    let mut world = World::new(0, 2, Weather::default());
    (0..100).for_each(|_| world.tick());
    let bodies = [body(3, 40 * STRIDE), body(4, 3 * STRIDE)];
    world.offer(&bodies[0]);
    world.ends[0].suspended = true;
    let restored = world.now + Duration::from_secs(10);
    while world.now < restored {
        world.tick();
    }
    world.ends[0].suspended = false;
    world.run_until("both have the first", 10, |w| !w.is_busy());
    world.offer(&bodies[1]);
    world.run_until("both have the second", 10, |w| !w.is_busy());
    assert!(world.left.is_empty(), "{:?}", world.left);
    assert!(world.ends.iter().all(|end| end.bodies == bodies));
}

#[test]
fn a_reader_that_leaves_is_not_waited_for_and_causes_no_warning() {
    let mut world = World::new(0, 1, Weather::default());
    (0..100).for_each(|_| world.tick());
    world.offer(&body(3, 40 * STRIDE));
    world.tick();
    world.ends.clear();
    world.tick();
    assert!(!world.is_busy() && world.left.is_empty());
}

#[test]
fn a_reader_without_a_credit_yet_is_waited_for_a_while() {
    let mut world = World::new(0, 0, Weather::default());
    world.sender.offer(world.now, body(3, 2 * STRIDE));
    assert!(!world.is_busy(), "nobody is there");
    assert!(world.sender.is_busy(world.now, &[], 1), "one is matched whose credits are not in the graph yet");
    world.join(1);
    world.ends[0].suspended = true;
    assert!(world.is_busy());
    world.run_until("it is given up", 60, |w| !w.is_busy());
}

#[test]
fn a_late_or_restarted_reader_receives_the_latest_body_once() {
    let weather = Weather { lost: 0.1, twice: 0.1, corrupt: 0.05, delay: 10 };
    for seed in 0..10 {
        let mut world = World::new(seed, 2, weather);
        let bodies = [body(5, 12 * STRIDE), body(6, 30 * STRIDE + 5)];
        world.offer(&bodies[0]);
        world.offer(&bodies[1]);
        // One reader is replaced during the transfer, another one joins after it.
        (0..20).for_each(|_| world.tick());
        world.ends.remove(0);
        world.join(3);
        world.run_until("delivery", 60, |w| !w.is_busy());
        world.join(4);
        world.run_until("the last one has it", 60, |w| {
            w.ends.iter().all(|e| e.bodies.last() == Some(&bodies[1]))
        });
        (0..3000).for_each(|_| world.tick());
        assert!(world.ends[0].bodies == bodies, "seed {seed}");
        for late in &world.ends[1..] {
            assert!(late.bodies == bodies[1..], "seed {seed}: {}", late.bodies.len());
        }
    }
}

#[test]
fn a_restarted_writer_is_read_from_its_first_body_on() {
    let weather = Weather { lost: 0.1, twice: 0.1, corrupt: 0.0, delay: 10 };
    let mut world = World::new(7, 2, weather);
    let (first, second) = (body(7, 30 * STRIDE), body(8, 10 * STRIDE));
    world.offer(&first);
    (0..30).for_each(|_| world.tick());
    world.own = Guid([8; 16]);
    world.sender = Sender::new(world.own);
    world.offer(&second);
    world.run_until("the new writer's body", 30, |w| w.ends.iter().all(|e| e.bodies.last() == Some(&second)));
    (0..3000).for_each(|_| world.tick());
    assert!(world.ends.iter().all(|e| e.bodies.iter().filter(|b| **b == second).count() == 1));
}

#[test]
fn a_body_that_is_out_of_date_is_not_sent_to_late_readers() {
    let mut world = World::new(0, 1, Weather::default());
    (0..100).for_each(|_| world.tick());
    world.offer(&body(9, 3 * STRIDE));
    world.run_until("delivery", 5, |w| !w.is_busy());
    world.sender.retire();
    world.join(2);
    (0..5000).for_each(|_| world.tick());
    assert!(world.ends[1].bodies.is_empty() && world.ends[0].bodies.len() == 1);
}

#[test]
fn a_reader_that_is_not_ready_stops_the_writer_until_it_is() {
    let mut world = World::new(0, 1, Weather::default());
    (0..100).for_each(|_| world.tick());
    let now = world.now;
    world.ends[0].receiver.set_ready(now, false);
    (0..100).for_each(|_| world.tick());
    world.offer(&body(10, 20 * STRIDE));
    (0..60_000).for_each(|_| world.tick());
    assert!(world.is_busy() && world.left.is_empty(), "it is active, so it is waited for");
    assert!(world.ends[0].bodies.is_empty());
    let now = world.now;
    world.ends[0].receiver.set_ready(now, true);
    world.run_until("delivery", 5, |w| !w.is_busy());
    assert_eq!(world.ends[0].bodies.len(), 1);
}

/// A part from a writer, changed, with a CRC that matches the change.
fn forged(change: impl Fn(&mut PackingChunk)) -> PartError {
    let bytes = body(11, 3 * STRIDE + 10);
    let mut part = Shape::of(1, &bytes).cut(&bytes, 1);
    change(&mut part);
    assert_ne!(crc_of(&part), part.crc, "its crc is still right");
    part.crc = crc_of(&part);
    let mut receiver = Receiver::new(Duration::ZERO);
    let outcome = receiver.receive(Duration::ZERO, SENDER, &part);
    assert!(outcome.whole.is_none() && !receiver.keeps_parts(), "no part of it is kept");
    outcome.fault.expect("a fault")
}

#[test]
fn invalid_parts_are_refused_with_the_name_of_the_field_and_allocate_nothing() {
    let message = |change: fn(&mut PackingChunk)| forged(change).to_string();
    for (error, word) in [
        (message(|p| p.length = LONGEST + 1), "length = 1073741825"),
        (message(|p| p.length = u64::MAX), "length = 18446744073709551615"),
        (message(|p| p.length = 0), "length = 0"),
        (message(|p| p.stride = 0), "stride = 0"),
        (message(|p| p.stride = u32::MAX), "stride = 4294967295"),
        (message(|p| p.count = u32::MAX), "count = 4294967295"),
        (message(|p| p.index = 4), "index = 4"),
        (message(|p| p.body = 0), "body = 0"),
        (message(|p| p.data.truncate(131_071)), "data length = 131071"),
    ] {
        assert!(error.contains(word), "{error}");
    }
    let bytes = body(11, STRIDE + 10);
    let mut part = Shape::of(1, &bytes).cut(&bytes, 1);
    part.data[3] ^= 4;
    let error = Shape::checked(&part).unwrap_err().to_string();
    assert!(error.starts_with("part 1 of body 1 is corrupt"), "{error}");
}

#[test]
fn a_part_that_contradicts_earlier_ones_is_refused_and_those_are_kept() {
    let (bytes, other) = (body(12, 3 * STRIDE), body(13, 3 * STRIDE));
    let (shape, wrong) = (Shape::of(1, &bytes), Shape::of(1, &other));
    let mut receiver = Receiver::new(Duration::ZERO);
    let mut receive = |part: PackingChunk| receiver.receive(Duration::ZERO, SENDER, &part);
    assert!(receive(shape.cut(&bytes, 2)).begins);
    let fault = receive(wrong.cut(&other, 0)).fault;
    assert_eq!(
        fault,
        PartError("part 0 of body 1 contradicts earlier parts in length, body_crc, stride or count".into())
            .into()
    );
    receive(shape.cut(&bytes, 0));
    assert_eq!(receive(shape.cut(&bytes, 1)).whole.expect("complete").1, bytes);
}

#[test]
fn a_corrupt_body_is_requested_again_and_then_given_up() {
    let bytes = body(14, 2 * STRIDE);
    let wrong = Shape { body_crc: 1, ..Shape::of(1, &bytes) };
    let mut receiver = Receiver::new(Duration::ZERO);
    let mut faults = Vec::new();
    for round in 0..3 {
        for index in 0..2 {
            let outcome = receiver.receive(round * 100 * MS, SENDER, &wrong.cut(&bytes, index));
            assert!(outcome.whole.is_none());
            faults.extend(outcome.fault.map(|fault| fault.to_string()));
        }
        let credit = &receiver.credits(round * 100 * MS + 50 * MS)[0];
        assert_eq!(credit.next, if round < 2 { 0 } else { 2 }, "all of it again, or no more of it");
    }
    assert_eq!(faults.len(), 3);
    assert!(faults[1].contains("requested again") && faults[2].contains("given up"), "{faults:?}");
}

#[test]
fn a_body_given_up_by_its_writer_is_reported_and_the_next_one_is_received() {
    let (old, new) = (body(15, 4 * STRIDE), body(16, STRIDE));
    let mut receiver = Receiver::new(Duration::ZERO);
    receiver.receive(Duration::ZERO, SENDER, &Shape::of(1, &old).cut(&old, 2));
    let outcome = receiver.receive(Duration::ZERO, SENDER, &Shape::of(2, &new).cut(&new, 0));
    assert_eq!(outcome.fault, PartError("the writer gave up body 1 after 1 of 4 parts".into()).into());
    assert_eq!(outcome.whole, Some((2, new)));
    let late = receiver.receive(Duration::ZERO, SENDER, &Shape::of(1, &old).cut(&old, 3));
    assert!(late.whole.is_none() && late.fault.is_none() && !receiver.keeps_parts());
}
