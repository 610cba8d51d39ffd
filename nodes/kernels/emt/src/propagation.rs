//! First-order propagation of errors.

use crate::error::EmtError;
use crate::model::Slopes;
use crate::observation::{INPUTS, Observation};
use crate::structure::Structure;
use nalgebra::SVector;

/// Relative step: central differences are off by its square times a third derivative, and by rounding over it.
const STEP: f64 = 1e-5;

/// Slopes of `solve` at `observation`, where it gives `structure`, by central differences; one-sided at the edge of what
/// can be solved.
pub(crate) fn numerical_slopes(
    observation: &Observation,
    structure: &Structure,
    solve: impl Fn(&Observation) -> Result<Structure, EmtError>,
) -> Slopes {
    let here = column(structure);
    let mut slopes = Slopes::zeros();
    for input in 0..INPUTS {
        let at = |by: f64| {
            let moved = observation.moved(input, by)?;
            solve(&moved).ok().map(|s| column(&s))
        };
        let slope = match (at(STEP), at(-STEP)) {
            (Some(up), Some(down)) => (up - down) / (2.0 * STEP),
            (Some(up), None) => (up - here) / STEP,
            (None, Some(down)) => (here - down) / STEP,
            (None, None) => continue,
        };
        slopes.set_column(input, &slope);
    }
    slopes
}

fn column(structure: &Structure) -> SVector<f64, { crate::structure::QUANTITIES }> {
    SVector::from(structure.values().map(|v| v.unwrap_or(0.0)))
}
