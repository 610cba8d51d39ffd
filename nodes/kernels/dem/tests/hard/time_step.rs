//! The time step at 0.95 and 1.05 of the true stability limit.
//!
//! Expected: below it energy stays bounded; above it the run is refused with grain and contact named, or (where contact
//! damping feeds a limit cycle) stays finite; never a number that is not one.

use grainlab_core::contact::{RollingResistance, TangentialLaw};
use grainlab_core::effective_radius;
use grainlab_core::{Cell, Contact, Mat3, Packing, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::{EngineError, TimeStep};
use grainlab_testkit::Random;
use grainlab_testkit::engine::*;

/// Two unequal grains in a row, touching directly and across the boundary, and their critical time step, s.
///
/// With velocities half a step behind, x¨ = −K x − C v is stable while 4 − h² K − 2 h C > 0; here K = 2 k_n/m* and
/// C = 2 c/m* of two contacts in parallel.
fn pair(share: f64, damping: f64) -> Engine {
    let (large, small, overlap) = (RADIUS, 0.2 * RADIUS, 1e-6);
    let height = 2.0 * (large + small - overlap);
    let (m, n) = (GLASS.sphere_mass(large), GLASS.sphere_mass(small));
    let m_eff = m * n / (m + n);
    let k_n = GLASS.normal_stiffness(effective_radius(large, small), overlap);
    let (k, c) = (2.0 * k_n / m_eff, 4.0 * damping * (m_eff * k_n).sqrt() / m_eff);
    let critical = ((c * c + 4.0 * k).sqrt() - c) / k;
    let mut s = setting(0.0, share * critical);
    s.damping = damping;
    let cell = box_of(5.0 * RADIUS, 5.0 * RADIUS, height);
    let mut e = engine(cell, GLASS, &[large, small], &[Vec3::zeros(), Vec3::z() * (0.5 * height)], s);
    // In the normal mode, with an amplitude far below the overlap: linear to 1e-8.
    e.set_velocities(&[Vec3::z() * (1e-7 * n / m), -Vec3::z() * 1e-7]).unwrap();
    e
}

#[test]
fn two_grains_stay_bounded_at_95_hundredths_of_the_exact_limit() {
    for damping in [0.0, 0.3, 1.0] {
        let mut e = pair(0.95, damping);
        let start = e.speed();
        let mut largest: f64 = 0.0;
        for _ in 0..20_000 {
            e.step().unwrap();
            largest = largest.max(e.speed());
        }
        // The leapfrog amplitude of a velocity at ω h = 1.9 is 1/√(1 − 0.95²) = 3.2 times the true one.
        assert!(largest < 3.5 * start, "damping {damping}: {largest}");
        if damping > 0.0 {
            assert!(e.speed() < 1e-4 * start, "damping {damping} stops them: {}", e.speed());
        }
    }
}

#[test]
fn two_grains_at_105_hundredths_of_the_exact_limit_are_caught_and_stay_finite() {
    for damping in [0.0, 0.3, 1.0] {
        let mut e = pair(1.05, damping);
        let start = e.speed();
        let refused = (0..20_000).find_map(|_| e.step().err());
        match &refused {
            Some(EngineError::Unstable { cause, .. }) => assert!(cause.contains("overlap"), "{cause}"),
            other => assert!(damping > 0.0 && other.is_none(), "damping {damping}: {other:?}"),
        }
        assert!(e.speed().is_finite() && e.speed() > 1e5 * start, "damping {damping}: {}", e.speed());
        assert!(packing(&e).validated().is_ok(), "no silent NaN");
    }
}

/// The packing's contacts as springs and dashpots between grains that stick, rolling ones too; without friction, they only push.
struct Linear<'a> {
    packing: &'a Packing,
    frictional: bool,
    damping: f64,
}

impl Linear<'_> {
    /// y = Σ Bᵀ w B x, with weights w (normal, tangential, rolling) of each contact, in coordinates in which inertia is 1.
    fn apply(&self, weights: impl Fn(&Contact) -> [f64; 3], x: &[[Vec3; 2]]) -> Vec<[Vec3; 2]> {
        let p = self.packing;
        let root = |i: u32| p.material.sphere_mass(p.radii[i as usize]).sqrt();
        let turn = |i: u32| 0.4f64.sqrt() * p.radii[i as usize] * root(i);
        let lever = |i: u32, c: &Contact| p.radii[i as usize] - 0.5 * c.overlap;
        let mut y = vec![[Vec3::zeros(); 2]; x.len()];
        for c in &p.contacts {
            let [w_n, w_t, w_r] = weights(c);
            let velocity = |i: u32| x[i as usize][0] / root(i);
            let mut relative = velocity(c.j) - velocity(c.i);
            for i in [c.i, c.j] {
                relative -= (x[i as usize][1] / turn(i) * lever(i, c)).cross(&c.normal);
            }
            let along = c.normal * relative.dot(&c.normal);
            let across = if self.frictional { relative - along } else { Vec3::zeros() };
            let force = along * w_n + across * w_t;
            for (i, sign) in [(c.i, -1.0), (c.j, 1.0)] {
                y[i as usize][0] += force * (sign / root(i));
                y[i as usize][1] -= c.normal.cross(&force) * (lever(i, c) / turn(i));
            }
            if self.frictional {
                let spin = |i: u32| x[i as usize][1] / turn(i);
                let r_eff = p.effective_radius(c);
                let rolling = (spin(c.j) - spin(c.i)).cross(&c.normal) * (w_r * r_eff);
                for (i, sign) in [(c.i, -1.0), (c.j, 1.0)] {
                    y[i as usize][1] += c.normal.cross(&rolling) * (sign * r_eff / turn(i));
                }
            }
        }
        y
    }

    /// The longest stable time step: at it 4 − h² K − 2 h C first loses a direction; by power iteration, s.
    fn critical(&self) -> f64 {
        let p = self.packing;
        let springs = |c: &Contact| {
            let (k_n, k_t) = p.contact_stiffness(c);
            [k_n, k_t, p.law.rolling.map_or(0.0, |r| r.stiffness)]
        };
        let dashpots = |c: &Contact| {
            let mass = |i: u32| p.material.sphere_mass(p.radii[i as usize]);
            let m_eff = mass(c.i) * mass(c.j) / (mass(c.i) + mass(c.j));
            let [c_n, c_t, _] = springs(c).map(|k| 2.0 * self.damping * (m_eff * k).sqrt());
            [c_n, c_t, p.law.rolling.map_or(0.0, |r| r.damping)]
        };
        let dot = |a: &[[Vec3; 2]], b: &[[Vec3; 2]]| -> f64 {
            a.iter().zip(b).map(|(a, b)| a[0].dot(&b[0]) + a[1].dot(&b[1])).sum()
        };
        let mut random = Random::new(4);
        let mut x: Vec<[Vec3; 2]> = p.radii.iter().map(|_| [(); 2].map(|()| random.vector(1.0))).collect();
        let mut h = 1e-9;
        for _ in 0..2000 {
            let (kx, cx) = (self.apply(springs, &x), self.apply(dashpots, &x));
            let square = dot(&x, &x);
            let (k, c) = (dot(&x, &kx) / square, dot(&x, &cx) / square);
            h = 4.0 / (c + (c * c + 4.0 * k).sqrt());
            for ((x, kx), cx) in x.iter_mut().zip(&kx).zip(&cx) {
                *x = [0, 1].map(|r| kx[r] * (h * h) + cx[r] * (2.0 * h));
            }
            let norm = dot(&x, &x).sqrt();
            x.iter_mut().flatten().for_each(|v| *v /= norm);
        }
        h
    }
}

/// 2/ω_max of a packing that sticks, s.
fn critical(packing: &Packing) -> f64 {
    Linear { packing, frictional: true, damping: 0.0 }.critical()
}

/// A frictional packing shaken far below its overlaps, at a share of its true limit.
fn shaken(share: f64) -> Engine {
    let mut p = Sample::Pressed.packing();
    p.time_step = share * critical(&p);
    let mut s = setting(f64::INFINITY, p.time_step);
    s.tangential = TangentialLaw::Incremental;
    let mut e = Engine::from_packing(&p, s).unwrap();
    let mut random = Random::new(7);
    e.set_velocities(&(0..48).map(|_| random.vector(1e-8)).collect::<Vec<_>>()).unwrap();
    e.initialise().unwrap();
    e
}

#[test]
fn a_packing_stays_bounded_at_95_hundredths_of_its_true_limit() {
    let mut e = shaken(0.95);
    let (start, pressure) = (e.speed(), e.observables().unwrap().stress.tensor.mean());
    for _ in 0..20_000 {
        e.step().unwrap();
        assert!(e.speed() < 10.0 * start, "{} after {} steps", e.speed(), e.steps());
    }
    assert!((e.observables().unwrap().stress.tensor.mean() / pressure - 1.0).abs() < 1e-6);
}

#[test]
fn a_packing_at_105_hundredths_of_its_true_limit_is_refused_within_a_hundred_steps() {
    let mut e = shaken(1.05);
    let refused = (0..100).find_map(|_| e.step().err());
    let Some(EngineError::Unstable { speed, cause, .. }) = refused else { panic!("{refused:?}") };
    assert!(speed.is_finite() && cause.contains("overlap"), "{speed} {cause}");
    assert!(packing(&e).validated().is_ok(), "the state that was refused is still finite");
}

/// Share of its true limit that the engine chooses, if contacts, and not the Rayleigh wave, set the step.
fn share(radii: &[f64], x: &[Vec3], cell: Cell, friction: f64, damping: f64) -> Option<f64> {
    let mut s = setting(friction, 0.0);
    (s.time_step, s.damping) = (TimeStep::FractionOfStable(1.0), damping);
    let e = engine(cell, GLASS, radii, x, s);
    let smallest = radii.iter().copied().fold(f64::INFINITY, f64::min);
    let alone = engine(box_of(1.0, 1.0, 1.0), GLASS, &[smallest], &[Vec3::zeros()], s).time_step();
    let share =
        e.time_step() / Linear { packing: &packing(&e), frictional: friction > 0.0, damping }.critical();
    assert!(share <= 1.0, "{share} of the true limit");
    (e.time_step() < alone).then_some(share)
}

#[test]
fn the_time_step_that_the_engine_chooses_is_below_the_true_limit_and_not_far_below() {
    let cases = [
        (Sample::Pressed, 0.3),
        (Sample::Few, 0.3),
        (Sample::Loose, f64::INFINITY),
        (Sample::Frictionless, 0.0),
        (Sample::Pressed, 0.0),
    ];
    let mut shares = 0;
    for (sample, friction) in cases {
        let p = sample.packing();
        for pressed in [0.0, 0.002, 0.005, 0.02] {
            let cell = p.cell.deformed(&(Mat3::identity() * (1.0 - pressed))).unwrap();
            let x: Vec<Vec3> = p.positions.iter().map(|x| x * (1.0 - pressed)).collect();
            for damping in [0.0, 0.1, 0.3, 1.0] {
                let Some(share) = share(&p.radii, &x, cell, friction, damping) else { continue };
                let case =
                    || format!("{sample:?}, friction {friction}, pressed by {pressed}, damping {damping}");
                assert!(share > 0.6, "{share}: {}", case());
                shares += 1;
            }
        }
    }
    assert!(shares >= 20, "contacts set the step in most cases: {shares}");
}

/// 48 grains, sizes from `smallest` to 1, pressed together fast by the time step that is under test, and at rest.
fn unequal(smallest: f64, seed: u64, friction: f64) -> Packing {
    let p = Sample::Pressed.packing();
    let mut random = Random::new(seed);
    let radii: Vec<f64> = p.radii.iter().map(|r| r * random.between(smallest, 1.0)).collect();
    let mut s = setting(friction, 0.0);
    (s.time_step, s.damping, s.drag, s.spin_drag) = (TimeStep::FractionOfStable(0.8), 0.3, 2e4, 2e4);
    let mut e = engine(p.cell, GLASS, &radii, &p.positions, s);
    e.set_rate(&[-100.0, -100.0, -100.0, 0.0, 0.0, 0.0]).unwrap();
    while e.observables().unwrap().stress.tensor.mean() < 2e7 {
        e.run(20).unwrap();
    }
    e.set_rate(&[0.0; 6]).unwrap();
    e.run(20_000).unwrap();
    packing(&e)
}

/// Expected: as with equal sizes, though a small grain moves much faster than the large ones that it touches.
#[test]
fn the_time_step_of_unequal_grains_is_below_the_true_limit_and_not_far_below() {
    let mut shares = Vec::new();
    for (smallest, seed) in [(0.7, 1), (0.4, 2), (0.2, 3), (0.2, 4)] {
        for friction in [0.0, 0.3] {
            let p = unequal(smallest, seed, friction);
            for damping in [0.0, 0.1, 0.3, 1.0] {
                let Some(share) = share(&p.radii, &p.positions, p.cell, friction, damping) else { continue };
                assert!(
                    share > 0.6,
                    "{share}: sizes from {smallest}, friction {friction}, damping {damping}"
                );
                shares.push(share);
            }
        }
    }
    assert!(shares.len() >= 20, "contacts set the step in most cases: {}", shares.len());
    assert!(shares.iter().any(|s| *s > 0.87), "{shares:?}");
}

/// Expected: as without resistance to rolling, where rolling is soft and where it alone sets the step.
#[test]
fn the_time_step_with_resistance_to_rolling_is_below_the_true_limit_and_not_far_below() {
    let p = unequal(0.7, 1, 0.3);
    let (k_n, _) = p.contact_stiffness(&p.contacts[0]);
    for stiffness in [0.1, 1.0, 10.0, 100.0] {
        for damping in [0.0, 0.3] {
            let mass = p.material.sphere_mass(RADIUS);
            let rolling = RollingResistance {
                stiffness: stiffness * k_n,
                damping: 2.0 * damping * (stiffness * k_n * mass).sqrt(),
                friction: 0.1,
            };
            let law = p.law.with_rolling(rolling);
            let mut s = setting(0.3, 0.0);
            (s.time_step, s.damping) = (TimeStep::FractionOfStable(1.0), damping);
            let e = taken_up(&Packing { time_step: 0.0, law, ..p.clone() }, s);
            let critical = Linear { packing: &packing(&e), frictional: true, damping }.critical();
            let share = e.time_step() / critical;
            assert!((0.6..=1.0).contains(&share), "{share} at {stiffness} k_n, damping {damping}");
        }
    }
}

/// Expected: with the bound itself for a time step, contact damping brings every mode to rest.
#[test]
fn damping_of_any_strength_stops_a_packing_at_the_bound() {
    let p = Sample::Pressed.packing();
    let touching = |i: usize| p.contacts.iter().filter(|c| c.i as usize == i || c.j as usize == i).count();
    let held: Vec<bool> = (0..p.grains()).map(|i| touching(i) >= 4).collect();
    let mut random = Random::new(7);
    let mut v: Vec<Vec3> =
        held.iter().map(|h| if *h { random.vector(1e-8) } else { Vec3::zeros() }).collect();
    // No contact stops the packing as a whole.
    let mean = v.iter().sum::<Vec3>() / held.iter().filter(|h| **h).count() as f64;
    v.iter_mut().zip(&held).filter(|(_, held)| **held).for_each(|(v, _)| *v -= mean);
    for damping in [0.1, 0.3, 1.0] {
        let mut s = setting(f64::INFINITY, 0.0);
        (s.tangential, s.damping, s.time_step) =
            (TangentialLaw::Incremental, damping, TimeStep::FractionOfStable(1.0));
        let mut e = Engine::from_packing(&Packing { time_step: 0.0, ..p.clone() }, s).unwrap();
        e.set_velocities(&v).unwrap();
        e.initialise().unwrap();
        let start = e.speed();
        for _ in 0..20_000 {
            e.step().unwrap();
            assert!(e.speed() < 2.0 * start, "damping {damping}, step {}: {}", e.steps(), e.speed() / start);
        }
        assert!(e.speed() < 1e-2 * start, "damping {damping}: {} of what it was", e.speed() / start);
    }
}
