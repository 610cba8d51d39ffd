//! Packings made by LAMMPS: their contacts and forces from positions alone, their stress, and their stiffness.

use crate::error::VerificationError;
use crate::row::{Measure, Point, Row};
use grainlab_core::{Mat3, Packing};
use grainlab_dem::Engine;
use grainlab_engine::EngineSettings;
use grainlab_micromechanics::{Settings, analyze};

/// The name of the suite.
pub const NAME: &str = "lammps-packings";

const SOURCE: &str = "LAMMPS 22 Jul 2025 (update 4), tests/golden/reference/ref_packing_500";

/// Source of the tolerance of LAMMPS's strain probe.
const PROBE: &str = "the difference of LAMMPS's probes at strains of 1e-7 and 1e-6";

/// Results of LAMMPS, and of a sparse solve of its network, for the packing of 500 equal spheres. SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Stress of the contact forces, rows; compression is positive.
    pub stress: [[f64; 3]; 3],
    /// Number of contacts.
    pub contacts: f64,
    /// Contacts per grain, of all grains, and without grains of fewer than two contacts.
    pub coordination: [f64; 2],
    /// Solid fraction of the packing.
    pub solid_fraction: f64,
    /// Mean normal force.
    pub mean_force: f64,
    /// Relaxed stiffness of the frozen network, row by row, by a sparse solve in Python.
    pub stiffness: Vec<f64>,
    /// Stiffness by a strain probe in LAMMPS, row by row.
    pub probed: Vec<f64>,
}

/// The rows of the packing of equal spheres, which has its contact forces.
pub fn equal_spheres(packing: &Packing, reference: &Reference) -> Result<Vec<Row>, VerificationError> {
    let settings = Settings { tolerance: Some(1e-12), ..Settings::default() };
    let report =
        analyze(packing, &settings).map_err(|e| VerificationError::Measurement(e.to_string()))?.report;
    let found = from_positions(packing)?;
    let one = |theirs, ours| vec![Point::new(0.0, theirs, ours)];
    let row = |name: &str, unit, measure, tolerance, points| {
        Row::new(NAME, format!("500 equal spheres, {name}"), SOURCE, unit, measure, tolerance, points)
    };
    let stress = report.stress.tensor.matrix();
    let components = (0..3).flat_map(|i| (i..3).map(move |j| (i, j)));
    let stress =
        components.map(|(i, j)| Point::new((3 * i + j) as f64, reference.stress[i][j], stress[(i, j)]));
    let forces = packing.contacts.iter().zip(&found.contacts).enumerate();
    let forces = forces.map(|(n, (a, b))| Point::new(n as f64, a.normal_force, b.normal_force)).collect();
    let counts = &report.contacts;
    let single = |name: &str, theirs, ours| row(name, "", Measure::Relative, 1e-12, one(theirs, ours));
    let found_contacts = one(reference.contacts, found.contacts.len() as f64);
    let mut rows = vec![
        row("contacts from positions", "", Measure::Absolute, 0.0, found_contacts),
        row("normal forces from positions", "N", Measure::OfLargest, 1e-10, forces),
        single("solid fraction", reference.solid_fraction, report.solid_fraction),
        single("k", reference.coordination[0], counts.coordination),
        single("z", reference.coordination[1], counts.mechanical_coordination),
        row("stress of the contact forces", "Pa", Measure::OfLargest, 1e-8, stress.collect()),
    ];
    if let Some(forces) = &counts.forces {
        let points = one(reference.mean_force, forces.mean_normal);
        rows.push(row("mean normal force", "N", Measure::Relative, 1e-9, points));
    }
    let Some(stiffness) = report.stiffness() else {
        return Err(VerificationError::Measurement("a packing of LAMMPS found no stiffness".to_owned()));
    };
    let ours = stiffness.tensor.row_major();
    let points = |theirs: &[f64]| {
        theirs.iter().zip(ours).enumerate().map(|(n, (t, o))| Point::new(n as f64, *t, o)).collect::<Vec<_>>()
    };
    let (solved, probed) = (points(&reference.stiffness), points(&reference.probed));
    rows.push(row("stiffness, sparse solve", "Pa", Measure::OfLargest, 1e-8, solved));
    let probed = row("stiffness, strain probe of LAMMPS", "Pa", Measure::OfLargest, 1e-3, probed);
    rows.push(probed.with_tolerance_from(PROBE));
    Ok(rows)
}

/// The stress of a packing of 400 unequal spheres with the contact forces that LAMMPS dumped. `stress`: LAMMPS's own, Pa, in its
/// order xx yy zz xy xz yz.
pub fn unequal_spheres(packing: &Packing, stress: &[f64; 6]) -> Vec<Row> {
    let ours = grainlab_core::stress::stress(packing).tensor;
    let ours = [ours.xx, ours.yy, ours.zz, ours.xy, ours.xz, ours.yz];
    let points = stress.iter().zip(ours).enumerate().map(|(n, (t, o))| Point::new(n as f64, *t, o)).collect();
    let source = "LAMMPS 22 Jul 2025 (update 4), tests/golden/lammps";
    let name = "400 unequal spheres, stress of the contact forces";
    vec![Row::new(NAME, name, source, "Pa", Measure::OfLargest, 1e-6, points)]
}

/// The packing with contacts and forces of the engine, from positions alone.
fn from_positions(packing: &Packing) -> Result<Packing, VerificationError> {
    let settings = EngineSettings { friction: packing.friction, ..EngineSettings::default() };
    let at_rest = Packing::at_rest(packing.cell, packing.radii.clone(), packing.positions.clone());
    let grains = Packing { material: packing.material, law: packing.law, ..at_rest };
    let mut engine = Engine::from_packing(&grains, settings)?;
    engine.initialise()?;
    Ok(engine.packing(Mat3::identity()))
}
