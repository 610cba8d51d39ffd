//! Runs a scene in this process, with the servo as a function call: `cargo run --release -p
//! grainlab_experiment --example prepare FILE`.

use grainlab_core::ComponentControl;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: prepare SCENE.toml")?;
    let scene = grainlab_scene::Scene::parse(&std::fs::read_to_string(path)?)?;
    let mut run = grainlab_experiment::Simulation::new(scene)?;
    let (begin, mut mark, mut steps) = (Instant::now(), Instant::now(), 0);
    while let Some(r) = run.request() {
        let answer = grainlab_servo::control(&r.input)?;
        let advanced = run.advance(&answer.rate)?;
        if let Some(name) = advanced.ended {
            let (e, done) = (run.engine(), run.engine().steps() - steps);
            let seen = e.observables()?;
            let spent = mark.elapsed().as_secs_f64();
            println!(
                "{name:12} steps {done:8} {spent:6.1} s {:5.2} M/s  dt {:.2e}  phi {:.4} k {:.3} stress {:?} off target {:.1e} unbalanced {:.1e}",
                done as f64 * f64::from(run.scene().grains) / spent / 1e6,
                e.time_step(),
                r.solid_fraction,
                r.coordination,
                seen.stress.tensor.voigt().map(|v| v.round()),
                off_target(&seen.stress.tensor.voigt(), &r.input.controls),
                seen.unbalanced
            );
            (mark, steps) = (Instant::now(), run.engine().steps());
            if advanced.packing_due {
                report(&run.packing()?)?;
            }
        }
    }
    println!("{:.1} s in all", begin.elapsed().as_secs_f64());
    Ok(())
}

/// The largest error of a servoed component over the mean of the normal targets; NaN without a servoed
/// component.
fn off_target(stress: &[f64; 6], controls: &[ComponentControl; 6]) -> f64 {
    let targets = controls.map(|c| match c {
        ComponentControl::Stress(target) => Some(target),
        _ => None,
    });
    let normal: Vec<f64> = targets[..3].iter().flatten().copied().collect();
    let errors = stress.iter().zip(targets).filter_map(|(s, t)| Some((s - t?).abs()));
    errors.fold(f64::NAN, f64::max) * normal.len() as f64 / normal.iter().sum::<f64>()
}

fn report(packing: &grainlab_core::Packing) -> Result<(), Box<dyn std::error::Error>> {
    let r = grainlab_micromechanics::analyze(packing, &grainlab_micromechanics::Settings::default())?.report;
    let (c, f) = (&r.contacts, &r.fabric);
    let l = f.contact_fabric;
    println!(
        "  phi {:.4} p {:.2} q/p {:.1e} k {:.3} z {:.3} rattlers {} L {:.4} {:.4} {:.4} eps {:.4} g {:?}",
        r.solid_fraction,
        r.pressure(),
        r.stress_ratio().unwrap_or(f64::NAN),
        c.coordination,
        c.mechanical_coordination,
        c.rattlers,
        l.xx,
        l.yy,
        l.zz,
        f.contact_anisotropy,
        r.strain_ratios
    );
    let (stiffness, begin) = (r.elasticity?, Instant::now());
    let (relaxed, affine) = (stiffness.tensor, stiffness.bounds.affine);
    let (t, v) = (relaxed.transverse_isotropy(), affine.transverse_isotropy());
    println!(
        "  G12 {:.2} G13 {:.2} theta {:.2} MPa, affine/relaxed {:.3} {:.3} {:.3}, {} iterations {:?}",
        t.g12 / 1e6,
        t.g13 / 1e6,
        relaxed.bulk_voigt() / 1e6,
        v.g12 / t.g12,
        v.g13 / t.g13,
        affine.bulk_voigt() / relaxed.bulk_voigt(),
        stiffness.iterations,
        begin.elapsed()
    );
    Ok(())
}
