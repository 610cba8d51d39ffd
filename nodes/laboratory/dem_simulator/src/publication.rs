//! All that a run publishes besides its requests: packings, the state of the run, energies and samples. The requests go through
//! the same queue.

use crate::messages::{self, Packings, Remark};
use crate::samples::Samples;
use crate::send_queue::SendQueue;
use grainlab_experiment::{ExperimentError, Simulation, StepOutcome};
use grainlab_msgs::tf2_msgs::TFMessage;
use grainlab_msgs::{Topic, msg, to_cdr, topics};
use grainlab_node_kit::{BulkPublisher, Bus, BusError, Publisher, PublisherId};
use grainlab_servo::ServoRequest;
use std::time::Duration;

/// Period of `run_state` where nothing happens, wall time.
const BEAT: Duration = Duration::from_secs(1);
/// Pause before the next attempt while a slow reader holds up the send queue.
pub(crate) const HOLD: Duration = Duration::from_millis(5);
/// Time limit for the delivery of a packing that is in transit when a state is saved.
const EARLIER: Duration = Duration::from_secs(2);
/// Time limit for the delivery of a saved state: less than the launcher waits before it kills a simulator.
pub const SAVED_WITHIN: Duration = Duration::from_secs(20);
/// Time limit for the acknowledgement of the last messages. A reader that was killed never acknowledges.
pub(crate) const FLUSH_LIMIT: Duration = Duration::from_secs(2);
/// Time limit where nothing else waits for the end of the process: a reader on a busy host may be seconds behind.
pub(crate) const PATIENT_FLUSH_LIMIT: Duration = Duration::from_secs(10);

pub(crate) struct Publication {
    queue: SendQueue,
    samples: Samples,
    run_state: Publisher<msg::RunState>,
    /// With `energy_balance` of the scene.
    energy: Option<Publisher<msg::EnergyBalance>>,
    frames: Publisher<TFMessage>,
    packings: Packings,
    next_beat: Duration,
}

impl Publication {
    /// Advertises the topics. `packings` are those that were published before.
    pub(crate) fn advertise(bus: &mut dyn Bus, energy: bool, packings: Packings) -> Result<Self, BusError> {
        let samples = Samples::advertise(bus)?;
        let queue = SendQueue::new(BulkPublisher::advertise(bus, &topics::PACKING)?);
        let run_state = Publisher::advertise(bus, &topics::RUN_STATE)?;
        let energy = energy.then(|| Publisher::advertise(bus, &topics::ENERGY)).transpose()?;
        let frames = Publisher::advertise(bus, &topics::TF_STATIC)?;
        Ok(Self { queue, samples, run_state, energy, frames, packings, next_beat: bus.now() })
    }

    /// Publishes the frames of the run.
    pub(crate) fn frames(&self, bus: &mut dyn Bus) -> Result<(), BusError> {
        self.frames.publish(bus, &messages::frames()).map(drop)
    }

    /// Publishes the packing that a run begins with, which is counted already.
    pub(crate) fn first_packing(&mut self, packing: &msg::Packing) {
        self.queue.push_packing(to_cdr(packing));
    }

    pub(crate) fn state(&mut self, run: &Simulation, state: u8, remark: impl Into<Remark>) {
        let message = messages::run_state(run, state, self.packings, &remark.into());
        self.queue.push_state(self.run_state.id(), to_cdr(&message));
    }

    fn packing(&mut self, run: &Simulation) -> Result<(), ExperimentError> {
        let message = messages::packing(run)?;
        self.packings = Packings { last_step: message.step, count: self.packings.count.saturating_add(1) };
        self.queue.push_packing(to_cdr(&message));
        Ok(())
    }

    /// Publishes the state of the run once a second, with the remark that `remark` returns.
    pub(crate) fn progress(
        &mut self,
        run: &Simulation,
        state: u8,
        remark: impl FnOnce() -> Remark,
        now: Duration,
    ) {
        if now >= self.next_beat {
            self.next_beat = now + BEAT;
            self.state(run, state, remark());
        }
    }

    /// Publishes a sample of the state for viewers, if it is due.
    pub(crate) fn sample(&mut self, bus: &mut dyn Bus, run: &Simulation) -> Result<(), BusError> {
        self.samples.offer_state(bus, run)
    }

    /// Publishes a request, by the publisher of requests, and as a sample.
    pub(crate) fn request(
        &mut self,
        bus: &mut dyn Bus,
        publisher: PublisherId,
        (request, body): (&ServoRequest, &[u8]),
        grains: u32,
    ) -> Result<(), BusError> {
        self.queue.push_request(publisher, body.to_vec());
        self.samples.offer(bus, request, grains, body)
    }

    /// Publishes what the last step of the run makes due: a packing, the end of a phase, and its energies.
    ///
    /// # Errors
    /// A packing that the engine does not give, or that is none.
    pub(crate) fn step(
        &mut self,
        run: &Simulation,
        outcome: &StepOutcome,
        now: Duration,
    ) -> Result<(), ExperimentError> {
        if outcome.packing_due {
            self.packing(run)?;
        }
        let Some(phase) = &outcome.ended else { return Ok(()) };
        log::info!("phase {phase} ended at step {}", run.engine().steps());
        if let (Some(energy), Some(publisher)) = (&outcome.energy, &self.energy) {
            let message = messages::energy(run, phase, energy);
            self.queue.push_state(publisher.id(), to_cdr(&message));
        }
        if !outcome.finished {
            self.next_beat = now + BEAT;
            let left_out = run.left_out();
            log::info!("the next phase is {left_out}");
            self.state(run, msg::RunState::RUNNING, left_out);
        }
        Ok(())
    }

    /// Publishes the end of the loading path; `last` is the last request.
    pub(crate) fn finish(
        &mut self,
        bus: &mut dyn Bus,
        run: &Simulation,
        (sequence, body): (u64, &[u8]),
        now: Duration,
    ) -> Result<(), BusError> {
        self.next_beat = now + BEAT;
        self.samples.end(bus, sequence, body)?;
        self.state(run, msg::RunState::FINISHED, Remark::default());
        self.samples.tell_time(bus, run.engine().time())?;
        log::info!("the loading path is done at step {}", run.engine().steps());
        Ok(())
    }

    /// Publishes the state as the last packing, and waits until its readers have it; `last` is the last request. The error is why
    /// they may not.
    pub(crate) fn save(
        &mut self,
        bus: &mut dyn Bus,
        run: &Simulation,
        (sequence, body): (u64, &[u8]),
        reason: &str,
    ) -> Result<(), String> {
        let published = self.packing(run).map_err(|e| e.to_string());
        self.samples.end(bus, sequence, body).map_err(|e| e.to_string())?;
        self.state(run, msg::RunState::FAILED, reason.to_owned());
        let delivered = self.deliver_all(bus);
        flush_last_messages(bus, FLUSH_LIMIT);
        published?;
        if delivered.map_err(|e| e.to_string())? {
            return Ok(());
        }
        let (lacking, time) = (self.queue.packings.waited_for(), SAVED_WITHIN.as_secs());
        Err(format!("{lacking} readers do not have the whole packing after {time} s"))
    }

    /// Delivers all queued messages; true if every reader that is waited for has them.
    fn deliver_all(&mut self, bus: &mut dyn Bus) -> Result<bool, BusError> {
        let begin = bus.now();
        for limit in [EARLIER, SAVED_WITHIN] {
            self.queue.deliver(bus)?;
            while !self.queue.is_empty() && bus.now() < begin + limit {
                bus.wait(HOLD);
                self.queue.deliver(bus)?;
            }
            if self.queue.is_empty() {
                return Ok(true);
            }
            if limit == EARLIER {
                self.queue.flush(bus)?;
            }
        }
        Ok(false)
    }

    /// Publishes what the bus accepts; true if the run may continue.
    pub(crate) fn deliver(&mut self, bus: &mut dyn Bus) -> Result<bool, BusError> {
        self.queue.deliver(bus)
    }

    pub(crate) fn queue(&self) -> &SendQueue {
        &self.queue
    }

    /// Returns step and number of the packings published so far.
    pub(crate) fn packings(&self) -> Packings {
        self.packings
    }

    /// Returns the time of the next `run_state` where nothing happens.
    pub(crate) fn next_beat(&self) -> Duration {
        self.next_beat
    }

    /// Returns the publisher of one of the topics that the start may wait for.
    pub(crate) fn publisher(&self, topic: &Topic) -> PublisherId {
        match topic.name {
            name if name == topics::PACKING.name => self.queue.packings.id(),
            name if name == topics::CLOCK.name => self.samples.clock.id(),
            _ => self.run_state.id(),
        }
    }
}

/// Waits until the readers have acknowledged the last messages.
pub(crate) fn flush_last_messages(bus: &mut dyn Bus, limit: Duration) {
    if !bus.flush(limit) {
        log::warn!("a reader has not acknowledged the last messages");
    }
}
