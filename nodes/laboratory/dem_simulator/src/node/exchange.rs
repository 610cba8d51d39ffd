//! After the start: exchanges up to the end of the loading path, or to a failure.

use crate::DemSimulator;
use crate::lockstep::{AnswerKind, REFUSALS_ALLOWED};
use crate::messages;
use crate::node::{BEAT, HOLD, NOTICE_PERIOD, Stage};
use crate::partner::AnswerSource;
use crate::question::Question;
use crate::speculative_step::SpeculativeStep;
use grainlab_experiment::{ExperimentError, StepOutcome};
use grainlab_msgs::msg::{RunState, Stress};
use grainlab_msgs::{to_cdr, topics};
use grainlab_node_kit::{Bus, BusError, Exit, Next, NodeError, tolerate_full};
use grainlab_servo::ServoRequest;
use std::time::Duration;

impl DemSimulator {
    /// Receives all answers. Returns the reason to end the run, if there is one. Answers to other simulators are
    /// dropped.
    pub(crate) fn receive_answers(
        &mut self,
        bus: &mut dyn Bus,
        now: Duration,
    ) -> Result<Option<String>, BusError> {
        while let Some((message, info)) = self.strain_rate.take_valid(bus)? {
            // Before the first request there are no answers.
            if self.stage == Stage::Starting {
                continue;
            }
            let whose = self.partner.judge(&info, || bus.foreign_writers(&topics::STRAIN_RATE));
            match whose {
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
            let answer = answer.and_then(|answer| self.lockstep.receive(answer));
            match answer {
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

    /// Publishes the next request, or ends the run.
    pub(crate) fn request_next(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Next, NodeError> {
        let Some(request) = self.run.request() else {
            self.stage = Stage::Finished;
            self.done = Some(now);
            self.next_beat = now + BEAT;
            self.samples.end(bus, self.lockstep.sequence(), self.lockstep.body())?;
            self.publish_run_state(RunState::FINISHED, "");
            self.samples.tell_time(bus, self.run.engine().time())?;
            log::info!("the loading path is done at step {}", self.run.engine().steps());
            return self.wait_after_end(bus);
        };
        let message = match Stress::try_from(&request) {
            Ok(message) => message,
            Err(error) => return self.fail(bus, &error.to_string()),
        };
        // The servo would refuse the request and every repetition of it.
        if let Err(error) = grainlab_servo::check_stability(&request.input) {
            return self.fail(bus, &format!("the servo cannot be stable: {error}"));
        }
        self.stage = Stage::Running;
        let body = to_cdr(&message);
        self.send_queue.push_request(self.stress.id(), body.clone());
        self.samples.offer(bus, &request, self.run.scene().grains, &body)?;
        self.lockstep.ask(Question::of(&request), body, now);
        self.next_notice = now + NOTICE_PERIOD;
        let delivered = self.send_queue.deliver(bus)?;
        Ok(match delivered {
            false => Next::Wait(HOLD),
            // After the speculative step the answer should be there.
            true if self.speculate(bus, &request) => Next::Again,
            true => Next::Wait(self.lockstep.patience(now)),
        })
    }

    /// Computes a speculative step while the answer is in transit; false if speculation is off.
    fn speculate(&mut self, bus: &dyn Bus, request: &ServoRequest) -> bool {
        let step = self.speculates.then(|| SpeculativeStep::of(&self.run, request, || bus.now()));
        self.speculative = step.flatten();
        self.speculative.as_ref().inspect(|step| self.lockstep.computed(step.took)).is_some()
    }

    /// Advances the run with an answer, or takes the speculative step.
    fn apply_answer(&mut self, bus: &dyn Bus, rate: &[f64; 6]) -> Result<StepOutcome, ExperimentError> {
        let sequence = self.lockstep.sequence();
        match self.speculative.take() {
            Some(step) if step.matches(sequence, rate) => {
                self.foreseen += 1;
                self.computing += step.took;
                self.run = step.run;
                return step.result;
            }
            Some(_) => {
                log::info!(
                    "the answer to request {sequence} is not that of the servo's law: speculative steps are switched off"
                );
                self.speculates = false;
            }
            None => {}
        }
        let began = bus.now();
        let result = self.run.advance(rate);
        let now = bus.now();
        self.advance = (now.saturating_sub(began), now);
        self.computing += self.advance.0;
        result
    }

    /// At most one exchange.
    pub(crate) fn exchange(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Next, NodeError> {
        if let Some(rate) = self.lockstep.pass(now) {
            return match self.apply_answer(bus, &rate) {
                Ok(advanced) => self.advanced(bus, &advanced),
                // The run is at a request that it can be resumed from; the shutdown that follows saves it.
                Err(error) if error.is_stopped() => {
                    self.lockstep.not_applied();
                    Ok(Next::Again)
                }
                // There is no state to save. A restarted simulator goes on from the last packing.
                Err(error) if error.is_lost() => Err(NodeError::failed(error)),
                Err(error) => self.fail(bus, &error.to_string()),
            };
        }
        for body in self.lockstep.resend(now).into_iter().flatten().filter(|body| !body.is_empty()) {
            // A request that was dropped is repeated.
            tolerate_full(bus.publish(self.stress.id(), body))?;
        }
        if self.notice_due(now) {
            let waited = self.lockstep.waited(now);
            // The next one after twice the time.
            self.next_notice = now + waited;
            let (sequence, servos) = (self.lockstep.sequence(), bus.writers(self.strain_rate.id()));
            let (waited, topic) = (waited.as_secs(), topics::STRAIN_RATE.name);
            log::warn!(
                "no answer to request {sequence} for {waited} s: it is awaited on {topic}, publishers there: {servos}"
            );
        }
        Ok(Next::Wait(self.lockstep.patience(now)))
    }

    fn advanced(&mut self, bus: &mut dyn Bus, advanced: &StepOutcome) -> Result<Next, NodeError> {
        let now = bus.now();
        self.wall = now.saturating_sub(self.began);
        if advanced.packing_due
            && let Err(error) = self.publish_packing()
        {
            return if error.is_lost() {
                Err(NodeError::failed(error))
            } else {
                self.fail(bus, &error.to_string())
            };
        }
        if let Some(phase) = &advanced.ended {
            log::info!("phase {phase} ended at step {}", self.run.engine().steps());
            if let (Some(energy), Some(publisher)) = (&advanced.energy, &self.energy) {
                let message = messages::energy(&self.run, phase, energy);
                self.send_queue.push_state(publisher.id(), to_cdr(&message));
            }
            if !advanced.finished {
                self.next_beat = now + BEAT;
                let left_out = self.run.left_out();
                log::info!("the next phase is {left_out}");
                self.publish_run_state(RunState::RUNNING, &left_out);
            }
        }
        self.request_next(bus, now)
    }

    pub(crate) fn wait_after_end(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        self.send_queue.deliver(bus)?;
        if !self.send_queue.is_empty() {
            return Ok(Next::Wait(HOLD));
        }
        if self.settings.exit_when_finished && self.may_end(bus.now()) {
            self.flush_last_messages(bus);
            return Ok(Next::Finished(Exit::Done));
        }
        Ok(Next::Wait(self.next_beat.saturating_sub(bus.now())))
    }

    /// True if the last packing is inverted, or has been awaited for long enough.
    fn may_end(&self, now: Duration) -> bool {
        let (step, packings) = (self.packings.last_step, self.packings.count);
        let missing = self.inversions.missing(step).filter(|_| packings > 0);
        let waited = now.saturating_sub(self.done.unwrap_or(now));
        let over = waited >= self.settings.inverted_within;
        if let Some(topic) = missing.filter(|_| over) {
            log::warn!(
                "the last packing was not inverted from its {topic} within {:.0} s of the end of the loading path \
                 (parameter inverted_within): the simulator ends",
                waited.as_secs_f64()
            );
        }
        missing.is_none() || over
    }
}
