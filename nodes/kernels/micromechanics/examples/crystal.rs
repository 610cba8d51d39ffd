//! A face-centred cubic crystal of glass spheres, compressed by 0.1 %: its contacts, stress and cubic stiffness.
//!
//! `cargo run --release -p grainlab_micromechanics --example crystal`

use grainlab_core::{Cell, Mat3, Material, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::EngineSettings;
use grainlab_micromechanics::{Settings, analyze};

const RADIUS: f64 = 1e-4;
const CELLS: usize = 2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let edge = 2.0 * 2f64.sqrt() * RADIUS * (1.0 - 1e-3);
    let basis = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]].map(Vec3::from);
    let site = |n: usize| {
        let corner = [n / 4 % CELLS, n / 4 / CELLS % CELLS, n / 4 / CELLS / CELLS].map(|i| i as f64);
        (basis[n % 4] + Vec3::from(corner)) * edge
    };
    let positions: Vec<Vec3> = (0..4 * CELLS.pow(3)).map(site).collect();
    let cell = Cell::cube(CELLS as f64 * edge).ok_or("the cell has no volume")?;
    // Friction keeps the tangential springs, without which a crystal does not resist shear.
    let settings = EngineSettings { friction: 0.5, skin: 0.1 * RADIUS, ..EngineSettings::default() };
    let radii = vec![RADIUS; positions.len()];
    let mut engine = Engine::new(cell, Material::GLASS, radii, &positions, settings)?;
    engine.initialise()?;

    let report = analyze(&engine.packing(Mat3::identity()), &Settings::default())?.report;
    println!("z {}, pressure {:.1} kPa", report.contacts.mechanical_coordination, report.pressure() / 1e3);
    let stiffness = report.elasticity.map_err(|why| why.to_string())?;
    let c = stiffness.tensor.row_major();
    println!("C11 {:.2} GPa, C12 {:.2} GPa, C44 {:.2} GPa", c[0] / 1e9, c[1] / 1e9, c[21] / 1e9);
    Ok(())
}
