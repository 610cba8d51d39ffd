//! Some of the requests and states for viewers, and simulated time with them.

use grainlab_experiment::Simulation;
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::rosgraph_msgs::Clock;
use grainlab_msgs::{msg, stamp, to_cdr, topics};
use grainlab_node_kit::{BULK_LIMIT, Bus, BusError, Publisher, tolerate_full};
use grainlab_servo::ServoRequest;
use std::time::Duration;

/// Most exchanges between two samples.
const EXCHANGES: u64 = 64;

/// Particle-steps after which a sample is due earlier: some 30 ms of computation, whatever the number of grains.
const PARTICLE_STEPS: u64 = 1_000_000;

/// Least time between two states, and between two looks for their readers.
const PERIOD: Duration = Duration::from_secs(2);
const LOOK: Duration = Duration::from_millis(250);

/// Least time between two states, in times that one takes: half a percent of a run.
const PAUSE: u32 = 200;

/// Publishes some of the requests on [`topics::STRESS_SAMPLED`], and their times on `/clock`. Which ones follows from the run
/// alone, not from clocks.
#[derive(Debug)]
pub(crate) struct Samples {
    publisher: Publisher<msg::Stress>,
    pub(crate) clock: Publisher<Clock>,
    due: Due,
    packing: Publisher<msg::Packing>,
    /// Time of the next look for readers of states.
    next_look: Duration,
}

impl Samples {
    pub(crate) fn advertise(bus: &mut dyn Bus) -> Result<Self, BusError> {
        let publisher = Publisher::advertise(bus, &topics::STRESS_SAMPLED)?;
        let clock = Publisher::advertise(bus, &topics::CLOCK)?;
        let packing = Publisher::advertise(bus, &topics::PACKING_SAMPLED)?;
        Ok(Self { publisher, clock, due: Due::default(), packing, next_look: Duration::ZERO })
    }

    /// Publishes a request, if a sample is due. A viewer that is behind loses it.
    pub(crate) fn offer(
        &mut self,
        bus: &mut dyn Bus,
        request: &ServoRequest,
        grains: u32,
        body: &[u8],
    ) -> Result<(), BusError> {
        if !self.due.at(request.sequence, request.step, grains) {
            return Ok(());
        }
        tolerate_full(bus.publish(self.publisher.id(), body))?;
        self.tell_time(bus, request.time)
    }

    /// Publishes the last request of a run with its sequence number, unless it was a sample: viewers end with its values.
    pub(crate) fn end(&mut self, bus: &mut dyn Bus, sequence: u64, body: &[u8]) -> Result<(), BusError> {
        if self.due.0.is_none_or(|(last, _)| last == sequence) {
            return Ok(());
        }
        tolerate_full(bus.publish(self.publisher.id(), body))
    }

    /// Publishes the state, if it is due and somebody reads it; a large one, and that of another program, is left out.
    /// It is read alone: no result of the run depends on it.
    pub(crate) fn offer_state(&mut self, bus: &mut dyn Bus, run: &Simulation) -> Result<(), BusError> {
        let began = bus.now();
        if began < self.next_look {
            return Ok(());
        }
        self.next_look = began + LOOK;
        if !bus.is_read(self.packing.id()) || run.engine().program().is_some() {
            return Ok(());
        }
        if let Ok(packing) = run.packing() {
            let body = to_cdr(&packing_message(&packing, &run.scene().name, Vec::new()));
            if body.len() <= BULK_LIMIT {
                tolerate_full(bus.publish(self.packing.id(), &body))?;
            }
        }
        let end = bus.now();
        self.next_look = end + PERIOD.max(PAUSE * end.saturating_sub(began));
        Ok(())
    }

    /// Publishes a simulated time, s.
    pub(crate) fn tell_time(&self, bus: &mut dyn Bus, time: f64) -> Result<(), BusError> {
        tolerate_full(self.clock.publish(bus, &Clock { clock: stamp(time) }))
    }
}

/// Sequence number and step of the last sample.
#[derive(Debug, Default)]
struct Due(Option<(u64, u64)>);

impl Due {
    fn at(&mut self, sequence: u64, step: u64, grains: u32) -> bool {
        let due = self.0.is_none_or(|(last, at)| {
            let particle_steps = step.saturating_sub(at).saturating_mul(u64::from(grains));
            sequence.saturating_sub(last) >= EXCHANGES || particle_steps >= PARTICLE_STEPS
        });
        if due {
            self.0 = Some((sequence, step));
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(grains: u32, steps_per_exchange: u64) -> Vec<u64> {
        let mut due = Due::default();
        (0..300).filter(|n| due.at(*n, n * steps_per_exchange, grains)).collect()
    }

    #[test]
    fn the_first_request_is_a_sample_and_each_after_64_exchanges_or_a_million_particle_steps() {
        assert_eq!(samples(10, 1), [0, 64, 128, 192, 256]);
        assert_eq!(samples(500, 20)[..3], [0, 64, 128], "640,000 particle-steps");
        assert_eq!(samples(10_000, 20)[..3], [0, 5, 10]);
        assert_eq!(samples(1_000_000, 20).len(), 300);
    }
}
