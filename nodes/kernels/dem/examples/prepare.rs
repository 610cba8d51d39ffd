//! Runs a scene in this process alone, the servo as a function call: `cargo run --release -p dem --example prepare FILE`.

use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: prepare SCENE.toml")?;
    let scene = scene::Scene::parse(&std::fs::read_to_string(path)?)?;
    let mut run = dem::Simulation::new(scene)?;
    let (begin, mut mark, mut steps) = (Instant::now(), Instant::now(), 0);
    while let Some(r) = run.request() {
        let answer = servo::answer(&servo::Request {
            stress: r.snapshot.stress.tensor,
            controls: r.controls,
            rate: r.rate,
            rate_limit: r.rate_limit,
            law: r.law,
            tangent: r.snapshot.tangent,
            control_interval: r.control_interval,
        })?;
        let advanced = run.answer(&answer.rate)?;
        if std::env::var("TRACE").is_ok() && r.sequence % 100 == 0 {
            let s = &r.snapshot;
            println!("  {} t={:.6} sig={:?} rate={:?} unb={:.2e} k={:.3} v={:.2e} dt={:.2e}", r.step, r.time, s.stress.tensor.voigt().map(|v| v.round()), answer.rate.map(|v| (v*1e3).round()/1e3), s.unbalanced, s.coordination, run.engine().speed(), run.engine().time_step());
        }
        if let Some(name) = advanced.ended {
            let (e, done) = (run.engine(), run.engine().steps() - steps);
            let seen = e.snapshot()?;
            let spent = mark.elapsed().as_secs_f64();
            println!(
                "{name:12} steps {done:8} {spent:6.1} s {:5.2} M/s  dt {:.2e}  phi {:.4} k {:.3} stress {:?} unbalanced {:.1e}",
                done as f64 * f64::from(run.scene().grains) / spent / 1e6,
                e.time_step(),
                seen.solid_fraction,
                seen.coordination,
                seen.stress.tensor.voigt().map(|v| v.round()),
                seen.unbalanced
            );
            (mark, steps) = (Instant::now(), run.engine().steps());
        }
    }
    println!("{:.1} s in all", begin.elapsed().as_secs_f64());
    Ok(())
}
