//! Two glass spheres collide: the speed after over the speed before, against the damping of the contact.
//!
//! `cargo run --release -p grainlab_dem --example collision`

use grainlab_core::{Cell, Material, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::{EngineError, EngineSettings, TimeStep};

const RADIUS: f64 = 1e-3;
const SPEED: f64 = 0.1;

fn main() -> Result<(), EngineError> {
    println!("damping/critical  restitution");
    for damping in [0.0, 0.1, 0.2, 0.4] {
        let settings = EngineSettings {
            damping,
            time_step: TimeStep::FractionOfStable(0.02),
            skin: 0.1 * RADIUS,
            ..EngineSettings::default()
        };
        let cell = Cell::cube(20.0 * RADIUS).expect("a cube has a volume");
        let positions = [Vec3::new(8.9, 10.0, 10.0), Vec3::new(11.1, 10.0, 10.0)].map(|x| x * RADIUS);
        let mut engine = Engine::new(cell, Material::GLASS, vec![RADIUS; 2], &positions, settings)?;
        engine.set_velocities(&[Vec3::x() * SPEED, -Vec3::x() * SPEED])?;
        engine.initialise()?;
        while engine.velocities()[0].x > -1e-3 * SPEED || engine.observables()?.contacts > 0 {
            engine.run(10)?;
        }
        println!("{damping:16.2}  {:11.4}", -engine.velocities()[0].x / SPEED);
    }
    Ok(())
}
