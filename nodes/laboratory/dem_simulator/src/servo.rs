//! The servo as the simulator sees it: requests to it, and its answers.

use crate::lockstep::{AnswerKind, Counts, Lockstep, REFUSALS_ALLOWED};
use crate::partner::{AnswerSource, Partner};
use crate::settings::Settings;
use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::{Guid, topics};
use grainlab_node_kit::{Bus, BusError, Participant, Publisher, PublisherId, Subscription, tolerate_full};
use grainlab_servo::ServoRequest;
use std::time::Duration;

pub(crate) struct Servo {
    stress: Publisher<Stress>,
    strain_rate: Subscription<StrainRate>,
    lockstep: Lockstep,
    partner: Partner,
}

impl Servo {
    /// `writer` is the writer of `stress`.
    pub(crate) fn new(
        stress: Publisher<Stress>,
        strain_rate: Subscription<StrainRate>,
        writer: Guid,
        settings: &Settings,
    ) -> Self {
        Self { stress, strain_rate, lockstep: Lockstep::new(settings), partner: Partner::new(writer) }
    }

    /// Receives all answers. Returns the reason to end the run, if there is one. Answers to other simulators, and answers before
    /// the first request, are dropped.
    pub(crate) fn receive(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Option<String>, BusError> {
        while let Some((message, info)) = self.strain_rate.take_valid(bus)? {
            if !self.lockstep.has_asked() {
                continue;
            }
            match self.partner.judge(&info, || bus.foreign_writers(&topics::STRAIN_RATE)) {
                AnswerSource::Ours => {}
                AnswerSource::AnotherRun => continue,
                AnswerSource::Another { new } => {
                    if new {
                        let servo = bus.describe(info.writer);
                        log::warn!("a second servo answers, {servo}: it is ignored, the first one is used");
                    }
                    continue;
                }
            }
            let answer = message.checked().map_err(|e| e.to_string());
            match answer.and_then(|answer| self.lockstep.receive(answer)) {
                Ok(AnswerKind::New) => {
                    if self.partner.stay_with(info.writer) {
                        log::info!("{} is now the servo", bus.describe(info.writer));
                    }
                }
                Ok(AnswerKind::Stale) => {}
                Ok(AnswerKind::Contradicts) => {
                    if self.lockstep.counts.contradictions.is_power_of_two() {
                        let (sequence, servo) = (message.sequence, bus.describe(info.writer));
                        log::error!(
                            "request {sequence} has two different answers, the second by {servo}: the first is used"
                        );
                    }
                }
                Err(error) => {
                    bus.count_refused(self.strain_rate.id());
                    let over = self.lockstep.refuse(now);
                    if over || self.lockstep.counts.refused.is_power_of_two() {
                        let servo = bus.describe(info.writer);
                        log::warn!("answer {} of {servo}: {error}", message.sequence);
                    }
                    if over {
                        let reason = format!(
                            "{REFUSALS_ALLOWED} consecutive answers were invalid, the last one: {error}"
                        );
                        return Ok(Some(reason));
                    }
                }
            }
        }
        Ok(None)
    }

    /// Records that a request was published with these bytes.
    pub(crate) fn ask(&mut self, request: &ServoRequest, body: Vec<u8>, now: Duration) {
        self.lockstep.ask(request, body, now);
    }

    /// Returns the answer to the present request, 1/s, if it has arrived.
    pub(crate) fn answer(&mut self, now: Duration) -> Option<[f64; 6]> {
        self.lockstep.pass(now)
    }

    /// Takes back an answer that was not applied, since its computation was stopped.
    pub(crate) fn not_applied(&mut self) {
        self.lockstep.not_applied();
    }

    /// Records the time spent computing while the answer was in transit.
    pub(crate) fn computed(&mut self, time: Duration) {
        self.lockstep.computed(time);
    }

    /// Publishes the present request again, if that is due.
    pub(crate) fn repeat(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<(), BusError> {
        for body in self.lockstep.resend(now).into_iter().flatten().filter(|body| !body.is_empty()) {
            // A request that was dropped is repeated.
            tolerate_full(bus.publish(self.stress.id(), body))?;
        }
        Ok(())
    }

    /// Returns the time until the present request is repeated.
    pub(crate) fn patience(&self, now: Duration) -> Duration {
        self.lockstep.patience(now)
    }

    /// Logs that the answer is late, and returns the time for which it was awaited.
    pub(crate) fn note_silence(&self, bus: &dyn Bus, now: Duration) -> Duration {
        let waited = self.lockstep.waited(now);
        let (sequence, seconds, topic) =
            (self.lockstep.sequence(), waited.as_secs(), topics::STRAIN_RATE.name);
        let servos = bus.writers(self.strain_rate.id());
        log::warn!(
            "no answer to request {sequence} for {seconds} s: it is awaited on {topic}, publishers there: {servos}"
        );
        waited
    }

    /// Returns the sequence number and the bytes of the present request.
    pub(crate) fn request(&self) -> (u64, &[u8]) {
        (self.lockstep.sequence(), self.lockstep.body())
    }

    pub(crate) fn counts(&self) -> Counts {
        self.lockstep.counts
    }

    /// Returns the number of ignored answers of other servos.
    pub(crate) fn ignored(&self) -> u64 {
        self.partner.ignored
    }

    /// Returns the publisher of requests.
    pub(crate) fn stress(&self) -> PublisherId {
        self.stress.id()
    }

    /// Returns the participant that the requests are written by.
    pub(crate) fn own(&self) -> Participant {
        self.partner.stress.participant()
    }

    /// True if there is a reader of requests and a writer of answers.
    pub(crate) fn is_present(&self, bus: &dyn Bus) -> bool {
        bus.readers(self.stress.id()) > 0 && bus.writers(self.strain_rate.id()) > 0
    }
}
