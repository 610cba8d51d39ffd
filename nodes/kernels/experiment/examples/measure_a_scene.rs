//! Runs the demo scene to its packing, in this process, and measures the packing.
//!
//! `cargo run --release -p grainlab_experiment --example measure_a_scene`

use grainlab_experiment::Simulation;
use grainlab_micromechanics::{Settings, analyze};
use grainlab_scene::{Scene, built_in};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::parse(built_in("demo").ok_or("no scene demo")?)?;
    let mut run = Simulation::new(scene)?;
    // The simulator sends a request, the servo returns a strain rate, and grains move for one control period.
    while let Some(outcome) = run.exchange()? {
        if outcome.packing_due {
            let report = analyze(&run.packing()?, &Settings::default())?.report;
            let (k, eps) = (report.contacts.coordination, report.fabric.contact_anisotropy);
            println!(
                "step {}: pressure {:.1} kPa, k {k:.3}, eps {eps:.4}",
                report.step,
                report.pressure() / 1e3
            );
            if let Some(t) = report.projected() {
                println!("G12 {:.2} MPa, G13 {:.2} MPa", t.g12 / 1e6, t.g13 / 1e6);
            }
        }
    }
    Ok(())
}
