//! One contact against closed form: loading, sliding, closed cycles, rotation.

use grainlab_core::material::effective_radius;
use grainlab_core::{Material, Vec3};
use grainlab_dem::{ContactKinematics, HertzMindlin, LaneVec3};
use nalgebra::{Rotation3, Unit};

const RADIUS: f64 = 1e-4;
const GLASS: Material = Material::GLASS;
const DT: f64 = 1e-8;

/// Two spheres moved by hand: positions and spins in, forces out, the history kept.
struct Pair {
    law: HertzMindlin,
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

impl Pair {
    fn new(friction: f64, overlap: f64) -> Self {
        let branch = Vec3::z() * (2.0 * RADIUS - overlap);
        Self {
            law: HertzMindlin::new(&GLASS, friction, 0.0),
            history: Vec3::zeros(),
            contact_radius: contact_radius(overlap),
            branch,
        }
    }

    /// Moves `j` to `branch` with both grains spinning at `spin`; returns (F_n, F_t on i).
    fn step<const RESCALED: bool>(&mut self, branch: Vec3, spin: Vec3) -> (f64, Vec3) {
        let distance = branch.norm();
        let overlap = 2.0 * RADIUS - distance;
        let normal = branch / distance;
        let kinematics = ContactKinematics {
            normal: lanes(normal),
            inverse_distance: 1.0 / distance,
            overlap,
            contact_radius: contact_radius(overlap),
            unloading: (contact_radius(overlap) / self.contact_radius).min(1.0),
            m_eff: 1.0,
            relative_velocity: lanes((branch - self.branch) / DT),
            spin_velocity: lanes(spin * distance),
            spin_sum: lanes(2.0 * spin),
        };
        let f = self.law.full_force::<f64, true, true, RESCALED>(&kinematics, lanes(self.history), DT);
        (self.history, self.contact_radius) = (vector(f.history), kinematics.contact_radius);
        self.branch = branch;
        (f.normal, vector(f.tangential))
    }

    /// Moves to overlap `d` and lateral displacement `s` along x without turning the line of centres.
    fn slide<const RESCALED: bool>(&mut self, d: f64, ds: f64) -> (f64, Vec3) {
        let branch = Vec3::z() * (2.0 * RADIUS - d);
        self.branch.x = -ds;
        self.step::<RESCALED>(branch, Vec3::zeros())
    }
}

#[test]
fn normal_force_is_hertz() {
    let mut pair = Pair::new(0.5, 1e-9);
    for d in [1e-9, 4e-8, 3e-7] {
        let (f, _) = pair.slide::<true>(d, 0.0);
        let hertz = 4.0 / 3.0 * 36.25e9 * (RADIUS / 2.0).sqrt() * d.powf(1.5);
        // The overlap is a difference of lengths 1e3 to 1e5 times larger.
        assert!((f / hertz - 1.0).abs() < 1e-10, "{f} {hertz}");
    }
}

#[test]
fn tangential_force_is_mindlin_without_slip_and_coulomb_with() {
    let d = 4e-8;
    let mut pair = Pair::new(0.2, d);
    let k_t = GLASS.tangential_stiffness(RADIUS / 2.0, d);
    let limit = 0.2 * GLASS.normal_force(RADIUS / 2.0, d);
    let (mut s, ds) = (0.0, 1e-11);
    for _ in 0..2000 {
        s += ds;
        let (_, t) = pair.slide::<true>(d, ds);
        let expected = (k_t * s).min(limit);
        assert!((t.x / expected - 1.0).abs() < 1e-9 && t.y == 0.0, "{} {expected}", t.x);
    }
    assert!(k_t * s > 2.0 * limit, "the path slides for half of its length");
    // Reversal: elastic at first, from the limit.
    let (_, t) = pair.slide::<true>(d, -ds);
    assert!((t.x - (limit - k_t * ds)).abs() < 1e-9 * limit);
}

/// Work done on the pair over a closed path in (overlap, slip), by the trapezium rule, over its elastic energy.
fn work_over_cycle<const RESCALED: bool>(path: &[(f64, f64)], friction: f64) -> f64 {
    let mut pair = Pair::new(friction, path[0].0);
    let (mut work, mut last) = (0.0, pair.slide::<RESCALED>(path[0].0, 0.0));
    let pieces = 400;
    for leg in path.windows(2) {
        let (dd, ds) = ((leg[1].0 - leg[0].0) / f64::from(pieces), (leg[1].1 - leg[0].1) / f64::from(pieces));
        for k in 1..=pieces {
            let now = pair.slide::<RESCALED>(leg[0].0 + dd * f64::from(k), ds);
            work += 0.5 * (last.0 + now.0) * dd + 0.5 * (last.1.x + now.1.x) * ds;
            last = now;
        }
    }
    let (d, _) = path[0];
    work / (0.4 * d * GLASS.normal_force(RADIUS / 2.0, d))
}

#[test]
fn no_closed_cycle_creates_energy_with_the_rescaled_history() {
    // Shear at high load, take the load off, shear back, load again: the cycle that the incremental law gains from.
    let (low, high) = (1e-8, 4e-8);
    let pump = [(low, 0.0), (high, 0.0), (high, 1e-8), (low, 1e-8), (low, 0.0)];
    let rescaled = work_over_cycle::<true>(&pump, 1e9);
    let incremental = work_over_cycle::<false>(&pump, 1e9);
    assert!(rescaled > 0.0, "rescaled work {rescaled}");
    assert!(incremental < -1e-3, "the incremental law gains energy here: {incremental}");
    // Many other closed paths, with and without sliding.
    let mut random = 12345u64;
    let mut next = || {
        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (random >> 11) as f64 / (1u64 << 53) as f64
    };
    for friction in [0.1, 0.5, 1e9] {
        for _ in 0..200 {
            let mut path: Vec<(f64, f64)> =
                (0..6).map(|_| (low + high * next(), 2e-8 * (next() - 0.5))).collect();
            path.push(path[0]);
            let work = work_over_cycle::<true>(&path, friction);
            // The trapezium rule is exact to about 1e-6 on these legs.
            assert!(work > -1e-5, "friction {friction} work {work}");
        }
    }
}

#[test]
fn a_rigid_rotation_of_a_loaded_pair_turns_its_forces_along() {
    let d = 4e-8;
    let error = |axis: Vec3, steps: u32| {
        let mut pair = Pair::new(1e9, d);
        let (normal, loaded) = pair.slide::<true>(d, 5e-9);
        let (axis, total) = (Unit::new_normalize(axis), 2.0f64);
        let spin = axis.into_inner() * (total / f64::from(steps) / DT);
        let (branch, mut last) = (pair.branch, (normal, loaded));
        for k in 1..=steps {
            let turn = Rotation3::from_axis_angle(&axis, total * f64::from(k) / f64::from(steps));
            last = pair.step::<true>(turn * branch, spin);
        }
        let expected = Rotation3::from_axis_angle(&axis, total) * loaded;
        assert!((last.0 / normal - 1.0).abs() < 1e-7, "the normal force is untouched");
        (last.1 - expected).norm() / loaded.norm()
    };
    // About the line of centres (pure twist), across it, and in between. A chord of the circle slips against the spin by
    // a third-order length, 4e4 times stiffer than this load: what is left falls with the square of the step.
    for axis in [Vec3::z(), Vec3::y(), Vec3::x(), Vec3::new(1.0, -2.0, 0.5)] {
        let (coarse, fine) = (error(axis, 20_000), error(axis, 40_000));
        assert!(fine < 5e-5, "axis {axis:?}: {fine}");
        assert!(fine < 0.3 * coarse || fine < 1e-9, "axis {axis:?}: {coarse} to {fine}");
    }
}
