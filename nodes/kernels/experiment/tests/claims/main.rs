//! Whole scenes: their energy, their packings, their runs that resume, and the control of their stress.

mod energy;
mod film;
mod resume;
mod servo;

use grainlab_experiment::Simulation;
use grainlab_scene::Scene;

/// Few grains: a gas that is compressed as `gas` says, rest, strain, further phases, and rest.
fn path(gas: &str, further: &str) -> String {
    let scene = r#"
name = "small"
seed = 5
friction = 0.1
[grains]
count = 48
diameter = 2e-4
[[phase]]
kind = "gas"
GAS
until = { solid_fraction = 0.55 }
[[phase]]
kind = "relax"
friction = 0.0
drag = 1e4
reference = true
control_period = 50
until = { elapsed = 2e-4 }
[[phase]]
kind = "strain"
rate = [-30.0, -30.0, -40.0, 0.0, 3.0, 0.0]
until = { pressure_above = 2e4 }
FURTHER[[phase]]
kind = "relax"
name = "rest"
friction = inf
drag = 5e4
spin_drag = 5e4
until = { elapsed = 5e-5 }
publish = true
"#;
    scene.replace("GAS", gas).replace("FURTHER", further)
}

fn begin(scene: &str) -> Simulation {
    Simulation::new(Scene::parse(scene).unwrap()).unwrap()
}
