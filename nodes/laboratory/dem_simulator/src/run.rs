//! The run as the simulator computes it: its state, a step ahead of the answer, and the time that computing takes.

use crate::speculative_step::{GRAINS, SpeculativeStep};
use grainlab_experiment::{ExperimentError, Simulation, StepOutcome};
use grainlab_servo::ServoRequest;
use std::time::Duration;

pub(crate) struct Run {
    simulation: Simulation,
    /// The run after the next steps if the answer is the one that the law gives.
    speculative: Option<SpeculativeStep>,
    /// True while speculative steps are computed: switched off once the answer of a servo differs.
    speculates: bool,
    /// Answers that equal the one a speculative step was computed with.
    foreseen: u64,
    first_step: u64,
    computing: Duration,
    /// Duration and end of the last step that was not speculative.
    last_advance: (Duration, Duration),
}

impl Run {
    /// Takes up a simulation. With `ahead`, steps of small packings are computed ahead of their answers.
    pub(crate) fn new(simulation: Simulation, ahead: bool, now: Duration) -> Self {
        Self {
            speculative: None,
            speculates: ahead && simulation.scene().grains <= GRAINS,
            foreseen: 0,
            first_step: simulation.engine().steps(),
            computing: Duration::ZERO,
            last_advance: (Duration::ZERO, now),
            simulation,
        }
    }

    pub(crate) fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Computes a step ahead of the answer to `request`, and returns the time that it took; `now` reads a clock. `None` if no step
    /// was computed.
    pub(crate) fn compute_ahead(
        &mut self,
        request: &ServoRequest,
        now: impl Fn() -> Duration,
    ) -> Option<Duration> {
        let step = self.speculates.then(|| SpeculativeStep::of(&self.simulation, request, now));
        self.speculative = step.flatten();
        self.speculative.as_ref().map(|step| step.took)
    }

    /// Advances the run with the answer to request `sequence`, or takes the step that was computed ahead with it.
    ///
    /// # Errors
    /// As [`Simulation::advance`].
    pub(crate) fn advance(
        &mut self,
        sequence: u64,
        rate: &[f64; 6],
        now: impl Fn() -> Duration,
    ) -> Result<StepOutcome, ExperimentError> {
        match self.speculative.take() {
            Some(step) if step.matches(sequence, rate) => {
                self.foreseen += 1;
                self.computing += step.took;
                self.simulation = step.run;
                return step.result;
            }
            Some(_) => {
                log::info!(
                    "the answer to request {sequence} differs from the answer of the servo's law: speculative steps are switched off"
                );
                self.speculates = false;
            }
            None => {}
        }
        let began = now();
        let result = self.simulation.advance(rate);
        let end = now();
        self.last_advance = (end.saturating_sub(began), end);
        self.computing += self.last_advance.0;
        result
    }

    /// Returns duration and end of the last step that was not speculative.
    pub(crate) fn last_advance(&self) -> (Duration, Duration) {
        self.last_advance
    }

    /// Returns the number of answers that equal the one a speculative step was computed with.
    pub(crate) fn foreseen(&self) -> u64 {
        self.foreseen
    }

    /// Returns the number of solver steps done by this process.
    pub(crate) fn steps(&self) -> u64 {
        self.simulation.engine().steps().saturating_sub(self.first_step)
    }

    /// Returns the time that the steps took.
    pub(crate) fn computing(&self) -> Duration {
        self.computing
    }
}
