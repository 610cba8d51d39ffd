//! Wave speeds of a packing, which is prepared first: one whose contacts have all forces and do not slide.

use super::row::{Family, Row};
use crate::accuracy::{measure::prepared, press};
use crate::acoustics::{self, Method, measured};
use crate::numbers::median;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use grainlab_scene::Scene;

/// Size of the packing: the time of a burst through 2,000 grains is minutes.
const GRAINS: u32 = 500;

/// Tolerances of the squared frequencies of a dispersion.
const TOLERANCES: [f64; 3] = [1e-2, 1e-4, 1e-6];

/// Measurements of a dispersion; the other methods, which take far longer, are measured once, and not by `--quick`.
const REPETITIONS: usize = 3;

pub(super) fn rows(quick: bool) -> Result<Vec<Row>, Failure> {
    let scene = Scene { grains: GRAINS, ..press()? };
    let packing = prepared(&scene).map_err(|why| Failure::new(Exit::PhysicsInvalid, why))?;
    let rounds = (0..REPETITIONS).map(|_| measured(&packing, &[Method::Dispersion], &TOLERANCES));
    let rounds = rounds.collect::<Result<Vec<_>, _>>()?;
    let slow = if quick {
        Vec::new()
    } else {
        measured(&packing, &[Method::FirstArrival, Method::CrossCorrelation, Method::Peak], &[])?
    };
    let times = |at: usize| rounds.iter().map(|round| round[at].seconds).collect::<Vec<f64>>();
    let first = rounds.first().into_iter().flatten().enumerate();
    let dispersion = first.filter_map(|(at, row)| of(row, times(at)));
    Ok(dispersion.chain(slow.iter().filter_map(|row| of(row, vec![row.seconds]))).collect())
}

/// `None` if the method failed.
fn of(found: &acoustics::Row, times: Vec<f64>) -> Option<Row> {
    let setting = found.value.map_or(String::new(), |value| format!("{value:e}"));
    let repetitions = times.len();
    Some(Row::new(
        Family::Waves,
        (found.method.name().replace('_', " "), setting),
        (median(times), repetitions),
        (found.error.rms?, "frozen network, the same directions and polarizations"),
    ))
}
