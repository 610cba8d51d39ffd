//! The running energy balance.

use grainlab_core::contact::{ContactLaw, Linear, TangentialLaw};
use grainlab_core::{Mat3, Material};
use grainlab_dem::{Compute, Engine, EngineSettings, Simd, TimeStep, gas};

const RADIUS: f64 = 1e-4;

/// As stiff as glass at some 100 kPa.
const LAWS: [ContactLaw; 2] =
    [ContactLaw::HertzMindlin, ContactLaw::Linear(Linear { normal_stiffness: 2e5, stiffness_ratio: 0.5 })];

fn settings(friction: f64) -> EngineSettings {
    EngineSettings {
        friction,
        damping: 0.1,
        drag: 1e3,
        spin_drag: 5e2,
        skin: 0.1 * RADIUS,
        time_step: TimeStep::FractionOfStable(0.02),
        ..EngineSettings::default()
    }
}

/// A gas that is compressed and sheared into contact.
fn pressed(law: ContactLaw, settings: EngineSettings) -> Engine {
    let gas = gas::random_sequential_addition(40, 2.0 * RADIUS, 0.35, 0.1, 5).unwrap();
    let mut e =
        Engine::new(gas.cell, Material::GLASS, vec![RADIUS; 40], &gas.positions, settings).with_law(law);
    e.set_velocities(&gas.velocities);
    e.set_rate(&[-150.0, -140.0, -160.0, 10.0, -5.0, 20.0]).unwrap();
    e.initialise().unwrap();
    e
}

/// Expected: start + work of the strain = stored + dissipated to 1e-6 of the largest term, with every channel at work.
fn closes(law: ContactLaw, friction: f64, tangential: TangentialLaw) {
    let mut e = pressed(law, EngineSettings { tangential, ..settings(friction) });
    while e.observables().unwrap().solid_fraction < 0.55 {
        e.run(100).unwrap();
    }
    e.measure_energy(true);
    while e.observables().unwrap().solid_fraction < 0.66 {
        e.run(500).unwrap();
    }
    let b = e.energy().unwrap();
    let residual = b.relative_residual();
    println!("{law:?} {friction} {tangential:?}: {residual:e} {b:?}");
    assert!(residual.abs() < 1e-6, "{residual:e} {b:?}");
    assert!(b.strain_work > 0.0 && b.normal_damping > 0.0 && b.drag > 0.0);
    assert_eq!(b.tangential_springs > 0.0 && b.sliding > 0.0, friction > 0.0);
}

#[test]
fn the_balance_of_frictionless_hertz_closes_to_1e_6() {
    closes(LAWS[0], 0.0, TangentialLaw::Rescaled);
}

#[test]
fn the_balance_of_hertz_mindlin_closes_to_1e_6() {
    closes(LAWS[0], 0.3, TangentialLaw::Rescaled);
}

#[test]
fn the_balance_of_linear_springs_closes_to_1e_6() {
    closes(LAWS[1], 0.3, TangentialLaw::Rescaled);
}

/// Expected: the balance changes no bit of a run, with one thread or two; and the thermostat has its channel.
#[test]
fn the_balance_changes_nothing() {
    let hot = EngineSettings { thermostat_speed: Some(0.02), ..settings(0.0) };
    for (law, settings) in [(LAWS[0], settings(0.3)), (LAWS[1], settings(0.3)), (LAWS[0], hot)] {
        let mut plain = pressed(law, settings);
        let mut measured = pressed(law, settings);
        measured.set_compute(Compute::new(Simd::best(), 2).unwrap());
        measured.measure_energy(true);
        for _ in 0..40 {
            plain.run(50).unwrap();
            measured.run(50).unwrap();
        }
        assert_eq!(plain.packing(Mat3::identity()), measured.packing(Mat3::identity()));
        let b = measured.energy().unwrap();
        assert_eq!(b.thermostat > 0.0, settings.thermostat_speed.is_some());
        assert!(b.relative_residual().abs() < 1e-4, "{b:?}");
        measured.measure_energy(false);
        assert!(measured.energy().is_none());
    }
}
