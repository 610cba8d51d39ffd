//! After the start: exchanges up to the end of the loading path, or to a failure.

use super::{DemSimulator, NOTICE_PERIOD, Stage};
use crate::publication::HOLD;
use grainlab_experiment::ExperimentError;
use grainlab_msgs::boundary::BoundaryError;
use grainlab_msgs::msg::Stress;
use grainlab_msgs::to_cdr;
use grainlab_node_kit::{Bus, BusError, Next, NodeError};
use std::time::Duration;

/// How an exchange ends the run.
enum End {
    /// The state is saved. The text is the reason.
    Saved(String),
    /// There is no state to save. A restarted simulator goes on from the last packing.
    Unsaved(NodeError),
}

impl From<ExperimentError> for End {
    fn from(error: ExperimentError) -> Self {
        if error.is_lost() { Self::Unsaved(NodeError::failed(error)) } else { Self::Saved(error.to_string()) }
    }
}

impl From<BoundaryError> for End {
    fn from(error: BoundaryError) -> Self {
        Self::Saved(error.to_string())
    }
}

impl From<BusError> for End {
    fn from(error: BusError) -> Self {
        Self::Unsaved(error.into())
    }
}

impl DemSimulator {
    /// Goes on with the present exchange, or begins the first one.
    pub(super) fn exchange(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Next, NodeError> {
        self.try_exchange(bus, now).or_else(|end| match end {
            End::Saved(reason) => self.fail(bus, &reason),
            End::Unsaved(error) => Err(error),
        })
    }

    fn try_exchange(&mut self, bus: &mut dyn Bus, now: Duration) -> Result<Next, End> {
        // The answer to the present request is applied, as the step that was computed ahead if that had the same answer.
        let sequence = self.servo.request().0;
        let applied = self.servo.answer(now).map(|rate| self.run.advance(sequence, &rate, || bus.now()));
        let now = match applied {
            None if self.stage == Stage::Starting => now,
            None => {
                self.servo.repeat(bus, now)?;
                if self.notice_due(now) {
                    // The next one after twice the time.
                    self.next_notice = now + self.servo.note_silence(bus, now);
                }
                return Ok(Next::Wait(self.servo.patience(now)));
            }
            // The run is at a request that it can be resumed from; the shutdown that follows saves it.
            Some(Err(error)) if error.is_stopped() => {
                self.servo.not_applied();
                return Ok(Next::Again);
            }
            Some(Err(error)) => return Err(error.into()),
            Some(Ok(outcome)) => {
                let now = bus.now();
                self.wall = now.saturating_sub(self.began);
                self.publication.step(self.run.simulation(), &outcome, now)?;
                now
            }
        };

        let Some(request) = self.run.simulation().request() else {
            self.stage = Stage::Finished;
            self.publication.finish(bus, self.run.simulation(), self.servo.request(), now)?;
            return self.wait_after_end(bus).map_err(End::Unsaved);
        };
        let body = to_cdr(&Stress::try_from(&request)?);
        // The servo would refuse the request and every repetition of it.
        grainlab_servo::check_stability(&request.input)
            .map_err(|error| End::Saved(format!("the servo cannot be stable: {error}")))?;
        self.stage = Stage::Running;
        let grains = self.run.simulation().scene().grains;
        self.publication.request(bus, self.servo.stress(), (&request, &body), grains)?;
        self.servo.ask(&request, body, now);
        self.next_notice = now + NOTICE_PERIOD;
        if !self.publication.deliver(bus)? {
            return Ok(Next::Wait(HOLD));
        }
        Ok(match self.run.compute_ahead(&request, || bus.now()) {
            // The answer should be there by now.
            Some(took) => {
                self.servo.computed(took);
                Next::Again
            }
            None => Next::Wait(self.servo.patience(now)),
        })
    }
}
