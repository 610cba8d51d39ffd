//! Compresses a gas of grains to rest and prints the packing: `cargo run --release -p grainlab_experiment
//! --example press -- COUNT SEED PRESSURE FRICTION`. It made the packings of the tests.

use grainlab_experiment::Simulation;
use grainlab_scene::Scene;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [count, seed, pressure, friction] = &arguments[..] else {
        return Err("usage: press COUNT SEED PRESSURE FRICTION".into());
    };
    let target = format!("{{ stress = {pressure} }}");
    let zero = "{ stress = 0.0 }";
    let text = format!(
        r#"
name = "pressed"
seed = {seed}
[grains]
count = {count}
diameter = 2e-4
[[phase]]
kind = "gas"
rate = -100.0
control_period = 100
until = {{ solid_fraction = 0.55 }}
[[phase]]
kind = "relax"
friction = 0.0
drag = 1e4
control_period = 50
until = {{ elapsed = 2e-4 }}
[[phase]]
kind = "strain"
friction = {friction}
rate = [-40.0, -40.0, -40.0, 0.0, 0.0, 0.0]
until = {{ pressure_above = {pressure} }}
[[phase]]
kind = "servo"
friction = {friction}
drag = 2e4
spin_drag = 2e4
rate_limit = 30.0
response_time = 3e-6
control = {{ xx = {target}, yy = {target}, zz = {target}, yz = {zero}, xz = {zero}, xy = {zero} }}
until = {{ on_target = 1e-6, unbalanced = 1e-7, hold = 2e-5, timeout = 0.1 }}
"#
    );
    let mut run = Simulation::new(Scene::parse(&text)?)?;
    while run.exchange()?.is_some() {}
    print(&run.packing()?);
    Ok(())
}

/// One line per item: the columns of the cell, friction and time step, grains, contacts with their tangential
/// force.
fn print(p: &grainlab_core::Packing) {
    let three = |v: &[f64]| format!("{:e} {:e} {:e}", v[0], v[1], v[2]);
    for column in p.cell.matrix().column_iter() {
        println!("cell {}", three(&[column[0], column[1], column[2]]));
    }
    println!("numerics {:e} {:e}", p.friction, p.time_step);
    for i in 0..p.grains() {
        println!("grain {:e} {}", p.radii[i], three(p.positions[i].as_slice()));
    }
    for c in &p.contacts {
        let [a, b, d] = c.image;
        println!("contact {} {} {a} {b} {d} {}", c.i, c.j, three(c.tangential_force.as_slice()));
    }
}
