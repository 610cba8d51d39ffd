//! The outcome of one setting.

use super::knobs::{Knob, Setting, Value, inertial_number};
use super::measure::Outcome;
use super::statistics::{Estimate, Observables};
use crate::numbers::median;
use serde::Serialize;

/// The outcome of one setting at each seed.
pub(crate) type Sample = Vec<Result<Outcome, String>>;

/// One setting.
#[derive(Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) knob: Knob,
    pub(crate) value: Value,
    pub(crate) default: bool,
    pub(crate) on_front: bool,
    pub(crate) grains: u32,
    pub(crate) inertial_number: Option<f64>,
    /// Mean CPU time of a run, s.
    pub(crate) seconds: Option<f64>,
    pub(crate) seconds_standard_error: Option<f64>,
    /// Median CPU time of a run, s.
    pub(crate) median_seconds: Option<f64>,
    /// Mean number of solver steps.
    pub(crate) steps: Option<f64>,
    pub(crate) combined: Option<f64>,
    pub(crate) error: Observables<Option<f64>>,
    pub(crate) standard_error: Observables<Option<f64>>,
    pub(crate) resolved: Observables<Option<bool>>,
    pub(crate) change: Observables<Option<f64>>,
    pub(crate) change_standard_error: Observables<Option<f64>>,
    pub(crate) change_resolved: Observables<Option<bool>>,
    /// Seeds at which the run succeeded.
    pub(crate) runs: usize,
    pub(crate) warnings: Vec<String>,
    /// The errors with their standard errors.
    #[serde(skip)]
    pub(crate) errors: Differences,
    /// The changes from the default with their standard errors.
    #[serde(skip)]
    pub(crate) changes: Differences,
}

/// Five differences; `None` if too few runs succeeded.
pub(crate) type Differences = Option<Observables<Estimate>>;

impl Row {
    pub(crate) fn new(setting: &Setting, sample: &Sample, error: Differences, change: Differences) -> Self {
        let seconds = Estimate::of(&finished(sample, |o| o.seconds));
        let mut warnings: Vec<String> = sample.iter().filter_map(|r| r.as_ref().err().cloned()).collect();
        let runs = sample.len() - warnings.len();
        warnings.dedup();
        Self {
            knob: setting.knob,
            value: setting.value.clone(),
            default: setting.default,
            on_front: false,
            grains: setting.scene.grains,
            inertial_number: inertial_number(&setting.scene),
            seconds: seconds.map(|s| s.mean),
            seconds_standard_error: seconds.map(|s| s.standard_error),
            median_seconds: Some(median(finished(sample, |o| o.seconds))).filter(|s| s.is_finite()),
            steps: Estimate::of(&finished(sample, |o| o.steps as f64)).map(|s| s.mean),
            combined: None,
            error: of(error, |e| e.mean),
            standard_error: of(error, |e| e.standard_error),
            resolved: of(error, |e| e.resolved()),
            change: of(change, |e| e.mean),
            change_standard_error: of(change, |e| e.standard_error),
            change_resolved: of(change, |e| e.resolved()),
            runs,
            warnings,
            errors: error,
            changes: change,
        }
    }
}

fn of<T: Copy>(differences: Differences, part: impl Fn(Estimate) -> T) -> Observables<Option<T>> {
    differences.map_or(Observables::from_array([None; 5]), |d| d.map(|e| Some(part(e))))
}

/// A value of each run that succeeded.
pub(crate) fn finished<T>(sample: &Sample, part: impl Fn(&Outcome) -> T) -> Vec<T> {
    sample.iter().filter_map(|r| r.as_ref().ok()).map(part).collect()
}
