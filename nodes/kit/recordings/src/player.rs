//! The schedule of a playback, without a clock or a socket.
//!
//! The caller passes the time and sends what is due. Messages keep their order and their intervals in log
//! time. If the caller falls behind, the whole schedule is delayed, so that topics stay in proportion, and
//! [`Player::slipped`] returns the total delay. Playback that starts in the middle begins with the last earlier
//! message of every latched topic, as a node that joins late would receive it.

use std::collections::{BTreeSet, VecDeque};
use std::iter::Peekable;
use std::sync::Arc;
use std::time::Duration;

use grainlab_console::Failure;

use crate::reader::{ChannelInfo, Message, Messages, Recording, Selection};

/// Lateness above which the schedule is delayed instead of catching up.
const PATIENCE: Duration = Duration::from_millis(20);

/// The selection and rate of a playback.
#[derive(Clone, Debug, PartialEq)]
pub struct PlayOptions {
    /// Names of topics, with or without the leading slash; `None` for all.
    pub topics: Option<Vec<String>>,
    /// Names of topics to leave out of those.
    pub exclude: Vec<String>,
    /// Recorded seconds per second; positive. With infinity, messages are due at once.
    pub rate: f64,
    /// Start, after the first message of the recording.
    pub start_offset: Duration,
    /// Duration to play, in recorded time; `None` to the end.
    pub duration: Option<Duration>,
}

impl Default for PlayOptions {
    fn default() -> Self {
        Self { topics: None, exclude: Vec::new(), rate: 1.0, start_offset: Duration::ZERO, duration: None }
    }
}

/// The next action of the caller.
#[derive(Clone, Debug)]
pub enum Play {
    /// Send this message, and poll again.
    Send(Message),
    /// Nothing is due for this long.
    Wait(Duration),
    /// Nothing is due until [`Player::resume`].
    Paused,
    /// All messages have been sent.
    Done,
}

/// The schedule of one playback.
pub struct Player<'r> {
    channels: Vec<Arc<ChannelInfo>>,
    latched: VecDeque<Message>,
    messages: Peekable<Messages<'r>>,
    rate: f64,
    paused: bool,
    /// Messages to send although the schedule is stopped.
    steps: u64,
    /// Log time reached at `anchor`, ns since 1970.
    position: u64,
    /// Time of the caller; `None` before the first poll.
    anchor: Option<Duration>,
    slipped: Duration,
}

impl<'r> Player<'r> {
    /// A playback of `recording`, which begins with the first [`Player::poll`].
    ///
    /// # Errors
    /// If a topic does not exist, the rate is not positive, or the offset is beyond the end.
    pub fn new(recording: &'r Recording, options: &PlayOptions) -> Result<Self, Failure> {
        check_rate(options.rate)?;
        let names = match &options.topics {
            Some(names) => names.clone(),
            None => recording.channels().iter().map(|c| c.topic.clone()).collect(),
        };
        let excluded: BTreeSet<&str> = options.exclude.iter().map(|n| n.trim_start_matches('/')).collect();
        let mut channels = Vec::new();
        for name in names.iter().filter(|n| !excluded.contains(n.trim_start_matches('/'))) {
            channels.push(recording.channel(name)?);
        }
        channels.sort_by(|a, b| a.topic.cmp(&b.topic));
        channels.dedup();
        let (first, last) = recording.time_range().unwrap_or((0, 0));
        let start = first.saturating_add(nanoseconds(options.start_offset));
        if start > last {
            let (offset, length) = (options.start_offset, Duration::from_nanos(last - first));
            return Err(Failure::usage(format!(
                "start offset {offset:?} is beyond the end: the recording lasts {length:?}"
            )));
        }
        let latched = channels.iter().filter(|c| c.is_latched()).map(|c| (c.topic.clone(), 1)).collect();
        let latched = recording.each_before(&latched, Some(start)).into_values().flatten();
        let mut latched: Vec<Message> = latched.collect();
        latched.sort_by_key(|m| m.log_time);
        let selection = Selection {
            topics: Some(channels.iter().map(|c| c.topic.clone()).collect()),
            start: Some(start),
            end: options.duration.map(|d| start.saturating_add(nanoseconds(d))),
        };
        Ok(Self {
            messages: recording.messages(&selection)?.peekable(),
            channels,
            latched: latched.into(),
            rate: options.rate,
            paused: false,
            steps: 0,
            position: start,
            anchor: None,
            slipped: Duration::ZERO,
        })
    }

    /// The topics that will be sent, by name.
    pub fn channels(&self) -> &[Arc<ChannelInfo>] {
        &self.channels
    }

    /// The action at `now`, a time since any origin, which must not decrease.
    pub fn poll(&mut self, now: Duration) -> Play {
        self.anchor.get_or_insert(now);
        if let Some(message) = self.latched.pop_front() {
            return Play::Send(message);
        }
        if self.paused {
            if self.steps == 0 {
                return Play::Paused;
            }
            self.steps -= 1;
            let Some(message) = self.messages.next() else { return Play::Done };
            self.set_anchor(message.log_time, now);
            return Play::Send(message);
        }
        let Some(due) = self.messages.peek().map(|m| m.log_time) else {
            return Play::Done;
        };
        let position = self.position(now);
        if self.rate.is_infinite() {
            self.position = due;
        } else if due > position {
            return Play::Wait(self.in_callers_time(due - position));
        } else if self.in_callers_time(position - due) > PATIENCE {
            self.slipped += self.in_callers_time(position - due);
            self.set_anchor(due, now);
        }
        self.messages.next().map_or(Play::Done, Play::Send)
    }

    /// Log time (ns since 1970) that playback has reached at `now`, as for `/clock`.
    pub fn position(&self, now: Duration) -> u64 {
        match self.anchor {
            Some(anchor) if !self.paused && self.rate.is_finite() => {
                let passed = now.saturating_sub(anchor).as_nanos() as f64 * self.rate;
                self.position.saturating_add(passed as u64)
            }
            _ => self.position,
        }
    }

    /// Stops the schedule until [`Player::resume`].
    pub fn pause(&mut self, now: Duration) {
        self.set_anchor(self.position(now), now);
        self.paused = true;
    }

    /// Continues after [`Player::pause`].
    pub fn resume(&mut self, now: Duration) {
        self.set_anchor(self.position(now), now);
        self.paused = false;
        self.steps = 0;
    }

    /// Stops the schedule, and sends the next message at the next poll.
    pub fn step(&mut self, now: Duration) {
        if !self.paused {
            self.pause(now);
        }
        self.steps += 1;
    }

    /// Recorded seconds per second.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// True while the schedule is stopped.
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// Changes the rate from `now` on.
    ///
    /// # Errors
    /// If it is not positive.
    pub fn set_rate(&mut self, now: Duration, rate: f64) -> Result<(), Failure> {
        check_rate(rate)?;
        self.set_anchor(self.position(now), now);
        self.rate = rate;
        Ok(())
    }

    /// Total delay of the schedule because messages were not taken in time.
    pub fn slipped(&self) -> Duration {
        self.slipped
    }

    fn set_anchor(&mut self, position: u64, now: Duration) {
        (self.position, self.anchor) = (position, Some(now));
    }

    fn in_callers_time(&self, recorded: u64) -> Duration {
        Duration::try_from_secs_f64(recorded as f64 * 1e-9 / self.rate).unwrap_or(Duration::MAX)
    }
}

fn check_rate(rate: f64) -> Result<(), Failure> {
    if rate > 0.0 {
        return Ok(());
    }
    let must = "it must be more than 0 (1 is the speed of the recording)";
    Err(Failure::usage(format!("rate {rate} is out of range: {must}")))
}

fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
