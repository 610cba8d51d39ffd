//! The search for the coordination number on a grid, so that a second solution is reported and not missed.

use super::fit::{Data, Fit};
use super::state::State;
use crate::calibration::RelaxationCalibration;
use crate::error::EmtError;
use grainlab_core::notes::Note;

/// Number of coordination numbers tried: their spacing, 0.1, is a few times the error of an exact measurement.
const GRID: usize = 24;

/// Maximum number of Gauss–Newton steps; three or four suffice for data that fit.
const STEPS: usize = 60;

/// Change of (z, ε) at which the steps end; larger where the weights depend on derivatives by the state, which are numerical.
const SETTLED: f64 = 1e-13;
const SETTLED_WITH_ERRORS: f64 = 1e-9;

/// Difference of twice the log-likelihood below which two solutions are equally good (two sigma).
const AMBIGUOUS: f64 = 4.0;

/// The most probable solution, if it is unique.
pub(super) fn best(
    data: &Data,
    network: &RelaxationCalibration,
    state: &State,
    calibration: &str,
    coordination_alone: bool,
) -> Result<Fit, EmtError> {
    let [low, high] = network.domain();
    let fits_eps = !coordination_alone;
    let uncertain = state.inputs.iter().any(|input| input.variance > 0.0);
    let settled = if uncertain { SETTLED_WITH_ERRORS } else { SETTLED };
    let at = |z: f64, eps: Option<f64>| Fit::at(data, network, state, z, eps, fits_eps);
    let z_of = |i: usize| low + (high - low) * i as f64 / (GRID - 1) as f64;
    let mut objective = [f64::INFINITY; GRID];
    for (i, value) in objective.iter_mut().enumerate() {
        *value = at(z_of(i), None).map_or(f64::INFINITY, |fit| fit.objective);
    }
    let mut found: Vec<Fit> = Vec::with_capacity(2);
    for i in 0..GRID {
        let lower = |j: usize| objective[j] < objective[i];
        if !objective[i].is_finite() || (i > 0 && lower(i - 1)) || (i + 1 < GRID && lower(i + 1)) {
            continue;
        }
        let Some(fit) = refined(&at, z_of(i), [low, high], settled) else { continue };
        if found.iter().all(|other| (other.z - fit.z).abs() > 1e-6) {
            found.push(fit);
        }
    }
    found.sort_by(|a, b| a.objective.total_cmp(&b.objective));
    if let [first, second, ..] = found.as_slice()
        && second.objective - first.objective < AMBIGUOUS
    {
        return Err(Note::ambiguous(first.z, second.z).into());
    }
    found.into_iter().next().ok_or_else(|| {
        let nearest = (0..GRID).min_by(|a, b| objective[*a].total_cmp(&objective[*b])).unwrap_or(0);
        Note::no_coordination(calibration.to_owned(), z_of(nearest), low, high).into()
    })
}

/// Gauss–Newton from a point of the grid; `None` if it leaves the domain or does not converge.
fn refined(
    at: &impl Fn(f64, Option<f64>) -> Option<Fit>,
    start: f64,
    [low, high]: [f64; 2],
    settled: f64,
) -> Option<Fit> {
    let spacing = (high - low) / (GRID - 1) as f64;
    let mut fit = at(start, None)?;
    let mut outside = 0;
    for _ in 0..STEPS {
        let [dz, deps] = fit.step();
        if !(dz.is_finite() && deps.is_finite()) {
            return None;
        }
        if dz.abs() < 10.0 * settled * fit.z && deps.abs() < settled {
            let inside = (low - 1e-9..=high + 1e-9).contains(&fit.z);
            return inside.then_some(fit);
        }
        // The linearisation is trusted over twice the grid's spacing.
        let shorten = (2.0 * spacing / dz.abs()).min(1.0);
        let z = (fit.z + shorten * dz).clamp(low - 0.5 * spacing, high + 0.5 * spacing);
        if !(low..=high).contains(&z) {
            outside += 1;
            if outside > 4 {
                return None;
            }
        }
        fit = at(z, Some(fit.eps + deps))?;
    }
    None
}
