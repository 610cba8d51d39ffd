//! First-order propagation of errors.

use crate::error::EmtError;
use crate::observation::{INPUTS, Observation};
use crate::point_estimate::Jacobian;
use grainlab_core::Material;
use grainlab_core::results::{InferredQuantity, Microstructure};
use nalgebra::SVector;

/// Relative step. The error of central differences is its square times a third derivative, plus rounding over it.
const STEP: f64 = 1e-5;

/// Derivatives of `solve` at `observation`, where it gives `structure`, by central differences, or by
/// one-sided ones if a neighbouring observation has no solution.
pub(crate) fn numerical_jacobian(
    observation: &Observation,
    structure: &Microstructure,
    material: &Material,
    solve: impl Fn(&Observation) -> Result<Microstructure, EmtError>,
) -> Jacobian {
    let here = column(structure);
    let mut jacobian = Jacobian::zeros();
    for input in 0..INPUTS {
        let at = |by: f64| {
            let moved = observation.moved(input, by, material)?;
            solve(&moved).ok().map(|s| column(&s))
        };
        let slope = match (at(STEP), at(-STEP)) {
            (Some(up), Some(down)) => (up - down) / (2.0 * STEP),
            (Some(up), None) => (up - here) / STEP,
            (None, Some(down)) => (here - down) / STEP,
            (None, None) => continue,
        };
        jacobian.set_column(input, &slope);
    }
    jacobian
}

fn column(structure: &Microstructure) -> SVector<f64, { InferredQuantity::COUNT }> {
    SVector::from(structure.values().map(|v| v.unwrap_or(0.0)))
}
