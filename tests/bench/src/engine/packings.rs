//! Packings that settings lead to, compared with those of converged runs.

use super::run::{Outcome, Runs, Sample, finished, press, reason};
use super::settings::{VariedSetting, converged};
use super::statistics::{Observables, combined, estimate, is_resolved, paired};
use crate::plot::time;
use crate::row::{Family, Row};
use grainlab_console::{Failure, say};
use grainlab_node_kit::Exit;
use grainlab_page::median;
use grainlab_scene::Scene;

/// Runs with this many times the steps of the default count as failed: twice the number needed by the slowest
/// setting.
const PATIENCE: u64 = 8;

/// Names of the mean errors of the observables and of their standard errors over the seeds.
const ERRORS: [&str; 5] = ["error_k", "error_eps", "error_phi", "error_g12", "error_theta"];
const STANDARD_ERRORS: [&str; 5] = [
    "standard_error_k",
    "standard_error_eps",
    "standard_error_phi",
    "standard_error_g12",
    "standard_error_theta",
];

/// A row for each value of each setting. Moduli are relative to those of the converged run.
pub(crate) fn packings(settings: &[VariedSetting], quick: bool, runs: &Runs) -> Result<Vec<Row>, Failure> {
    let scene = press()?;
    let careful = converged(&scene, quick);
    let default = runs.every_seed(&[(&scene, None)])?.into_iter().next().unwrap_or_default();
    let limits: Vec<u64> =
        default.iter().map(|r| r.as_ref().map_or(u64::MAX, |o| PATIENCE * o.steps)).collect();
    let values: Vec<(VariedSetting, f64, Scene)> = settings
        .iter()
        .flat_map(|s| s.values(&scene, quick).into_iter().map(|(value, scene)| (*s, value, scene)))
        .collect();
    let mut jobs = vec![(&careful, None)];
    jobs.extend(values.iter().filter(|v| v.2 != scene).map(|v| (&v.2, Some(&limits[..]))));
    let mut samples = runs.every_seed(&jobs)?.into_iter();
    let reference = samples.next().unwrap_or_default();
    say!("grainlab: a converged run takes {}", time(median(finished(&reference, |o| o.seconds))));
    let base = Base::of(&reference, &default).ok_or_else(|| {
        let reason = [&default, &reference].into_iter().find_map(reason);
        let reason = reason.unwrap_or_else(|| "no run has a result".to_owned());
        let why = "fewer than two seeds succeeded, so that there is no reference";
        Failure::new(Exit::PhysicsInvalid, format!("{why}: {reason}"))
    })?;
    let row = |(setting, value, varied): &(VariedSetting, f64, Scene)| {
        let own = *varied == scene;
        let sample = if own { default.clone() } else { samples.next().unwrap_or_default() };
        // A factor leaves digits that are not significant.
        let value = format!("{}{}", (value * 1e4).round() / 1e4, if own { " (default)" } else { "" });
        let row = base.row((setting.name().replace('_', " "), value), &sample);
        Row { grains: Some(varied.grains as usize), ..row }
    };
    Ok(values.iter().map(row).collect())
}

/// Results to compare with.
struct Base {
    /// Results of the converged run.
    values: Vec<Option<Observables>>,
    /// Means over the seeds of its moduli, Pa.
    moduli: [f64; 2],
    /// Standard deviation from seed to seed at the default.
    scatter: Observables,
}

impl Base {
    /// `None` unless two runs of the converged setting and two of the default succeeded.
    fn of(reference: &Sample, default: &Sample) -> Option<Self> {
        let mean = |q: usize| Some(estimate(finished(reference, |o| o.observables[q]))?.value);
        let moduli = [mean(3)?, mean(4)?];
        let values = relative(default, moduli);
        let of = |q: usize| {
            let mean = estimate(values.iter().flatten().map(|o| o[q]))?;
            Some(mean.error? * (mean.count as f64).sqrt())
        };
        let scatter = [of(0)?, of(1)?, of(2)?, of(3)?, of(4)?];
        Some(Self { values: relative(reference, moduli), moduli, scatter })
    }

    fn row(&self, names: (String, String), sample: &Sample) -> Row {
        let errors = paired(&relative(sample, self.moduli), &self.values);
        let seconds = finished(sample, |o| o.seconds);
        let combined = errors.and_then(|errors| combined(&errors, &self.scatter));
        let runs = seconds.len();
        let reference = (combined, "every setting at its most accurate value");
        let mut row = Row::new(Family::EnginePacking, names, (median(seconds), runs), reference);
        // The combined error contains the bound of each quantity whose error is not resolved.
        row.upper_bound = errors.is_some_and(|errors| !errors.iter().all(is_resolved));
        row.failure =
            reason(sample).map(|why| format!("{} of {} runs fail: {why}", sample.len() - runs, sample.len()));
        let resolved = errors.map(|errors| errors.into_iter().filter(is_resolved).count() as f64);
        row.details.extend(resolved.map(|count| ("resolved", count)));
        for (q, error) in errors.iter().flatten().enumerate() {
            row.details.insert(ERRORS[q], error.value);
            row.details.extend(error.error.map(|e| (STANDARD_ERRORS[q], e)));
        }
        row
    }
}

fn relative(sample: &Sample, moduli: [f64; 2]) -> Vec<Option<Observables>> {
    let one = |o: &Outcome| {
        let [k, eps, phi, g12, theta] = o.observables;
        [k, eps, phi, g12 / moduli[0], theta / moduli[1]]
    };
    sample.iter().map(|r| r.as_ref().ok().map(one)).collect()
}
