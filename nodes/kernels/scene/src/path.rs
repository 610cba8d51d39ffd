//! The loading path as a state machine.

use crate::model::{Condition, Measure, Phase, PhaseKind, Scene};
use grainlab_core::{ComponentControl, ServoLaw, SymTensor};

/// The state of the packing that the path evaluates at each exchange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Simulated time, s.
    pub time: f64,
    /// Stress, Pa, positive in compression.
    pub stress: SymTensor,
    /// Logarithmic strain since the phase began, positive in extension.
    pub strain: SymTensor,
    /// Solid fraction of the packing.
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

/// A phase is over; `PathState::phase` is already the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhaseEnded {
    /// The state is the reference of strains from now on.
    pub reference: bool,
    /// The packing is to be published.
    pub publish: bool,
    /// That was the last phase.
    pub finished: bool,
}

/// A phase exceeded its timeout: the conditions not met, with the values seen.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PathError(String);

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

    /// Evaluates one observation, and advances if the phase is over; `None` while it continues.
    pub fn observe(&mut self, scene: &Scene, seen: &Observation) -> Result<Option<PhaseEnded>, PathError> {
        let Some(phase) = scene.phases.get(self.phase) else { return Ok(None) };
        let elapsed = seen.time - self.began;
        if phase.until.all.iter().all(|c| holds(c, phase, seen, elapsed)) {
            let since = *self.holding_since.get_or_insert(seen.time);
            if seen.time - since >= phase.until.hold {
                *self = PathState { phase: self.phase + 1, began: seen.time, holding_since: None };
                let Phase { reference, publish, .. } = *phase;
                let finished = self.phase == scene.phases.len();
                return Ok(Some(PhaseEnded { reference, publish, finished }));
            }
        } else {
            self.holding_since = None;
        }
        if elapsed > phase.until.timeout {
            let (number, timeout) = (self.phase + 1, phase.until.timeout);
            let remedy = "raise its timeout, loosen the condition, take more grains, or change the loading";
            let remedy = match undamped(phase, seen) {
                Some(leak) => format!(
                    "if the stress swings about its target, raise the leak of the phase, {leak} now, lower its rate_limit, or take \
                     law = \"scaled\"; else {remedy}"
                ),
                None => remedy.to_owned(),
            };
            return Err(PathError(format!(
                "phase {number} ({}) did not meet its end conditions within {timeout} s of simulated time: {}; {remedy}",
                phase.name,
                self.unmet(scene, seen)
            )));
        }
        Ok(None)
    }

    /// The conditions of the present phase that do not hold, each with its value and its bound; or for how long all of them
    /// have held. Empty once the path is done.
    pub fn unmet(&self, scene: &Scene, seen: &Observation) -> String {
        let Some(phase) = self.phase(scene) else { return String::new() };
        let elapsed = seen.time - self.began;
        let unmet = phase.until.all.iter().filter(|c| !holds(c, phase, seen, elapsed));
        let unmet: Vec<String> = unmet.map(|c| describe(c, phase, seen, elapsed)).collect();
        if unmet.is_empty() {
            let held = seen.time - self.holding_since.unwrap_or(seen.time);
            return format!("all hold for {held:.1e} of {:e} s", phase.until.hold);
        }
        unmet.join(", ")
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

struct TargetError {
    component: usize,
    /// Stress target, Pa.
    target: f64,
    /// |σ − σ*| over the mean stress target.
    relative: f64,
}

/// Returns the servoed stress component that is farthest off its target; `None` where no stress is servoed.
fn target_error(phase: &Phase, seen: &Observation) -> Option<TargetError> {
    let controls = phase.controls();
    let target = |i: usize| match controls[i] {
        ComponentControl::Stress(s) => Some(s),
        _ => None,
    };
    let normal: Vec<f64> = (0..3).filter_map(target).collect();
    let mean = normal.iter().sum::<f64>() / normal.len().max(1) as f64;
    let stress = seen.stress.voigt();
    let errors = (0..6).filter_map(|component| {
        let target = target(component)?;
        Some(TargetError { component, target, relative: (stress[component] - target).abs() / mean })
    });
    errors.max_by(|a, b| a.relative.total_cmp(&b.relative))
}

/// Returns the leak of the law that let a stress miss its target in this phase; `None` where no stress does, and under a law that
/// does not swing.
fn undamped(phase: &Phase, seen: &Observation) -> Option<f64> {
    let PhaseKind::Servo { law: ServoLaw::Normalised { leak, .. } | ServoLaw::Integral { leak, .. }, .. } =
        phase.kind
    else {
        return None;
    };
    let off = |c: &Condition| matches!(c, Condition::OnTarget { .. }) && !holds(c, phase, seen, 0.0);
    phase.until.all.iter().any(off).then_some(leak)
}

fn holds(condition: &Condition, phase: &Phase, seen: &Observation, elapsed: f64) -> bool {
    match *condition {
        Condition::AtLeast(m, value) => measured(m, seen, elapsed) >= value,
        Condition::AtMost(m, value) => measured(m, seen, elapsed) <= value,
        // Without a servoed stress every one is on target.
        Condition::OnTarget { fraction } => {
            target_error(phase, seen).is_none_or(|error| error.relative <= fraction)
        }
    }
}

/// The key of a condition on this measure, without its direction.
pub(crate) fn name(measure: Measure) -> String {
    match measure {
        Measure::SolidFraction => "solid_fraction".to_owned(),
        Measure::Elapsed => "elapsed".to_owned(),
        Measure::Strain(c) => format!("strain {}", SymTensor::COMPONENTS[c]),
        Measure::Stress(c) => format!("stress {}", SymTensor::COMPONENTS[c]),
        Measure::Pressure => "pressure".to_owned(),
        Measure::Deviator => "deviator".to_owned(),
        Measure::Unbalanced => "unbalanced".to_owned(),
        Measure::Speed => "speed".to_owned(),
    }
}

/// A value with five digits, or with all of them if it would look equal to its bound.
fn beside(value: f64, bound: f64) -> String {
    let short = format!("{value:.4e}");
    if short.parse() == Ok(bound) { format!("{value:e}") } else { short }
}

fn describe(condition: &Condition, phase: &Phase, seen: &Observation, elapsed: f64) -> String {
    match *condition {
        Condition::AtLeast(m, v) | Condition::AtMost(m, v) => {
            let side = if matches!(condition, Condition::AtLeast(..)) { "below" } else { "above" };
            format!("{} is {}, {side} {v:e}", name(m), beside(measured(m, seen, elapsed), v))
        }
        Condition::OnTarget { fraction } => {
            let Some(TargetError { component, target, relative }) = target_error(phase, seen) else {
                return String::new();
            };
            let (name, stress) = (SymTensor::COMPONENTS[component], seen.stress.voigt()[component]);
            let wanted = if target == 0.0 { "0".to_owned() } else { format!("{target:e}") };
            let off = beside(relative, fraction);
            format!(
                "stress {name} is {stress:.4e} Pa for {wanted} Pa, off target by {off}, above {fraction:e}"
            )
        }
    }
}
