//! After the start: one exchange after the other, to the end of the path or to the failure.

use crate::DemSimulator;
use crate::ahead::Ahead;
use crate::barrier::{Heard, REFUSALS_ALLOWED};
use crate::messages;
use crate::node::{BEAT, HOLD, NOTICE_PERIOD, Stage};
use crate::partner::Whose;
use crate::question::Question;
use crate::settings::Mode;
use grainlab_experiment::{ExperimentError, ServoRequest, StepOutcome};
use grainlab_msgs::boundary::StrainRateAnswer;
use grainlab_msgs::msg::RunState;
use grainlab_msgs::{to_cdr, topics};
use grainlab_node_kit::{Bus, BusError, Exit, Next, NodeError};
use std::time::Duration;

impl DemSimulator {
    /// Takes every answer; the reason to end the run, if there is one. What other simulators are answered is heard before
    /// the start, too, and dropped.
    pub(crate) fn hear_answers(
        &mut self,
        bus: &mut dyn Bus,
        now: Duration,
    ) -> Result<Option<String>, BusError> {
        while let Some((message, info)) = self.strain_rate.take_valid(bus)? {
            // Nothing that was said before the first request can be an answer.
            if self.stage == Stage::Starting {
                continue;
            }
            let whose = self.partner.judge(&info, || bus.foreign_writers(&topics::STRAIN_RATE));
            match whose {
                Whose::Ours | Whose::Successor => {}
                Whose::AnotherRun => continue,
                Whose::Another { new } => {
                    if new {
                        let servo = bus.describe(info.writer);
                        log::warn!(
                            "a second servo answers, {servo}: the run stays with the one that answered first"
                        );
                    }
                    continue;
                }
            }
            let heard = StrainRateAnswer::try_from(&message)
                .map_err(|e| e.to_string())
                .and_then(|answer| self.barrier.hear(&answer).map_err(|e| e.to_string()));
            match heard {
                Ok(Heard::New) => {
                    if self.partner.stay_with(info.writer) {
                        log::info!("{} is the servo from now on", bus.describe(info.writer));
                    }
                }
                Ok(Heard::Stale) => {}
                Ok(Heard::Contradicts) => {
                    if self.barrier.counts.contradictions.is_power_of_two() {
                        let (sequence, servo) = (message.sequence, bus.describe(info.writer));
                        log::error!(
                            "request {sequence} was answered twice, differently, by {servo}: the first counts"
                        );
                    }
                }
                Err(error) => {
                    bus.count_refused(self.strain_rate.id());
                    let over = self.barrier.refuse(now);
                    if over || self.barrier.counts.refused.is_power_of_two() {
                        let servo = bus.describe(info.writer);
                        log::warn!("answer {} of {servo}: {error}", message.sequence);
                    }
                    if over {
                        let reason = format!(
                            "{REFUSALS_ALLOWED} answers in a row were refused, the last one: {error}"
                        );
                        return Ok(Some(reason));
                    }
                }
            }
        }
        Ok(None)
    }

    /// The next request, or the end.
    pub(crate) fn go_on(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Next, NodeError> {
        let Some(request) = self.run.request() else {
            self.stage = Stage::Finished;
            self.next_beat = now + BEAT;
            self.post_run_state(RunState::FINISHED, "");
            log::info!("the loading path is done at step {}", self.run.engine().steps());
            return self.rest(bus);
        };
        let message = match messages::stress(&request) {
            Ok(message) => message,
            Err(error) => return self.fail(bus, &error.to_string()),
        };
        // The servo would refuse it, and every repetition, for ever.
        let (law, tangent) = (&request.law, &request.observables.tangent);
        if let Err(error) =
            grainlab_servo::check_stability(law, tangent, &request.controls, request.control_interval)
        {
            return self.fail(bus, &format!("the servo cannot be stable: {error}"));
        }
        self.stage = Stage::Running;
        let body = to_cdr(&message);
        self.outbox.post_request(self.stress.id(), body.clone());
        self.barrier.ask(Question::of(&request), body, now);
        let delivered = self.outbox.deliver(bus)?;
        // Free run needs no answer to go on.
        let free = self.settings.mode != Mode::Lockstep;
        Ok(match delivered {
            false => Next::Wait(HOLD),
            true if free => Next::Again,
            // By then the answer should be there, and there is nothing to wait for.
            true if self.look_ahead(bus, &request) => Next::Again,
            true => Next::Wait(self.barrier.patience(now)),
        })
    }

    /// Computes on while the answer is on its way; false if it does not.
    fn look_ahead(&mut self, bus: &dyn Bus, request: &ServoRequest) -> bool {
        let ahead = self.looks_ahead.then(|| Ahead::of(&self.run, request, || bus.now()));
        self.ahead = ahead.flatten();
        self.ahead.as_ref().inspect(|ahead| self.barrier.computed(ahead.took)).is_some()
    }

    /// Obeys an answer, which may have been done already.
    fn obey(&mut self, bus: &dyn Bus, rate: &[f64; 6]) -> Result<StepOutcome, ExperimentError> {
        let sequence = self.barrier.sequence();
        match self.ahead.take() {
            Some(ahead) if ahead.obeyed(sequence, rate) => {
                self.foreseen += 1;
                self.computing += ahead.took;
                self.run = ahead.run;
                return ahead.result;
            }
            Some(_) => {
                log::info!(
                    "the servo answers request {sequence} by a law of its own: the run is not computed ahead any more"
                );
                self.looks_ahead = false;
            }
            None => {}
        }
        let began = bus.now();
        let result = self.run.advance(rate);
        self.computing += bus.now().saturating_sub(began);
        result
    }

    /// One exchange at most.
    pub(crate) fn exchange(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Next, NodeError> {
        if let Some(rate) = self.barrier.pass(now) {
            return match self.obey(bus, &rate) {
                Ok(advanced) => self.advanced(bus, &advanced),
                Err(error) => self.fail(bus, &error.to_string()),
            };
        }
        for body in self.barrier.resend(now).into_iter().flatten().filter(|body| !body.is_empty()) {
            match bus.publish(self.stress.id(), body) {
                // It is due again anyway.
                Ok(_) | Err(BusError::Full { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        if self.barrier.waited(now) > NOTICE_PERIOD && self.notice_due(now) {
            let waited = self.barrier.waited(now).as_secs();
            log::warn!(
                "no answer to request {} for {waited} s: is servo_controller running?",
                self.barrier.sequence()
            );
        }
        Ok(Next::Wait(self.barrier.patience(now)))
    }

    fn advanced(&mut self, bus: &mut dyn Bus, advanced: &StepOutcome) -> Result<Next, NodeError> {
        let now = bus.now();
        self.wall = now.saturating_sub(self.began);
        if advanced.packing_due
            && let Err(error) = self.post_packing()
        {
            return self.fail(bus, &error.to_string());
        }
        if let Some(phase) = &advanced.ended {
            log::info!("phase {phase} ended at step {}", self.run.engine().steps());
            if let Some(energy) = &advanced.energy {
                log::info!("energy balance of phase {phase}, J: {energy:?}");
            }
            if !advanced.finished {
                self.next_beat = now + BEAT;
                let left_out = self.run.left_out();
                log::info!("the next phase is {left_out}");
                self.post_run_state(RunState::RUNNING, &left_out);
            }
        }
        self.go_on(bus, now)
    }

    pub(crate) fn rest(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        self.outbox.deliver(bus)?;
        if !self.outbox.is_empty() {
            return Ok(Next::Wait(HOLD));
        }
        if self.settings.exit_when_finished {
            self.farewell(bus);
            return Ok(Next::Finished(Exit::Done));
        }
        Ok(Next::Wait(self.next_beat.saturating_sub(bus.now())))
    }
}
