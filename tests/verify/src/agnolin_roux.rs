//! The states A to D of Agnolin & Roux, Phys. Rev. E 76, 061302 (2007), simulated: the slow half.

use crate::error::VerificationError;
use crate::row::{Measure, Point, Row};
use grainlab_experiment::Simulation;
use grainlab_micromechanics::{Settings, analyze};
use grainlab_scene::Scene;

/// The name of the suite.
pub const NAME: &str = "agnolin-roux";

/// Seeds of the packings of a state.
pub const SEEDS: [u64; 3] = [1, 2, 3];

/// A state, as published.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Letter of the preparation.
    pub name: &'static str,
    /// The scene that prepares it.
    pub scene: &'static str,
    source: &'static str,
    solid_fraction: f64,
    /// Coordination number without rattlers.
    coordination: f64,
    coordination_tolerance: f64,
    note: &'static str,
}

const ABSTRACT: &str = "Agnolin & Roux (2007), abstract";
const TABLE: &str = "Agnolin & Roux (2007), table at 10 kPa, as quoted by others";

/// Source of the tolerance of the solid fraction.
const FRACTION: &str = "a tenth of the rate of compression, which the paper leaves open, changes the solid fraction of state D by 0.008";

/// Source of the tolerance of z.
const COORDINATION: &str = "the abstract gives z to one decimal, or none";

/// The published states.
pub const STATES: [State; 4] = [
    State {
        name: "A",
        scene: include_str!("../../../nodes/scenes/agnolin/a.toml"),
        source: ABSTRACT,
        solid_fraction: 0.639,
        coordination: 6.0,
        coordination_tolerance: 0.1,
        note: "Random close packing of frictionless grains.",
    },
    State {
        name: "B",
        scene: include_str!("../../../nodes/scenes/agnolin/b.toml"),
        source: TABLE,
        solid_fraction: 0.6271,
        coordination: 5.80,
        coordination_tolerance: 0.08,
        note: "",
    },
    State {
        name: "C",
        scene: include_str!("../../../nodes/scenes/agnolin/c.toml"),
        source: TABLE,
        solid_fraction: 0.635,
        coordination: 4.56,
        coordination_tolerance: 0.08,
        note: "Theirs is dilated from A and shaken; ours is a gas of hard spheres to 0.62. A later gas gives a denser packing: the density follows from the agitation.",
    },
    State {
        name: "D",
        scene: include_str!("../../../nodes/scenes/agnolin/d.toml"),
        source: ABSTRACT,
        solid_fraction: 0.593,
        coordination: 4.5,
        coordination_tolerance: 0.1,
        note: "The density follows from the rate of compression: at a tenth of it, 4 /s, it is 0.582.",
    },
];

/// Numbers of one packing that are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Solid fraction φ.
    pub solid_fraction: f64,
    /// Coordination number z.
    pub coordination: f64,
}

/// Prepares a state with one of the [`SEEDS`] and measures it: 4,000 grains, up to a minute.
pub fn prepared(state: &State, seed: u64) -> Result<Found, VerificationError> {
    let failed =
        |what: &dyn std::fmt::Display| VerificationError::Measurement(format!("a prepared state: {what}"));
    let scene = Scene { seed, ..Scene::parse(state.scene).map_err(|e| failed(&e))? };
    let mut run = Simulation::new(scene).map_err(|e| failed(&e))?;
    while run.exchange().map_err(|e| failed(&e))?.is_some() {}
    let report = analyze(&run.packing().map_err(|e| failed(&e))?, &Settings::default())
        .map_err(|e| failed(&e))?
        .report;
    Ok(Found { solid_fraction: report.solid_fraction, coordination: report.contacts.mechanical_coordination })
}

/// The rows of a state: means over packings of all [`SEEDS`].
pub fn rows(state: &State, found: &[Found]) -> Vec<Row> {
    let mean = |of: fn(&Found) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
    let row = |what: &str, tolerance, theirs, ours| {
        let points = vec![Point::new(0.0, theirs, ours)];
        let name = format!("state {}, {what}, mean of {} packings", state.name, found.len());
        Row::new(NAME, name, state.source, "", Measure::Absolute, tolerance, points).with_note(state.note)
    };
    let z_tolerance = state.coordination_tolerance;
    vec![
        row("solid fraction", 0.003, state.solid_fraction, mean(|f| f.solid_fraction))
            .with_tolerance_from(FRACTION),
        row("z", z_tolerance, state.coordination, mean(|f| f.coordination)).with_tolerance_from(COORDINATION),
    ]
}
