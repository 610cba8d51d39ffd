//! The engine: the energy that a time step creates, and the packings that other settings lead to.

use super::row::{Family, Row};
use crate::accuracy::integration::integration;
use crate::accuracy::knobs::Knob;
use crate::accuracy::{Plan, measured, press, row};
use grainlab_console::Failure;

/// Time steps, shares of the stability bound; the default of the scene is among them.
const SHARES: [f64; 4] = [0.2, 0.4, 0.8, 1.0];
const QUICK_SHARES: [f64; 2] = [0.2, 0.8];

/// Settings whose packings are compared with those of a converged run.
const KNOBS: [Knob; 3] = [Knob::StrainRate, Knob::ControlPeriod, Knob::Grains];

pub(super) fn rows(quick: bool, threads: usize) -> Result<Vec<Row>, Failure> {
    let scene = press()?;
    let (shares, seeds, runs) = if quick { (&QUICK_SHARES[..], 2, 3) } else { (&SHARES[..], 5, 5) };
    let energy = integration(&scene, shares, seeds, threads)?;
    let mut rows: Vec<Row> = energy
        .iter()
        .map(|found| {
            Row::new(
                Family::EngineEnergy,
                ("time step", format!("{} of the bound", found.share)),
                (found.seconds, found.runs),
                (found.error, "no energy created"),
            )
        })
        .collect();
    let knobs = if quick { &KNOBS[..1] } else { &KNOBS[..] };
    let report = measured(&Plan { scene: &scene, knobs, seeds: runs, quick, threads })?;
    rows.extend(report.rows.iter().filter_map(packing));
    Ok(rows)
}

/// `None` if too few runs succeeded.
fn packing(found: &row::Row) -> Option<Row> {
    let mark = if found.default { " (default)" } else { "" };
    let row = Row::new(
        Family::EnginePacking,
        (found.knob.name().replace('_', " "), format!("{}{mark}", found.value)),
        (found.median_seconds?, found.runs),
        (found.combined?, "every setting at its most accurate value"),
    );
    // The combined error contains the bound of each quantity whose error is not resolved.
    Some(Row { upper_bound: found.resolved.array().contains(&Some(false)), ..row })
}
