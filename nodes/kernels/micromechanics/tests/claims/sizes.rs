//! Spheres of unequal sizes: contacts act at R − δ/2 from each centre, against a dense pseudo-inverse and against the probe.

use crate::dense::dense_stiffness;
use crate::samples::places;
use grainlab_core::contact::TangentialLaw;
use grainlab_core::{Cell, Mat3, Material, Packing, Stiffness, Vec3};
use grainlab_dem::{Engine, Observables};
use grainlab_engine::{EngineSettings, TimeStep};
use grainlab_micromechanics::probe::{Relaxation, StrainProbe, strain_probe};
use grainlab_micromechanics::{Settings, analyze};
use grainlab_testkit::Random;

const DIAMETER: f64 = 2e-4;

/// Spheres placed in a cube without overlaps, compressed with friction beyond `pressure` (Pa), and relaxed
/// until the unbalanced force ratio is about 1e-8.
fn prepared(grains: usize, spread: f64, pressure: f64, seed: u64) -> Packing {
    let mut dice = Random::new(seed);
    let radius = |_| 0.5 * DIAMETER * (1.0 + spread * dice.between(-1.0, 1.0));
    let radii: Vec<f64> = (0..grains).map(radius).collect();
    let solid: f64 = radii.iter().map(|r| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)).sum();
    let cell = Cell::cube((solid / 0.3).cbrt()).unwrap();
    let positions = places(&cell, &radii, &mut dice);
    let setting = EngineSettings {
        friction: 0.2,
        damping: 0.3,
        spin_drag: 1e4,
        tangential: TangentialLaw::Incremental,
        time_step: TimeStep::FractionOfStable(0.8),
        skin: 0.1 * DIAMETER,
        ..EngineSettings::default()
    };
    let mut engine = Engine::new(cell, Material::GLASS, radii, &positions, setting).unwrap();
    let mut strain = |rate: f64, done: &dyn Fn(&Observables) -> bool| {
        engine.set_rate(&[-rate, -rate, -rate, 0.0, 0.0, 0.0]).unwrap();
        while !done(&engine.observables().unwrap()) {
            engine.run(100).unwrap();
        }
        engine.set_rate(&[0.0; 6]).unwrap();
        engine.run(5_000).unwrap();
        engine.observables().unwrap().stress.tensor.mean()
    };
    strain(200.0, &|s| s.solid_fraction > 0.58);
    // The pressure falls as grains come to rest: repeat until it suffices.
    while strain(10.0, &|s| s.stress.tensor.mean() > pressure) < 0.6 * pressure {}
    engine.initialise().unwrap();
    // Without sliding: sliding contacts relax slowly.
    let time_step = TimeStep::Fixed(0.8 * engine.time_step());
    engine
        .set_settings(EngineSettings { time_step, friction: f64::INFINITY, damping: 0.0, ..setting })
        .unwrap();
    let mut relaxation = Relaxation::new(vec![engine]);
    for _ in 0..400 {
        (0..100).for_each(|_| relaxation.step().unwrap());
        if relaxation.engines[0].observables().unwrap().unbalanced < 1e-8 {
            break;
        }
    }
    let mut p = relaxation.engines[0].packing(Mat3::identity());
    p.velocities.fill(Vec3::zeros());
    p.spins.fill(Vec3::zeros());
    (p.time_step, p.friction) = (0.0, setting.friction);
    p.validated().unwrap()
}

#[test]
fn stiffness_of_spheres_of_radii_within_40_percent_is_that_of_a_dense_solve_and_of_the_probe() {
    let p = prepared(80, 0.4, 5e4, 2);
    let report = analyze(&p, &Settings::default()).unwrap().report;
    let (z, unbalanced) = (report.contacts.mechanical_coordination, report.unbalanced_force_ratio.unwrap());
    assert!((4.5..5.8).contains(&z) && unbalanced < 1e-5, "z {z}, {unbalanced:e}");
    let (found, truth) = (report.stiffness().unwrap().tensor, dense_stiffness(&p, true));
    let error = (found.0 - truth).amax() / truth[(0, 0)];
    assert!(error < 1e-5, "{error:e} of C11");
    let probed = strain_probe(&p, &StrainProbe::default()).unwrap().stiffness;
    let three = |c: &Stiffness| [c.transverse_isotropy().g12, c.transverse_isotropy().g13, c.bulk_voigt()];
    for (found, probed) in three(&found).into_iter().zip(three(&probed)) {
        assert!((found / probed - 1.0).abs() < 2e-3, "{found:e} for {probed:e}");
    }
}
