//! Computing on while the answer is on its way.
//!
//! A servo is a pure function of one request, and its law is known here, too. So the simulator advances a copy of the run
//! with the answer that the law gives. If the answer that comes is this one, bit for bit, the copy is the run; if not,
//! the copy is dropped, and the run obeys. Nothing of the copy is published before that, so that requests, answers and
//! every other message are what they are without it.

use grainlab_experiment::{ExperimentError, ServoRequest, Simulation, StepOutcome};
use std::time::Duration;

/// Grains up to which a copy (some 25 ns a grain) costs less than the wait that it saves (0.1 ms and more).
pub(crate) const GRAINS: u32 = 4000;

/// A copy of the run that obeyed an answer which has not come yet.
pub(crate) struct Ahead {
    sequence: u64,
    rate: [f64; 6],
    /// The run after it.
    pub(crate) run: Simulation,
    /// What it led to.
    pub(crate) result: Result<StepOutcome, ExperimentError>,
    /// Time that it took to compute.
    pub(crate) took: Duration,
}

impl Ahead {
    /// Advances a copy of `run` with the answer that the law gives to `request`; `now` reads a clock.
    ///
    /// `None` where the law gives none.
    pub(crate) fn of(run: &Simulation, request: &ServoRequest, now: impl Fn() -> Duration) -> Option<Self> {
        let answer = grainlab_servo::answer(&request.servo_input());
        let rate = answer.ok()?.rate;
        let began = now();
        let mut run = run.clone();
        let result = run.advance(&rate);
        Some(Self { sequence: request.sequence, rate, run, result, took: now().saturating_sub(began) })
    }

    /// Whether `rate` is what the copy obeyed as the answer to request `sequence`, to the last bit.
    pub(crate) fn obeyed(&self, sequence: u64, rate: &[f64; 6]) -> bool {
        self.sequence == sequence && self.rate.map(f64::to_bits) == rate.map(f64::to_bits)
    }
}
