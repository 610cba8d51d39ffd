//! From outcomes to rows.

use super::front::front;
use super::knobs::{Setting, inertial_number};
use super::measure::Outcome;
use super::row::{Row, Sample, finished};
use super::statistics::{Estimate, Observables, combined, deviation, paired};
use super::verdict::verdict;
use grainlab_scene::Scene;
use serde::Serialize;

/// The whole result.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) scene: String,
    pub(crate) seeds: Vec<u64>,
    pub(crate) reference: Reference,
    pub(crate) rows: Vec<Row>,
    /// The conclusions about the default.
    pub(crate) verdict: Vec<String>,
    pub(crate) notes: [&'static str; 4],
}

const NOTES: [&str; 4] = [
    "error: mean over the seeds of the difference from the converged run at the same seed; change: the same from the default; \
     k, eps, phi as they are, g12 and theta relative to the converged run",
    "not resolved: zero lies in the 95 % interval of the mean (two standard errors, more with few seeds: Student's t); the \
     error may have any value up to that bound. One in twenty resolved errors is due to chance",
    "combined: root mean square of the five errors over their scatter from seed to seed at the default, an unresolved one \
     counted with its bound; 1 is the random error of one packing",
    "seconds: CPU time of the run in its own thread",
];

/// The converged run: every knob at its most accurate value.
#[derive(Debug, Serialize)]
pub(crate) struct Reference {
    pub(crate) grains: u32,
    pub(crate) seconds: Option<f64>,
    pub(crate) steps: Option<f64>,
    pub(crate) inertial_number: Option<f64>,
    /// Means over the seeds; moduli in Pa.
    pub(crate) mean: Observables<Option<f64>>,
    pub(crate) standard_error: Observables<Option<f64>>,
    /// Standard deviation from seed to seed at the default; moduli relative to the converged run's.
    pub(crate) scatter: Observables<f64>,
}

/// Combines the outcomes of the settings. `None` unless two runs of the converged setting and two of the
/// default succeeded.
pub(crate) fn report(
    scene: &Scene,
    seeds: Vec<u64>,
    converged: (&Scene, &Sample),
    default: &Sample,
    samples: &[(Setting, Sample)],
) -> Option<Report> {
    let (careful, reference) = converged;
    let column = |sample: &Sample, q: usize| finished(sample, |o| o.observables.array()[q]);
    let means: [Estimate; 5] = {
        let m: [Option<Estimate>; 5] = std::array::from_fn(|q| Estimate::of(&column(reference, q)));
        [m[0]?, m[1]?, m[2]?, m[3]?, m[4]?]
    };
    let (g12, theta) = (means[3].mean, means[4].mean);
    let relative = |sample: &Sample| -> Vec<Option<Observables<f64>>> {
        let one = |o: &Outcome| {
            let o = o.observables;
            Observables { g12: o.g12 / g12, theta: o.theta / theta, ..o }
        };
        sample.iter().map(|r| r.as_ref().ok().map(one)).collect()
    };
    let (reference_values, default_values) = (relative(reference), relative(default));
    let scatter: Observables<f64> = {
        let finished: Vec<_> = default_values.iter().flatten().collect();
        let of = |q: usize| deviation(&finished.iter().map(|o| o.array()[q]).collect::<Vec<_>>());
        Observables::from_array([of(0)?, of(1)?, of(2)?, of(3)?, of(4)?])
    };
    let row = |(setting, sample): &(Setting, Sample)| {
        let values = relative(sample);
        let (error, change) = (paired(&values, &reference_values), paired(&values, &default_values));
        let combined = error.and_then(|e| combined(&e, &scatter));
        Row { combined, ..Row::new(setting, sample, error, change) }
    };
    let mut rows: Vec<Row> = samples.iter().map(row).collect();
    let points: Vec<(f64, f64)> =
        rows.iter().map(|r| (r.seconds.unwrap_or(f64::NAN), r.combined.unwrap_or(f64::NAN))).collect();
    for (row, on) in rows.iter_mut().zip(front(&points)) {
        row.on_front = on;
    }
    let seconds = Estimate::of(&finished(reference, |o| o.seconds));
    Some(Report {
        scene: scene.name.clone(),
        seeds,
        reference: Reference {
            grains: careful.grains,
            seconds: seconds.map(|s| s.mean),
            steps: Estimate::of(&finished(reference, |o| o.steps as f64)).map(|s| s.mean),
            inertial_number: inertial_number(careful),
            mean: Observables::from_array(means.map(|m| Some(m.mean))),
            standard_error: Observables::from_array(means.map(|m| Some(m.standard_error))),
            scatter,
        },
        verdict: verdict(&rows),
        rows,
        notes: NOTES,
    })
}
