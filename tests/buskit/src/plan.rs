//! The faults of a run, from its seed.

use crate::bench::Kind;
use crate::forgery::{FORGERIES, Forgery};
use grainlab_node_kit::{Dice, Faults};
use std::time::Duration;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Event {
    /// A process crashes, and is restarted after this time.
    Crash(Kind, Duration),
    /// A process is stopped for this time, while messages for it arrive.
    Stop(Kind, Duration),
    /// All processes are stopped for this time: the clocks jump forward.
    Suspend(Duration),
    /// The wall clock is set forward or back by this number of seconds.
    WallClock(i64),
}

/// A stranger that is present from the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stranger {
    /// Kind of message that it forges.
    pub(crate) forgery: Forgery,
    /// True if it claims to belong to another run; otherwise it has no run.
    pub(crate) of_a_run: bool,
    /// Fraction of the received messages that it forges.
    pub(crate) share: f64,
}

/// All faults of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Seed of the bus.
    pub(crate) bus: u64,
    /// Faults of every topic.
    pub(crate) faults: Faults,
    /// By the count of samples that the recorder has received before it, so that the run is in the same state
    /// on every machine.
    pub(crate) events: Vec<(u64, Event)>,
    pub(crate) strangers: Vec<Stranger>,
}

/// Samples that a run of the scene records, from which times are drawn; some lie after the end.
const SAMPLES: usize = 700;

impl Plan {
    /// Creates a plan without faults.
    pub fn quiet() -> Self {
        Self { bus: 0, faults: Faults::default(), events: Vec::new(), strangers: Vec::new() }
    }

    /// Creates the plan for a seed.
    pub fn of(seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let ms = |dice: &mut Dice, most: f64| Duration::from_secs_f64(1e-3 * most * dice.unit());
        // A third of the runs has a good network, so that crashes and strangers also affect fast runs.
        let bad = dice.below(3) > 0;
        let scale = if bad { dice.unit() } else { 0.0 };
        let faults =
            Faults { drop: 0.3 * scale, duplicate: 0.4 * scale, delay: ms(&mut dice, 60.0).mul_f64(scale) };
        let count = dice.below(7);
        let mut events: Vec<(u64, Event)> = (0..count)
            .map(|_| {
                let moment = dice.below(SAMPLES) as u64;
                let kind = Kind::ALL[dice.below(Kind::ALL.len())];
                let event = match dice.below(8) {
                    0..=2 => Event::Crash(kind, ms(&mut dice, 500.0)),
                    3..=5 => Event::Stop(kind, ms(&mut dice, 20_000.0)),
                    6 => Event::Suspend(ms(&mut dice, 60_000.0)),
                    _ => Event::WallClock((7200.0 * dice.unit()) as i64 - 3600),
                };
                (moment, event)
            })
            .collect();
        events.sort_by_key(|(moment, _)| *moment);
        let strangers = (0..dice.below(4))
            .map(|_| Stranger {
                forgery: FORGERIES[dice.below(FORGERIES.len())],
                of_a_run: dice.below(2) == 0,
                share: dice.unit(),
            })
            .collect();
        Self { bus: seed, faults, events, strangers }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_makes_one_plan_and_another_seed_another() {
        assert_eq!(Plan::of(7), Plan::of(7));
        assert_ne!(Plan::of(7), Plan::of(8));
    }
}
