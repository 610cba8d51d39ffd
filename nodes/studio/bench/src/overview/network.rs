//! The stiffness of the contact network.

use super::row::{Family, Row};
use crate::packing::load;
use crate::stiffness::{self, measured};
use grainlab_console::Failure;

/// Relative residuals at which the iterations stop.
const TOLERANCES: [f64; 5] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-12];

/// Strains of explicit probes.
const AMPLITUDES: [f64; 2] = [1e-5, 1e-7];

pub(super) fn rows(quick: bool) -> Result<Vec<Row>, Failure> {
    let packing = load(None)?;
    let (amplitudes, repetitions) = if quick { (&[][..], 3) } else { (&AMPLITUDES[..], 7) };
    let found = measured(&packing, &TOLERANCES, amplitudes, repetitions)?;
    Ok(found.iter().filter_map(|row| of(row, repetitions)).collect())
}

/// `None` if the method failed.
fn of(found: &stiffness::Row, repetitions: u32) -> Option<Row> {
    let probe = found.method == stiffness::Method::Probe;
    let setting = found.value.map_or_else(String::new, |v| format!("{v:e}"));
    let setting = if probe { format!("{setting} strain") } else { setting };
    Some(Row::new(
        Family::Stiffness,
        (found.method.name().replace('_', " "), setting),
        (found.seconds, if probe { 1 } else { repetitions as usize }),
        (found.error.stiffness?, found.error.against),
    ))
}
