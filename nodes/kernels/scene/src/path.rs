//! The loading path as a state machine.

use crate::model::{Condition, Measure, Phase, Scene};
use grainlab_core::{ComponentControl, SymTensor};

/// The state of the packing that the path evaluates at each exchange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Simulated time, s.
    pub time: f64,
    /// Stress, Pa, positive in compression.
    pub stress: SymTensor,
    /// Logarithmic strain since the phase began, positive in extension.
    pub strain: SymTensor,
    /// Solid fraction.
    pub solid_fraction: f64,
    /// Unbalanced force ratio; 1 without contacts.
    pub unbalanced: f64,
    /// Root mean square speed relative to the affine motion, m/s.
    pub speed: f64,
}

/// Position of the run on its path: everything needed to continue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathState {
    /// Index of the phase under way; the number of phases once the path is done.
    pub phase: usize,
    /// Simulated time at which the phase began, s.
    pub began: f64,
    /// Simulated time since which every condition has held; `None` while one does not.
    pub holding_since: Option<f64>,
}

/// The result of an observation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEvent {
    /// The phase continues.
    Stay,
    /// The phase is over; `PathState::phase` is already the next.
    PhaseEnded {
        /// The state is the reference of strains from now on.
        reference: bool,
        /// The packing is to be published.
        publish: bool,
        /// That was the last phase.
        finished: bool,
    },
}

/// The path cannot continue.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PathError {
    /// A phase exceeded its timeout.
    #[error(
        "phase {number} ({name}) did not meet its end conditions within {timeout} s of simulated time: {unmet}; \
         raise its timeout, loosen the condition, or change the loading",
        number = .index + 1
    )]
    Timeout {
        /// Index of the phase, from 0; the message counts from 1, as progress does.
        index: usize,
        /// Name of the phase.
        name: String,
        /// Its timeout, s.
        timeout: f64,
        /// The conditions not met, with the values seen.
        unmet: String,
    },
}

impl PathState {
    /// The beginning of a path.
    pub const START: PathState = PathState { phase: 0, began: 0.0, holding_since: None };

    /// The phase under way; `None` once the path is done.
    pub fn phase<'a>(&self, scene: &'a Scene) -> Option<&'a Phase> {
        scene.phases.get(self.phase)
    }

    /// Share of the path done, 0 to 1, counted in phases.
    pub fn progress(&self, scene: &Scene) -> f64 {
        self.phase as f64 / scene.phases.len() as f64
    }

    /// Evaluates one observation, and advances if the phase is over.
    pub fn observe(&mut self, scene: &Scene, seen: &Observation) -> Result<PathEvent, PathError> {
        let Some(phase) = scene.phases.get(self.phase) else { return Ok(PathEvent::Stay) };
        let elapsed = seen.time - self.began;
        let unmet: Vec<_> = phase.until.all.iter().filter(|c| !holds(c, phase, seen, elapsed)).collect();
        if unmet.is_empty() {
            let since = *self.holding_since.get_or_insert(seen.time);
            if seen.time - since >= phase.until.hold {
                *self = PathState { phase: self.phase + 1, began: seen.time, holding_since: None };
                let finished = self.phase == scene.phases.len();
                return Ok(PathEvent::PhaseEnded {
                    reference: phase.reference,
                    publish: phase.publish,
                    finished,
                });
            }
        } else {
            self.holding_since = None;
        }
        if elapsed > phase.until.timeout {
            let unmet: Vec<String> = unmet.iter().map(|c| describe(c, phase, seen, elapsed)).collect();
            let unmet = if unmet.is_empty() { "not held long enough".into() } else { unmet.join(", ") };
            let (index, name, timeout) = (self.phase, phase.name.clone(), phase.until.timeout);
            return Err(PathError::Timeout { index, name, timeout, unmet });
        }
        Ok(PathEvent::Stay)
    }
}

fn measured(measure: Measure, seen: &Observation, elapsed: f64) -> f64 {
    match measure {
        Measure::SolidFraction => seen.solid_fraction,
        Measure::Elapsed => elapsed,
        Measure::Strain(c) => seen.strain.voigt()[c],
        Measure::Stress(c) => seen.stress.voigt()[c],
        Measure::Pressure => seen.stress.mean(),
        Measure::Deviator => {
            let [xx, yy, zz, ..] = seen.stress.voigt();
            zz - 0.5 * (xx + yy)
        }
        Measure::Unbalanced => seen.unbalanced,
        Measure::Speed => seen.speed,
    }
}

/// Largest error of a servoed stress component over the mean stress target.
fn target_error(phase: &Phase, seen: &Observation) -> f64 {
    let controls = phase.controls();
    let target = |i: usize| match controls[i] {
        ComponentControl::Stress(s) => Some(s),
        _ => None,
    };
    let normal: Vec<f64> = (0..3).filter_map(target).collect();
    let mean = normal.iter().sum::<f64>() / normal.len().max(1) as f64;
    let stress = seen.stress.voigt();
    (0..6).filter_map(|i| target(i).map(|t| (stress[i] - t).abs() / mean)).fold(0.0, f64::max)
}

fn holds(condition: &Condition, phase: &Phase, seen: &Observation, elapsed: f64) -> bool {
    match *condition {
        Condition::AtLeast(m, value) => measured(m, seen, elapsed) >= value,
        Condition::AtMost(m, value) => measured(m, seen, elapsed) <= value,
        Condition::OnTarget { fraction } => target_error(phase, seen) <= fraction,
    }
}

fn describe(condition: &Condition, phase: &Phase, seen: &Observation, elapsed: f64) -> String {
    match *condition {
        Condition::AtLeast(m, v) => format!("{m:?} is {:.4e}, below {v:e}", measured(m, seen, elapsed)),
        Condition::AtMost(m, v) => format!("{m:?} is {:.4e}, above {v:e}", measured(m, seen, elapsed)),
        Condition::OnTarget { fraction } => {
            format!("stress is off target by {:.4e}, above {fraction:e}", target_error(phase, seen))
        }
    }
}
