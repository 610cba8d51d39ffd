//! Uniaxial compression of 2,000 grains compared with LAMMPS, every 200 of 8,000 steps.

use crate::error::VerificationError;
use crate::reference::table;
use crate::row::{Measure, Point, Row};
use grainlab_core::{Packing, SymTensor};
use grainlab_dem::Engine;
use grainlab_engine::{EngineSettings, TimeStep};

/// The name of the suite.
pub const NAME: &str = "uniaxial";

/// Strain rate along z, 1/s, and time step, s.
const RATE: f64 = -4.0;
const STEP: f64 = 3e-8;

/// Source of the tolerance: `tests/tools/lammps_uniaxial.py . 2`.
const TOLERANCE: &str = "half the time step in LAMMPS changes its contacts by 8e-4 and its stresses by 2e-4 (tests/tools/lammps_uniaxial.py)";

/// The rows. `packing`: the grains, whose velocities and forces do not count; `lammps`: step, stress xx, yy, zz (Pa) and contacts, as
/// `tests/tools/lammps_uniaxial.py` writes them.
pub fn rows(packing: &Packing, lammps: &str) -> Result<Vec<Row>, VerificationError> {
    let theirs = table("uniaxial_2000.csv", lammps)?;
    let settings = EngineSettings {
        friction: 0.1,
        damping: 0.1,
        time_step: TimeStep::Fixed(STEP),
        skin: 0.05 * packing.radii[0],
        ..EngineSettings::default()
    };
    let (radii, positions) = (packing.radii.clone(), &packing.positions);
    let mut engine = Engine::new(packing.cell, packing.material, radii, positions, settings)?;
    engine.set_rate(&[0.0, 0.0, RATE, 0.0, 0.0, 0.0])?;
    engine.initialise()?;
    let (mut stress, mut contacts, mut done) = ([const { Vec::new() }; 3], Vec::new(), 0);
    for row in &theirs {
        let step = row[0] as u32;
        let mut last = SymTensor::default();
        engine.run_with_stress(step - done, |s| last = s)?;
        done = step;
        for (k, ours) in [last.xx, last.yy, last.zz].into_iter().enumerate() {
            stress[k].push(Point::new(row[0], row[1 + k], ours));
        }
        contacts.push(Point::new(row[0], row[4], f64::from(engine.observables()?.contacts)));
    }
    let note = "LAMMPS's Coulomb limit counts the dashpot, ours does not; without dashpots the difference is smaller. Its cell is one step \
                behind the grains when it evaluates forces.";
    let row = |what: &str, unit, measure, tolerance, points| {
        let source = "LAMMPS 22 Jul 2025 (update 4), by tests/tools/lammps_uniaxial.py";
        let name = format!("2000 grains to twice the stress, {what}");
        let row = Row::new(NAME, name, source, unit, measure, tolerance, points);
        row.with_tolerance_from(TOLERANCE).with_note(note)
    };
    let [xx, yy, zz] = stress;
    let mut rows: Vec<Row> = [("stress xx", xx), ("stress yy", yy), ("stress zz", zz)]
        .into_iter()
        .map(|(what, points)| row(what, "Pa", Measure::Relative, 1e-3, points))
        .collect();
    rows.push(row("contacts", "", Measure::Relative, 1e-3, contacts));
    Ok(rows)
}
