//! Wave speeds in a body-centred cubic crystal of glass spheres, by the dispersion of its contact network.
//!
//! `cargo run --release -p grainlab_acoustics --example wave_speeds`

use grainlab_acoustics::{Settings, Survey, measure};
use grainlab_core::{Cell, Mat3, Material, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::EngineSettings;

const RADIUS: f64 = 1e-4;
const CELLS: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let edge = 4.0 / 3f64.sqrt() * RADIUS * (1.0 - 1e-3);
    let site = |n: usize| {
        let corner = [n / 2 % CELLS, n / 2 / CELLS % CELLS, n / 2 / CELLS / CELLS].map(|i| i as f64);
        (Vec3::repeat(0.5 * (n % 2) as f64) + Vec3::from(corner)) * edge
    };
    let positions: Vec<Vec3> = (0..2 * CELLS.pow(3)).map(site).collect();
    let cell = Cell::cube(CELLS as f64 * edge).ok_or("the cell has no volume")?;
    let settings = EngineSettings { friction: 0.5, skin: 0.1 * RADIUS, ..EngineSettings::default() };
    let radii = vec![RADIUS; positions.len()];
    let mut engine = Engine::new(cell, Material::GLASS, radii, &positions, settings)?;
    engine.initialise()?;

    let found = measure(
        &engine.packing(Mat3::identity()),
        &Settings { survey: Survey::Minimal, ..Settings::default() },
    )?;
    println!("density {:.0} kg/m3", found.density);
    for m in &found.waves {
        let (d, p) = (m.wave.direction, m.wave.polarization);
        println!(
            "towards ({:5.2}, {:5.2}, {:5.2}), motion ({:5.2}, {:5.2}, {:5.2}): {:7.1} m/s",
            d.x, d.y, d.z, p.x, p.y, p.z, m.wave.speed
        );
    }
    found.notes.iter().for_each(|w| println!("note: {w}"));
    Ok(())
}
