//! One contact against closed form, for every contact law: springs, sliding, closed cycles, rotation, collisions.

use grainlab_core::contact::{
    ContactKinematics, ContactLaw, ContactSprings, LawVisitor, SpringDashpotSlider, SpringLaw, TangentialLaw,
};
use grainlab_core::effective_radius;
use grainlab_core::lanes::LaneVec3;
use grainlab_core::{Cell, Packing, Vec3};
use grainlab_engine::EngineSettings;
use grainlab_testkit::Random;
use grainlab_testkit::engine::{GLASS, RADIUS, gas, packing, setting, taken_up};
use nalgebra::{Rotation3, Unit};
use std::marker::PhantomData;

const DT: f64 = 1e-8;

/// Something that holds for every law.
trait Claim {
    fn check<S: ContactSprings>(springs: S, law: ContactLaw);
}

/// Checks a claim for all laws.
fn holds<C: Claim>() {
    struct Check<C>(ContactLaw, PhantomData<C>);
    impl<C: Claim> LawVisitor for Check<C> {
        type Output = ();
        fn visit<S: ContactSprings>(self, springs: S) {
            C::check(springs, self.0);
        }
    }
    for law in ContactLaw::examples() {
        law.visit(&GLASS, Check::<C>(law, PhantomData));
    }
}

/// Two spheres moved by hand: positions and spins in, forces out.
struct Pair<S> {
    law: SpringDashpotSlider<S>,
    history: Vec3,
    contact_radius: f64,
    branch: Vec3,
}

fn lanes(v: Vec3) -> LaneVec3<f64> {
    LaneVec3::new(v.x, v.y, v.z)
}

fn vector(v: LaneVec3<f64>) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}

fn contact_radius(overlap: f64) -> f64 {
    (effective_radius(RADIUS, RADIUS) * overlap).sqrt()
}

fn normal_force(springs: impl ContactSprings, overlap: f64) -> f64 {
    springs.normal_force(springs.normal_stiffness(contact_radius(overlap), overlap), overlap)
}

impl<S: ContactSprings> Pair<S> {
    fn new(springs: S, friction: f64, overlap: f64) -> Self {
        let branch = Vec3::z() * (2.0 * RADIUS - overlap);
        let law = SpringDashpotSlider { springs, friction, damping: 0.0, kept: 0.0 };
        Self { law, history: Vec3::zeros(), contact_radius: contact_radius(overlap), branch }
    }

    /// Moves `j` to `branch` with both grains spinning at `spin`; returns (F_n, F_t on i).
    fn step(&mut self, branch: Vec3, spin: Vec3) -> (f64, Vec3) {
        let distance = branch.norm();
        let overlap = 2.0 * RADIUS - distance;
        let kinematics = ContactKinematics {
            normal: lanes(branch / distance),
            inverse_distance: 1.0 / distance,
            overlap,
            contact_radius: contact_radius(overlap),
            contact_radius_before: self.contact_radius,
            m_eff: 1.0,
            relative_velocity: lanes((branch - self.branch) / DT),
            spin_velocity: lanes(spin * distance),
            spin_sum: lanes(2.0 * spin),
        };
        let f = self.law.full_force::<f64, true, true>(&kinematics, lanes(self.history), DT);
        (self.history, self.contact_radius) = (vector(f.history), kinematics.contact_radius);
        self.branch = branch;
        (f.normal, vector(f.tangential))
    }

    /// Moves to overlap `d` with the lateral displacement `ds` along x, without turning the line of centres.
    fn slide(&mut self, d: f64, ds: f64) -> (f64, Vec3) {
        let branch = Vec3::z() * (2.0 * RADIUS - d);
        self.branch.x = -ds;
        self.step(branch, Vec3::zeros())
    }
}

#[test]
fn the_normal_force_is_the_derivative_of_its_energy_and_the_stiffness_that_of_the_force() {
    struct Derivatives;
    impl Claim for Derivatives {
        fn check<S: ContactSprings>(springs: S, law: ContactLaw) {
            let r_eff = effective_radius(RADIUS, RADIUS);
            for d in [1e-9, 4e-8, 3e-7] {
                let h = 1e-5 * d;
                let energy = |d: f64| springs.normal_energy(normal_force(springs, d), contact_radius(d), d);
                let slope = |f: &dyn Fn(f64) -> f64| (f(d + h) - f(d - h)) / (2.0 * h);
                let (force, stiffness) = (slope(&energy), slope(&|d| normal_force(springs, d)));
                let [f, k, k_t] = [
                    normal_force(springs, d),
                    springs.normal_stiffness(contact_radius(d), d),
                    springs.tangential_stiffness(contact_radius(d), d, 1.0),
                ];
                assert!((force / f - 1.0).abs() < 1e-8, "{law:?}: {force} {f}");
                assert!((stiffness / k - 1.0).abs() < 1e-8, "{law:?}: {stiffness} {k}");
                assert!((k_t / k / springs.stiffness_ratio() - 1.0).abs() < 1e-14, "{law:?}");
                assert!((springs.dashpot_ratio().powi(2) / springs.stiffness_ratio() - 1.0).abs() < 1e-14);
                // Packings report the forces that the engine applies.
                assert!((law.normal_force(&GLASS, r_eff, d) / f - 1.0).abs() < 1e-14, "{law:?}");
                let (k_n, k_s) = law.springs.stiffnesses(&GLASS, r_eff, d);
                assert!((k_n / k - 1.0).abs() < 1e-14 && (k_s / k_t - 1.0).abs() < 1e-14, "{law:?}");
            }
        }
    }
    holds::<Derivatives>();
}

#[test]
fn the_tangential_force_is_elastic_without_slip_and_coulomb_with() {
    struct Coulomb;
    impl Claim for Coulomb {
        fn check<S: ContactSprings>(springs: S, law: ContactLaw) {
            let d = 4e-8;
            let mut pair = Pair::new(springs, 0.2, d);
            let (_, k_t) = law.springs.stiffnesses(&GLASS, RADIUS / 2.0, d);
            let limit = 0.2 * law.normal_force(&GLASS, RADIUS / 2.0, d);
            let mut s = 0.0;
            // A thousand steps to the limit, a thousand beyond it.
            let ds = limit / k_t / 1000.0;
            for _ in 0..2000 {
                s += ds;
                let (_, t) = pair.slide(d, ds);
                let expected = (k_t * s).min(limit);
                assert!((t.x / expected - 1.0).abs() < 1e-8 && t.y == 0.0, "{law:?}: {} {expected}", t.x);
            }
            // Reversal: elastic at first, from the limit.
            let (_, t) = pair.slide(d, -ds);
            assert!((t.x - (limit - k_t * ds)).abs() < 1e-8 * limit, "{law:?}");
        }
    }
    holds::<Coulomb>();
}

/// Work done on the pair over a closed path in (overlap, slip), by the trapezium rule, over its elastic energy.
fn work_over_cycle<S: ContactSprings>(
    springs: S,
    tangential: TangentialLaw,
    path: &[(f64, f64)],
    friction: f64,
) -> f64 {
    let mut pair = Pair::new(springs, friction, path[0].0);
    pair.law.kept = tangential.kept();
    let (mut work, mut last) = (0.0, pair.slide(path[0].0, 0.0));
    let pieces = 400;
    for leg in path.windows(2) {
        let (dd, ds) = ((leg[1].0 - leg[0].0) / f64::from(pieces), (leg[1].1 - leg[0].1) / f64::from(pieces));
        for k in 1..=pieces {
            let now = pair.slide(leg[0].0 + dd * f64::from(k), ds);
            work += 0.5 * (last.0 + now.0) * dd + 0.5 * (last.1.x + now.1.x) * ds;
            last = now;
        }
    }
    let (d, _) = path[0];
    work / springs.normal_energy(normal_force(springs, d), contact_radius(d), d)
}

#[test]
fn no_closed_cycle_creates_energy_with_the_rescaled_history() {
    struct Cycles;
    impl Claim for Cycles {
        fn check<S: ContactSprings>(springs: S, law: ContactLaw) {
            let (low, high) = (1e-8, 4e-8);
            let mut random = Random::new(12345);
            let mut place = || (low + high * random.unit(), 2e-8 * (random.unit() - 0.5));
            // Closed paths, with and without sliding.
            for friction in [0.1, 0.5, 1e9] {
                for _ in 0..200 {
                    let mut path: Vec<(f64, f64)> = (0..6).map(|_| place()).collect();
                    path.push(path[0]);
                    let work = work_over_cycle(springs, TangentialLaw::Rescaled, &path, friction);
                    // The trapezium rule is exact to about 1e-6 on these legs.
                    assert!(work > -1e-5, "{law:?}, friction {friction}: work {work}");
                }
            }
        }
    }
    holds::<Cycles>();
}

#[test]
fn the_incremental_history_of_mindlin_gains_energy_where_the_rescaled_one_does_not() {
    // Shear at high load, unload, shear back, load again.
    let (low, high) = (1e-8, 4e-8);
    let pump = [(low, 0.0), (high, 0.0), (high, 1e-8), (low, 1e-8), (low, 0.0)];
    let springs = grainlab_core::contact::HertzMindlin::new(&GLASS);
    let rescaled = work_over_cycle(springs, TangentialLaw::Rescaled, &pump, 1e9);
    let incremental = work_over_cycle(springs, TangentialLaw::Incremental, &pump, 1e9);
    assert!(rescaled > 0.0, "rescaled work {rescaled}");
    assert!(incremental < -1e-3, "the incremental law gains energy here: {incremental}");
}

#[test]
fn a_rigid_rotation_of_a_loaded_pair_rotates_its_forces() {
    struct Rotation;
    impl Claim for Rotation {
        fn check<S: ContactSprings>(springs: S, law: ContactLaw) {
            let d = 4e-8;
            let error = |axis: Vec3, steps: u32| {
                let mut pair = Pair::new(springs, 1e9, d);
                let (normal, loaded) = pair.slide(d, 5e-9);
                let (axis, total) = (Unit::new_normalize(axis), 2.0f64);
                let spin = axis.into_inner() * (total / f64::from(steps) / DT);
                let (branch, mut last) = (pair.branch, (normal, loaded));
                for k in 1..=steps {
                    let turn = Rotation3::from_axis_angle(&axis, total * f64::from(k) / f64::from(steps));
                    last = pair.step(turn * branch, spin);
                }
                let expected = Rotation3::from_axis_angle(&axis, total) * loaded;
                assert!((last.0 / normal - 1.0).abs() < 1e-7, "{law:?}: the normal force is unchanged");
                (last.1 - expected).norm() / loaded.norm()
            };
            // About the line of centres (pure twist), across it, and in between. A chord of the circle slips against the spin
            // by a third-order length, 4e4 times stiffer than this load: the error falls with the square of the step.
            for axis in [Vec3::z(), Vec3::y(), Vec3::x(), Vec3::new(1.0, -2.0, 0.5)] {
                let (coarse, fine) = (error(axis, 20_000), error(axis, 40_000));
                assert!(fine < 5e-5, "{law:?}, axis {axis:?}: {fine}");
                assert!(fine < 0.3 * coarse || fine < 1e-9, "{law:?}, axis {axis:?}: {coarse} to {fine}");
            }
        }
    }
    holds::<Rotation>();
}

/// Two spheres in the engine that meet head on at relative speed `speed` (m/s); (largest overlap, speed of separation,
/// duration).
fn collision(law: ContactLaw, damping: f64, speed: f64) -> (f64, f64, f64) {
    let cell = Cell::cube(20.0 * RADIUS).unwrap();
    let x = vec![Vec3::zeros(), Vec3::x() * (2.0 * RADIUS * (1.0 + 1e-9))];
    let velocities = [0.5 * speed, -0.5 * speed].map(|v| Vec3::x() * v).to_vec();
    let settings = EngineSettings { damping, ..setting(EngineSettings::default().friction, 1e-10) };
    let pair = Packing { law, velocities, ..Packing::at_rest(cell, vec![RADIUS; 2], x) };
    let mut e = taken_up(&pair, settings);
    let (mut deepest, mut begin, mut end) = (0.0f64, f64::NAN, f64::NAN);
    for _ in 0..2_000_000 {
        e.step().unwrap();
        match packing(&e).contacts.first() {
            Some(c) => {
                deepest = deepest.max(c.overlap);
                begin = begin.min(e.time());
            }
            None if !begin.is_nan() => {
                end = e.time();
                break;
            }
            None => {}
        }
    }
    let v = e.velocities();
    (deepest, v[1].x - v[0].x, end - begin)
}

/// Largest overlap, m, and duration, s, of a collision: twice the integral of 1/speed over the overlap.
fn rough_collision(springs: impl ContactSprings, m_eff: f64, speed: f64) -> (f64, f64) {
    let deepest = springs.collision_overlap(RADIUS / 2.0, m_eff, speed);
    let (pieces, mut time) = (20_000, 0.0);
    for k in 0..pieces {
        let (sine, cosine) =
            ((f64::from(k) + 0.5) * std::f64::consts::FRAC_PI_2 / f64::from(pieces)).sin_cos();
        let d = deepest * sine;
        let energy = springs.normal_energy(normal_force(springs, d), contact_radius(d), d);
        time += deepest * cosine / (speed * speed - 2.0 * energy / m_eff).sqrt();
    }
    (deepest, std::f64::consts::PI / f64::from(pieces) * time)
}

#[test]
fn an_undamped_collision_has_the_closed_form_of_its_law() {
    let m_eff = 0.5 * GLASS.sphere_mass(RADIUS);
    let speed = 0.1;
    for law in ContactLaw::examples() {
        let (deepest, after, duration) = collision(law, 0.0, speed);
        // Hertz (1881): t = 2.9432751 δ/v. Linear: half a period.
        let (overlap, expected) = match law.springs {
            SpringLaw::HertzMindlin => {
                let k = 8.0 / 15.0 * GLASS.effective_young() * (RADIUS / 2.0).sqrt();
                let overlap = (0.5 * m_eff * speed * speed / k).powf(0.4);
                (overlap, 2.943_275_1 * overlap / speed)
            }
            SpringLaw::Linear(l) => {
                let omega = (l.normal_stiffness / m_eff).sqrt();
                (speed / omega, std::f64::consts::PI / omega)
            }
            SpringLaw::Rough(rough) => rough_collision(rough.springs(&GLASS), m_eff, speed),
        };
        assert!((deepest / overlap - 1.0).abs() < 1e-5, "{law:?}: {deepest} {overlap}");
        assert!((after / speed - 1.0).abs() < 1e-6, "{law:?}: {after}");
        assert!((duration / expected - 1.0).abs() < 1e-3, "{law:?}: {duration} {expected}");
    }
}

#[test]
fn restitution_of_linear_springs_is_that_of_a_damped_oscillator_without_attraction() {
    let law = ContactLaw::examples()[1];
    assert_eq!(law.name(), "linear");
    for damping in [0.05f64, 0.2, 0.5] {
        // Schwager & Pöschel, Granular Matter 9, 465 (2007), Eq. 21: the contact ends where the force becomes zero.
        let phase = std::f64::consts::PI - 2.0 * damping.asin();
        let expected = (-damping / (1.0 - damping * damping).sqrt() * phase).exp();
        let (_, after, _) = collision(law, damping, 0.1);
        assert!((after / 0.1 / expected - 1.0).abs() < 1e-3, "damping {damping}: {} {expected}", after / 0.1);
    }
}

/// FNV-1a of positions, spins and tangential forces after 20,000 steps of 30 grains that are compressed and sheared.
fn trajectory(law: ContactLaw) -> u64 {
    let settings = EngineSettings { damping: 0.1, ..setting(0.3, 2e-8) };
    let mut e = taken_up(&Packing { law, ..gas(&[RADIUS; 30], 0.1, 5) }, settings);
    e.set_rate(&[-500.0, -480.0, -520.0, 30.0, -20.0, 60.0]).unwrap();
    e.run(20_000).unwrap();
    let p = packing(&e);
    assert!(p.contacts.iter().any(|c| c.tangential_force.norm() > 0.0));
    let vectors = p.positions.iter().chain(&p.spins).chain(p.contacts.iter().map(|c| &c.tangential_force));
    let bytes = vectors.flat_map(|v| v.iter().flat_map(|x| x.to_bits().to_le_bytes()).collect::<Vec<u8>>());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, b| (hash ^ u64::from(b)).wrapping_mul(0x100_0000_01b3))
}

/// Expected: the same bits as when these numbers were written, with every instruction set.
#[test]
fn trajectories_are_those_recorded() {
    let mut others = Vec::new();
    for law in ContactLaw::examples() {
        let recorded: u64 = match (law.springs, law.rolling.is_some()) {
            (SpringLaw::HertzMindlin, false) => 17_239_418_569_566_077_293,
            (SpringLaw::Linear(_), false) => 12_679_378_947_345_144_448,
            (SpringLaw::Rough(_), false) => 10_898_191_195_268_474_932,
            (SpringLaw::HertzMindlin, true) => 16_609_387_150_457_970_543,
            (SpringLaw::Linear(_), true) => 17_855_520_105_440_905_054,
            (SpringLaw::Rough(_), true) => 7_541_897_598_495_465_978,
        };
        let now = trajectory(law);
        others.extend((now != recorded).then(|| format!("{law:?}: {now}, recorded: {recorded}")));
    }
    assert_eq!(others, Vec::<String>::new());
}
