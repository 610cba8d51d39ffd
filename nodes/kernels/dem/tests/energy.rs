//! The running energy balance.

use grainlab_core::contact::{ContactLaw, Linear, RollingResistance, SpringLaw, TangentialLaw};
use grainlab_core::{Cell, Packing, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::{Compute, EnergyBalance, EngineSettings, TimeStep};
use grainlab_testkit::engine::{RADIUS, gas, packing, setting, taken_up};

/// As stiff as glass at some 100 kPa.
const LINEAR: SpringLaw = SpringLaw::Linear(Linear { normal_stiffness: 2e5, stiffness_ratio: 0.5 });
const ROUGH: SpringLaw = SpringLaw::EXAMPLES[2];
const ROLLING: RollingResistance = RollingResistance { stiffness: 5e4, damping: 5e-3, friction: 0.1 };

/// Each law without and with resistance to rolling.
const LAWS: [ContactLaw; 6] = [
    ContactLaw::of(SpringLaw::HertzMindlin),
    ContactLaw::of(LINEAR),
    ContactLaw::of(SpringLaw::HertzMindlin).with_rolling(ROLLING),
    ContactLaw::of(LINEAR).with_rolling(ROLLING),
    ContactLaw::of(ROUGH),
    ContactLaw::of(ROUGH).with_rolling(ROLLING),
];

fn settings(friction: f64) -> EngineSettings {
    let time_step = TimeStep::FractionOfStable(0.8);
    EngineSettings { damping: 0.1, drag: 50.0, spin_drag: 50.0, time_step, ..setting(friction, 0.0) }
}

/// A channel of the balance.
type Channel = fn(&mut EnergyBalance) -> &mut f64;

/// Every channel but those of a thermostat.
const CHANNELS: [(&str, Channel); 14] = [
    ("start", |b| &mut b.start),
    ("strain_work", |b| &mut b.strain_work),
    ("kinetic", |b| &mut b.kinetic),
    ("normal_springs", |b| &mut b.normal_springs),
    ("tangential_springs", |b| &mut b.tangential_springs),
    ("rolling_springs", |b| &mut b.rolling_springs),
    ("normal_damping", |b| &mut b.normal_damping),
    ("tangential_damping", |b| &mut b.tangential_damping),
    ("rolling_damping", |b| &mut b.rolling_damping),
    ("rolling", |b| &mut b.rolling),
    ("sliding", |b| &mut b.sliding),
    ("history", |b| &mut b.history),
    ("drag", |b| &mut b.drag),
    ("integration", |b| &mut b.integration),
];

/// A gas that is compressed and sheared into contact.
fn pressed(law: ContactLaw, settings: EngineSettings) -> Engine {
    // With resistance to rolling, sizes differ.
    let small = if law.rolling.is_some() { 0.8 * RADIUS } else { RADIUS };
    let radii = (0..40).map(|k| if k % 3 == 0 { small } else { RADIUS }).collect();
    let mut e = taken_up(&Packing { law, radii, ..gas(&[RADIUS; 40], 0.1, 5) }, settings);
    e.set_rate(&[-150.0, -140.0, -160.0, 10.0, -5.0, 20.0]).unwrap();
    e
}

/// Expected: the balance closes to 1e-9 of its largest term at the default time step, with every channel at work; without any
/// one channel it does not close to 1e-6.
fn closes(law: ContactLaw, friction: f64, tangential: TangentialLaw) {
    let mut e = pressed(law, EngineSettings { tangential, ..settings(friction) });
    e.measure_energy(true);
    while e.observables().unwrap().stress.tensor.voigt()[0] < 2e4 {
        e.run(20).unwrap();
    }
    let b = e.energy().unwrap();
    let residual = b.relative_residual();
    assert!(residual.abs() < 1e-9, "{residual:e} {b:?}");
    assert!(b.strain_work > 0.0 && b.normal_damping > 0.0 && b.drag > 0.0);
    assert_eq!(b.tangential_springs > 0.0 && b.sliding > 0.0, friction > 0.0);
    let rolls = b.rolling_springs > 0.0 && b.rolling_damping > 0.0 && b.rolling > 0.0;
    assert_eq!(rolls, friction > 0.0 && law.rolling.is_some(), "{b:?}");
    for (name, channel) in CHANNELS {
        let mut lacking = b;
        let lost = std::mem::take(channel(&mut lacking));
        let seen = lacking.relative_residual().abs() > 1e-6;
        assert_eq!(seen, lost != 0.0, "without {name}, {lost:e}: {lacking:?}");
    }
}

#[test]
fn the_balance_closes_to_rounding_under_every_law() {
    closes(LAWS[0], 0.0, TangentialLaw::Rescaled);
    closes(LAWS[2], 0.0, TangentialLaw::Rescaled);
    for law in [LAWS[0], LAWS[1], LAWS[2], LAWS[4]] {
        closes(law, 0.3, TangentialLaw::Rescaled);
    }
    closes(LAWS[3], 0.3, TangentialLaw::Incremental);
}

/// Expected: the balance changes no bit of a run, with one thread or two; and the thermostat has its channel.
#[test]
fn the_balance_changes_nothing() {
    let hot = EngineSettings { thermostat_speed: Some(0.02), ..settings(0.0) };
    for (law, settings) in [(LAWS[0], settings(0.3)), (LAWS[1], settings(0.3)), (LAWS[0], hot)] {
        let mut plain = pressed(law, settings);
        let mut measured = pressed(law, settings);
        measured.set_compute(Compute::new(2).unwrap());
        measured.measure_energy(true);
        for _ in 0..30 {
            plain.run(50).unwrap();
            measured.run(50).unwrap();
        }
        assert_eq!(packing(&plain), packing(&measured));
        let b = measured.energy().unwrap();
        assert_eq!(b.thermostat > 0.0, settings.thermostat_speed.is_some());
        assert!(b.relative_residual().abs() < 1e-9, "{b:?}");
        measured.measure_energy(false);
        assert!(measured.energy().is_none());
    }
}

/// Two spheres that meet obliquely without slip, seen during their collision, after `steps` of 2e-7 s in all.
fn collision(law: ContactLaw, steps: u32) -> EnergyBalance {
    let settings = setting(f64::INFINITY, 2e-7 / f64::from(steps));
    let cell = Cell::cube(20.0 * RADIUS).unwrap();
    let x = vec![Vec3::zeros(), Vec3::x() * (2.0 * RADIUS)];
    let velocities = vec![Vec3::new(0.05, 0.03, 0.0), Vec3::new(-0.05, 0.0, 0.02)];
    let spins = vec![Vec3::y() * 50.0, Vec3::y() * -50.0];
    let pair = Packing { law, velocities, spins, ..Packing::at_rest(cell, vec![RADIUS; 2], x) };
    let mut e = taken_up(&pair, settings);
    e.measure_energy(true);
    e.run(steps).unwrap();
    e.energy().unwrap()
}

#[test]
fn the_error_of_integration_falls_with_the_square_of_the_time_step() {
    for law in LAWS {
        let [coarse, fine] = [40, 80].map(|steps| collision(law, steps));
        assert!(fine.normal_springs > 0.0 && fine.tangential_springs > 0.0);
        assert_eq!(fine.rolling_springs > 0.0, law.rolling.is_some());
        let ratio = coarse.integration / fine.integration;
        assert!((ratio - 4.0).abs() < 0.1, "{law:?}: {coarse:?} {fine:?}, ratio {ratio}");
        assert!(coarse.relative_residual().abs() < 1e-12, "{coarse:?}");
    }
}
