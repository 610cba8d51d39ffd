//! Accuracy of the estimated noise of a fabric: scatter over many seeds of a scene, and the estimate from
//! each packing.
//!
//! `cargo run --release -p grainlab_experiment --example fabric_noise SCENE.toml FIRST-LAST [PHASES
//! [FRICTION]]` keeps the named phases (comma-separated; default all) and sets the friction, if given, in all
//! of them. `nodes/scenes/demo.toml 1-60 gas,rest,load,settle` prepares isotropic packings, `… gas,rest,load
//! 0` frictionless ones.

use grainlab_core::results::PackingReport;
use grainlab_core::symmetry;
use grainlab_core::{Packing, Vec3};
use grainlab_micromechanics::structure::{contact_statistics, deviator, fabric, stress_decomposition};
use grainlab_micromechanics::{PackingView, Settings, analyze};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let usage = "usage: fabric_noise SCENE.toml FIRST-LAST [PHASES [FRICTION]]";
    let [file, seeds, ..] = &arguments[..] else { return Err(usage.into()) };
    let (first, last) = seeds.split_once('-').ok_or(usage)?;
    let mut model = grainlab_scene::Scene::parse(&std::fs::read_to_string(file)?)?;
    if let Some(names) = arguments.get(2) {
        let kept: Vec<&str> = names.split(',').collect();
        model.phases.retain(|p| kept.contains(&p.name.as_str()));
    }
    if let Some(friction) = arguments.get(3) {
        let friction: f64 = friction.parse()?;
        model.phases.iter_mut().for_each(|p| p.friction = friction);
    }
    model.phases.last_mut().ok_or("no phase is left")?.publish = true;
    let (mut found, mut spent) = (Vec::new(), [f64::INFINITY; 2]);
    for seed in first.parse::<u64>()?..=last.parse()? {
        let packing = made(grainlab_scene::Scene { seed, ..model.clone() })?;
        let report = analyze(&packing, &Settings::default())?.report;
        spent[0] = spent[0].min(seconds(|| structure(&packing)));
        if let Some(stiffness) = report.stiffness() {
            spent[1] = spent[1].min(seconds(|| symmetry(&stiffness.tensor, 0.0)));
        }
        found.push(report);
    }
    report(&found);
    println!("structure {:.2} ms, symmetry {:.2} ms, the fastest of all", 1e3 * spent[0], 1e3 * spent[1]);
    Ok(())
}

/// All measurements without a stiffness.
fn structure(packing: &Packing) {
    let view = PackingView::new(packing).unwrap();
    let fabric = fabric(&view, &Vec3::z());
    std::hint::black_box((contact_statistics(&view), stress_decomposition(&view, &fabric)));
}

/// Wall time, s.
fn seconds<T>(work: impl FnOnce() -> T) -> f64 {
    let begin = Instant::now();
    std::hint::black_box(work());
    begin.elapsed().as_secs_f64()
}

/// The last packing of a scene.
fn made(scene: grainlab_scene::Scene) -> Result<Packing, Box<dyn std::error::Error>> {
    let mut run = grainlab_experiment::Simulation::new(scene)?;
    while run.exchange()?.is_some() {}
    Ok(run.packing()?)
}

fn report(found: &[PackingReport]) {
    let count = found.len() as f64;
    let mean = |of: &dyn Fn(&PackingReport) -> f64| found.iter().map(of).sum::<f64>() / count;
    let scatter = |of: &dyn Fn(&PackingReport) -> f64| {
        let centre = mean(of);
        (mean(&|a| (of(a) - centre).powi(2)) * count / (count - 1.0)).sqrt()
    };
    // The five components of dev L scatter alike; ε of a fixed axis is (15/4) √(2/3) times one of them.
    let component = |k: usize| move |a: &PackingReport| deviator::from_tensor(&a.fabric.contact_fabric)[k];
    let five: Vec<f64> = (0..5).map(|k| scatter(&component(k))).collect();
    let factor = 3.75 * (2.0f64 / 3.0).sqrt();
    let pooled = factor * (five.iter().map(|s| s * s).sum::<f64>() / 5.0).sqrt();
    let claim = |a: &PackingReport| a.fabric.principal_axis.contact_anisotropy_stddev.unwrap_or(f64::NAN);
    let claimed = mean(&|a| claim(a).powi(2)).sqrt();
    let fit = |a: &PackingReport| a.fabric.orientation.contact_fit.unwrap_or_default();
    println!("{} packings, {:.0} contacts", found.len(), mean(&|a| f64::from(a.contacts.contacts)));
    println!("eps mean {:.4}", mean(&|a| a.fabric.contact_anisotropy));
    println!(
        "  scatter of the five components, as eps: {:.4?}",
        five.iter().map(|s| s * factor).collect::<Vec<_>>()
    );
    println!(
        "  claimed {claimed:.4} over found {pooled:.4}: {:.2} ± {:.2}; a claim is good to {:.0} %; independent contacts {:.2}",
        claimed / pooled,
        claimed / pooled / (10.0 * (count - 1.0)).sqrt(),
        100.0 * scatter(&|a| claim(a)) / mean(&claim),
        mean(&|a| fit(a).eps_stddev) / pooled,
    );
    println!("  chi2 of A(d) {:.2}", mean(&|a| fit(a).chi2_per_dof));
    let sure: Vec<&PackingReport> = found.iter().filter(|a| a.fabric.principal_axis.determined).collect();
    let square = |of: &dyn Fn(&PackingReport) -> f64| {
        (sure.iter().map(|a| of(a).powi(2)).sum::<f64>() / sure.len() as f64).sqrt()
    };
    println!(
        "axis determined in {}; of those, off z by {:.3} rad, claimed {:.3}",
        sure.len(),
        square(&|a| a.fabric.principal_axis.direction.cross(&Vec3::z()).norm().asin()),
        square(&|a| a.fabric.principal_axis.angle_stddev.unwrap_or(f64::NAN)),
    );
    let overlaps = |a: &PackingReport| a.fabric.orientation.overlap_fit.unwrap_or_default();
    println!(
        "g_c mean {:.4}, scatter {:.4}, standard error of independent contacts {:.4}",
        mean(&|a| overlaps(a).g),
        scatter(&|a| overlaps(a).g),
        mean(&|a| overlaps(a).g_stddev.unwrap_or(f64::NAN)),
    );
    let root = |a: &PackingReport| f64::from(a.contacts.grains).sqrt();
    let stiffness: Vec<(&PackingReport, grainlab_core::Symmetry)> =
        found.iter().filter_map(|a| Some((a, symmetry(&a.stiffness()?.tensor, 0.0)?))).collect();
    println!("residuals of the stiffness times the root of the grains, quartiles and largest");
    for (name, of) in [
        ("isotropic", (|s| s.isotropic) as fn(&grainlab_core::Symmetry) -> f64),
        ("cubic", |s| s.cubic),
        ("transversely isotropic", |s| s.transversely_isotropic),
        ("orthotropic", |s| s.orthotropic),
    ] {
        let mut values: Vec<f64> = stiffness.iter().map(|(a, s)| of(s) * root(a)).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values.get((share * (values.len() - 1) as f64) as usize).copied();
        println!("  {name:22} {:.3?}", [0.25, 0.5, 0.75, 0.9, 1.0].map(|s| at(s).unwrap_or(f64::NAN)));
    }
    let off = stiffness.iter().map(|(_, s)| s.axis.cross(&Vec3::z()).norm().asin().powi(2)).sum::<f64>();
    println!("axis of the stiffness off z by {:.3} rad", (off / stiffness.len() as f64).sqrt());
}
