//! Standing waves tell the stiffness.

use crate::sample;
use acoustics::{Instrument, Ray, repeated, standing};
use grains::{Packing, Vec3};

#[test]
fn explore() {
    for (name, packing) in [("iso", sample::isotropic()), ("aniso", sample::anisotropic())] {
        let settings = micro::analyse::Settings { tolerance: 1e-9, ..Default::default() };
        let c = micro::analyse(&packing, &settings).unwrap().moduli.unwrap().stiffness;
        let present = micro::rattlers::participating(&packing);
        let mass: f64 = packing
            .radii
            .iter()
            .zip(&present)
            .filter(|(_, p)| **p)
            .map(|(r, _)| packing.material.sphere_mass(*r))
            .sum();
        let density = mass / packing.cell.volume();
        for indices in [[0, 0, 1], [1, 0, 0], [1, 0, 1], [1, 1, 1]] {
            let direction = Ray::normal(&packing.cell, indices).unwrap();
            let motions = Ray::motions_about(&direction, &Vec3::z()).to_vec();
            let gamma = c.christoffel(&direction);
            let waves = c.plane_waves(&direction);
            let pressure = micro::analyse(&packing, &settings).unwrap().pressure;
            for motion in motions {
                let group = {
                    let along: Vec<f64> =
                        waves.polarizations.iter().map(|e| e.dot(&motion).powi(2)).collect();
                    if along[0] > 0.5 {
                        waves.moduli[0]
                    } else {
                        (along[1] * waves.moduli[1] + along[2] * waves.moduli[2]) / (along[1] + along[2])
                    }
                };
                let t = std::time::Instant::now();
                let ray = Ray { direction, indices: Some(indices), motions: vec![motion] };
                let (curves, traces, warnings) = standing::curves(
                    &packing,
                    &[ray],
                    &standing::Settings {
                        copies: std::env::var("COPIES").map_or(8, |v| v.parse().unwrap()),
                        periods: std::env::var("PERIODS").map_or(4.0, |v| v.parse().unwrap()),
                        ..Default::default()
                    },
                    &Instrument::default(),
                )
                .unwrap();
                let curve = &curves[0];
                let rel = |p: f64| density * p * p / motion.dot(&(gamma * motion)) - 1.0;
                println!(
                    "{name} {indices:?} off {:+.3}% sigma {:.3}% z {:+.1} group {:+.3}% zg {:+.1} p/C {:.3}% eigen {:+.3}% share {:.4} bend/D2 {:.3} | {:?} | {:.2}s {} samples {} warnings",
                    100.0 * rel(curve.speed),
                    200.0 * curve.stddev / curve.speed,
                    rel(curve.speed) / (2.0 * curve.stddev / curve.speed),
                    100.0 * (density * curve.speed.powi(2) / group - 1.0),
                    (density * curve.speed.powi(2) / group - 1.0) / (2.0 * curve.stddev / curve.speed),
                    100.0 * pressure / group,
                    100.0 * (density * curve.speed.powi(2) / waves.meant_by(&motion).modulus - 1.0),
                    waves.meant_by(&motion).share,
                    curve.bend / 4e-8,
                    curve
                        .points
                        .iter()
                        .map(|p| format!(
                            "{:.0}D {:+.3}({:.3})",
                            std::f64::consts::TAU / p.wavenumber / 2e-4,
                            100.0 * rel(p.speed),
                            200.0 * p.stddev / p.speed
                        ))
                        .collect::<Vec<_>>(),
                    t.elapsed().as_secs_f64(),
                    traces[0].channels[0].samples.len(),
                    warnings.len()
                );
            }
        }
    }
    let _: Option<Packing> = None;
    let _ = repeated;
}
