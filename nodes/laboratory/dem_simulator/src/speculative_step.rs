//! Computing while the answer is in transit.
//!
//! A servo is a pure function of one request, with a law that the simulator can evaluate. The simulator
//! advances a copy of the run with the predicted answer. If the answer received is the same to the last bit,
//! the copy becomes the run; if not, the copy is dropped and the run is advanced with the answer. Nothing of
//! the copy is published before that: all messages are the same as without it.

use grainlab_experiment::{ExperimentError, Simulation, StepOutcome};
use grainlab_servo::ServoRequest;
use std::time::Duration;

/// Number of grains up to which a copy (about 25 ns per grain) costs less than the wait that it saves (0.1 ms or more).
pub(crate) const GRAINS: u32 = 4000;

/// A copy of the run, advanced with an answer that has not been received yet.
pub(crate) struct SpeculativeStep {
    sequence: u64,
    rate: [f64; 6],
    pub(crate) run: Simulation,
    pub(crate) result: Result<StepOutcome, ExperimentError>,
    pub(crate) took: Duration,
}

impl SpeculativeStep {
    /// Advances a copy of `run` with the predicted answer to `request`; `now` reads a clock. `None` if the
    /// law has no answer, or the engine cannot be copied.
    pub(crate) fn of(run: &Simulation, request: &ServoRequest, now: impl Fn() -> Duration) -> Option<Self> {
        let answer = grainlab_servo::control(&request.input);
        let rate = answer.ok()?.rate;
        let began = now();
        let mut run = run.fork()?;
        let result = run.advance(&rate);
        Some(Self { sequence: request.sequence, rate, run, result, took: now().saturating_sub(began) })
    }

    /// True if the copy was advanced with exactly `rate` as the answer to request `sequence`.
    pub(crate) fn matches(&self, sequence: u64, rate: &[f64; 6]) -> bool {
        self.sequence == sequence && self.rate.map(f64::to_bits) == rate.map(f64::to_bits)
    }
}
