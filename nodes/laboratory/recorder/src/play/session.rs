//! Sends the messages of a playback, and follows its keys.

use super::delivery;
use super::keys::{Key, Keys};
use super::publisher::TopicPublishers;
use grainlab_console::{Failure, count, say};
use grainlab_msgs::builtin_interfaces::Time;
use grainlab_msgs::{rosgraph_msgs, to_cdr, topics};
use grainlab_node_kit::{BulkPublisher, Bus, BusError, DdsBus, PublisherId, Wake};
use grainlab_recordings::{Message, Play, PlayOptions, Player, Recording};
use std::time::Duration;

/// Pause before the next attempt to send a message while a reader is slow.
const HOLD: Duration = Duration::from_millis(5);
/// Period at which the acknowledgements are looked at while messages are sent.
const LOOK: Duration = Duration::from_millis(50);
/// Maximum time until a key is noticed.
const KEYS: Duration = Duration::from_millis(30);

pub(super) struct Session {
    pub(super) bus: DdsBus,
    pub(super) publishers: TopicPublishers,
    keys: Option<Keys>,
    clock: Option<ClockPublisher>,
    sent: u64,
    /// Messages of a part of the recording whose definition is another one than that of their topic.
    unread: u64,
    /// Total delay, because readers were slow.
    late: Duration,
    next_look: Duration,
}

/// Publishes the time of the recording.
struct ClockPublisher {
    publisher: PublisherId,
    period: Duration,
    next: Duration,
}

impl ClockPublisher {
    fn advertise(bus: &mut DdsBus, hz: f64) -> Result<Self, Failure> {
        let publisher = bus.advertise(&topics::CLOCK).map_err(Failure::failed)?;
        Ok(Self { publisher, period: Duration::from_secs_f64(1.0 / hz), next: bus.now() })
    }

    /// Publishes `position` (ns since 1970) if it is due; the time until the next one.
    fn publish(&mut self, bus: &mut DdsBus, position: u64) -> Result<Duration, Failure> {
        let now = bus.now();
        if now >= self.next {
            let (sec, nanosec) = ((position / 1_000_000_000) as i32, (position % 1_000_000_000) as u32);
            let message = rosgraph_msgs::Clock { clock: Time { sec, nanosec } };
            match bus.publish(self.publisher, &to_cdr(&message)) {
                // A reader that is far behind gets the next one.
                Ok(_) | Err(BusError::Full { .. }) => {}
                Err(error) => return Err(Failure::failed(error)),
            }
            self.next = (self.next + self.period).max(now);
        }
        Ok(self.next.saturating_sub(now))
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Ended {
    Done,
    Signal,
    Key,
    /// A subscriber acknowledges nothing any longer.
    Stuck,
}

impl Session {
    /// Creates a playback that also publishes `/clock`, `clock` times per second.
    pub(super) fn new(
        mut bus: DdsBus,
        publishers: TopicPublishers,
        keys: Option<Keys>,
        clock: Option<f64>,
    ) -> Result<Self, Failure> {
        let clock = clock.map(|hz| ClockPublisher::advertise(&mut bus, hz)).transpose()?;
        let (late, next_look) = (Duration::ZERO, Duration::ZERO);
        Ok(Self { bus, publishers, keys, clock, sent: 0, unread: 0, late, next_look })
    }

    /// Sends each message when it is due, `again` and again until a key or a signal. The keys are closed afterwards.
    ///
    /// Returns when every message sent in parts is complete at every active reader.
    pub(super) fn play(
        &mut self,
        recording: &Recording,
        options: &PlayOptions,
        mut is_paused: bool,
        again: bool,
    ) -> Result<Ended, Failure> {
        loop {
            let mut player = Player::new(recording, options)?;
            if std::mem::take(&mut is_paused) {
                player.pause(self.bus.now());
            }
            let ended = self.run(&mut player)?;
            self.late += player.slipped();
            if !again || ended != Ended::Done || self.keys.as_ref().is_some_and(Keys::is_over) {
                self.keys = None;
                return Ok(ended);
            }
        }
    }

    pub(super) fn say_delay(&self) {
        if self.late > Duration::from_millis(100) {
            let late = self.late.as_secs_f64();
            say!("grainlab: the readers are slower than the recording: {late:.1} s late in total");
        }
    }

    /// Says what was sent and what was not. Returns true if all of it was sent and received.
    pub(super) fn report(&self, ended: Ended) -> bool {
        let was_read = self.publishers.values().any(|publisher| publisher.watch().was_read());
        let to = if was_read { "" } else { ", without a subscriber" };
        say!("grainlab: {} sent{to}", count(self.sent, "message"));
        if self.unread > 0 {
            let unread = count(self.unread, "message");
            say!("grainlab: {unread} left out: this program has another definition of their types");
        }
        if ended == Ended::Stuck {
            say!("grainlab: the playback ended before the end of the recording");
        }
        delivery::report(&self.publishers) && ended != Ended::Stuck && self.unread == 0
    }

    fn run(&mut self, player: &mut Player<'_>) -> Result<Ended, Failure> {
        loop {
            if self.follow_keys(player)? {
                return Ok(Ended::Key);
            }
            let mut idle = true;
            let now = self.bus.now();
            let looks = now >= self.next_look;
            for publisher in self.publishers.values_mut() {
                idle &= publisher.advance(&mut self.bus)?;
                if looks {
                    publisher.look(&self.bus);
                }
            }
            if looks {
                self.next_look = now + LOOK;
            }
            let mut wait = match player.poll(now) {
                Play::Done if idle => return Ok(Ended::Done),
                // Without keys nobody can continue it.
                Play::Paused if idle && self.keys.is_none() => return Ok(Ended::Done),
                Play::Done => BulkPublisher::patience(),
                Play::Paused => KEYS.min(BulkPublisher::patience()),
                Play::Wait(time) if idle => time.min(LOOK),
                Play::Wait(time) => time.min(BulkPublisher::patience()),
                Play::Send(message) => {
                    if let Some(ended) = self.send(&message)? {
                        return Ok(ended);
                    }
                    Duration::ZERO
                }
            };
            if let Some(clock) = &mut self.clock {
                wait = wait.min(clock.publish(&mut self.bus, player.position(now))?);
            }
            if self.keys.is_some() {
                wait = wait.min(KEYS);
            }
            if self.bus.wait(wait) == Wake::Shutdown {
                return Ok(Ended::Signal);
            }
        }
    }

    /// Sends a message, waiting for slow readers; returns the reason if it is not sent.
    fn send(&mut self, message: &Message) -> Result<Option<Ended>, Failure> {
        let Some(publisher) = self.publishers.get_mut(&message.channel.topic) else { return Ok(None) };
        let Ok(body) = message.own_bytes() else {
            self.unread += 1;
            return Ok(None);
        };
        loop {
            match publisher.publish(&mut self.bus, &body) {
                Ok(()) => break,
                Err(BusError::Full { .. }) => {
                    publisher.look(&self.bus);
                    if publisher.watch().is_stuck(self.bus.now()) {
                        return Ok(Some(Ended::Stuck));
                    }
                }
                Err(error) => return Err(Failure::failed(error)),
            }
            if self.bus.wait(HOLD) == Wake::Shutdown {
                return Ok(Some(Ended::Signal));
            }
        }
        self.sent += 1;
        Ok(None)
    }

    /// Does what the keys say; true if one ends the playback.
    fn follow_keys(&mut self, player: &mut Player<'_>) -> Result<bool, Failure> {
        let Some(keys) = &mut self.keys else { return Ok(false) };
        while let Some(key) = keys.next() {
            let now = self.bus.now();
            match key {
                Key::Pause if player.is_paused() => player.resume(now),
                Key::Pause => player.pause(now),
                Key::Step => player.step(now),
                Key::Faster | Key::Slower => {
                    let factor = if key == Key::Faster { 1.1 } else { 1.0 / 1.1 };
                    player.set_rate(now, player.rate() * factor)?;
                    say!("grainlab: rate {:.3}\r", player.rate());
                }
                Key::End => return Ok(true),
            }
            // Steps are sent one by one, in the order of the keys.
            if key == Key::Step {
                break;
            }
        }
        Ok(false)
    }
}
