//! The time step at 0.95 and 1.05 of the true stability limit.
//!
//! Expected: below it energy stays bounded; above it the run is refused with grain and contact named, or (where contact
//! damping feeds a limit cycle) stays finite; never a number that is not one.

use crate::support::*;
use dem::{DemError, Engine, TimeStep};
use grains::material::effective_radius;
use grains::{Mat3, Packing, Vec3};
use micro::{Motion, Network};
use scene::Tangential;

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
    e.set_velocities(&[Vec3::z() * (1e-7 * n / m), -Vec3::z() * 1e-7]);
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
            Some(DemError::Unstable { cause, .. }) => assert!(cause.contains("overlap"), "{cause}"),
            other => assert!(damping > 0.0 && other.is_none(), "damping {damping}: {other:?}"),
        }
        assert!(e.speed().is_finite() && e.speed() > 1e5 * start, "damping {damping}: {}", e.speed());
        assert!(packing(&e).validated().is_ok(), "no silent NaN");
    }
}

/// 2/ω_max of the stuck network with the masses and moments of inertia of its grains, by power iteration, s.
fn critical(p: &Packing) -> f64 {
    let network = Network::new(p, true).unwrap();
    let a = network.rotation_length();
    let root = |i: usize, k: usize| {
        let m = p.material.sphere_mass(p.radii[i]);
        (if k < 3 { m } else { 0.4 * m * p.radii[i].powi(2) / (a * a) }).sqrt()
    };
    let n = p.grains();
    let mut random = Random(4);
    let mut x: Vec<Motion<1>> = (0..n).map(|_| [(); 6].map(|()| [random.between(-1.0, 1.0)])).collect();
    let mut y = x.clone();
    let mut square = 0.0;
    for _ in 0..1000 {
        for (i, m) in x.iter_mut().enumerate() {
            (0..6).for_each(|k| m[k][0] /= root(i, k));
        }
        network.apply(&x, &mut y);
        for (i, m) in y.iter_mut().enumerate() {
            (0..6).for_each(|k| m[k][0] /= root(i, k));
        }
        square = y.iter().flatten().map(|v| v[0] * v[0]).sum::<f64>().sqrt();
        for (a, b) in x.iter_mut().flatten().zip(y.iter().flatten()) {
            a[0] = b[0] / square;
        }
    }
    2.0 / square.sqrt()
}

/// A frictional packing shaken far below its overlaps, at a share of its true limit.
fn shaken(share: f64) -> Engine {
    let mut p = Sample::Pressed.packing();
    p.time_step = share * critical(&p);
    let mut s = setting(f64::INFINITY, p.time_step);
    s.tangential = Tangential::Incremental;
    let mut e = Engine::from_packing(&p, s);
    let mut random = Random(7);
    e.set_velocities(&(0..48).map(|_| random.vector(1e-8)).collect::<Vec<_>>());
    e.prepare().unwrap();
    e
}

#[test]
fn a_packing_stays_bounded_at_95_hundredths_of_its_true_limit() {
    let mut e = shaken(0.95);
    let (start, pressure) = (e.speed(), e.snapshot().unwrap().stress.tensor.mean());
    for _ in 0..20_000 {
        e.step().unwrap();
        assert!(e.speed() < 10.0 * start, "{} after {} steps", e.speed(), e.steps());
    }
    assert!((e.snapshot().unwrap().stress.tensor.mean() / pressure - 1.0).abs() < 1e-6);
}

#[test]
fn a_packing_at_105_hundredths_of_its_true_limit_is_refused_within_a_hundred_steps() {
    let mut e = shaken(1.05);
    let refused = (0..100).find_map(|_| e.step().err());
    let Some(DemError::Unstable { speed, cause, .. }) = refused else { panic!("{refused:?}") };
    assert!(speed.is_finite() && cause.contains("overlap"), "{speed} {cause}");
    assert!(packing(&e).validated().is_ok(), "the state that was refused is still finite");
}

/// Expected: at 100 kPa and pressed on by half a percent, where contacts are stiffer than the Rayleigh wave is fast.
#[test]
fn the_time_step_that_the_engine_chooses_is_below_the_true_limit_and_not_far_below() {
    let p = Sample::Pressed.packing();
    for pressed in [0.0, 0.002, 0.005] {
        let cell = p.cell.deformed(&(Mat3::identity() * (1.0 - pressed))).unwrap();
        let x: Vec<Vec3> = p.positions.iter().map(|x| x * (1.0 - pressed)).collect();
        let mut s = setting(f64::INFINITY, 0.0);
        s.time_step = TimeStep::Safety(1.0);
        let e = engine(cell, GLASS, &p.radii, &x, s);
        let share = e.time_step() / critical(&packing(&e));
        assert!(share <= 1.0 && share > 0.45, "{share} of the true limit, pressed by {pressed}");
    }
}

/// Expected: a scene cannot ask for more than the bound; the fault names the key.
#[test]
fn a_scene_that_asks_for_105_hundredths_of_the_bound_is_refused() {
    let text = "name = 'x'\n[grains]\ncount = 2\ndiameter = 2e-4\n[numerics]\ntime_step_safety = 1.05\n\
                [[phase]]\nkind = 'gas'\nrate = -1.0\nuntil = { elapsed = 1e-6 }\n";
    let faults = scene::Scene::parse(text).unwrap_err().faults;
    assert!(faults.len() == 1 && faults[0].place.contains("time_step_safety"), "{faults:?}");
    assert!(scene::Scene::parse(&text.replace("1.05", "0.95")).is_ok());
}
