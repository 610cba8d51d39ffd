//! Rolling resistance: one contact by hand, and two grains against closed form.

use grainlab_core::contact::{
    ContactKinematics, ContactLaw, HertzMindlin, RollingResistance, RollingSprings, SpringDashpotSlider,
    SpringLaw,
};
use grainlab_core::lanes::LaneVec3;
use grainlab_core::{Packing, Vec3};
use grainlab_dem::Engine;
use grainlab_testkit::Random;
use grainlab_testkit::engine::{GLASS, RADIUS, box_of, packing, setting, taken_up};
use nalgebra::{Rotation3, Unit};

const R_EFF: f64 = 0.5 * RADIUS;
const STIFFNESS: f64 = 1e4;
const FRICTION: f64 = 0.1;
const DT: f64 = 1e-8;

fn resistance(damping: f64) -> RollingResistance {
    RollingResistance { stiffness: STIFFNESS, damping, friction: FRICTION }
}

fn lanes(v: Vec3) -> LaneVec3<f64> {
    LaneVec3::new(v.x, v.y, v.z)
}

/// A contact that is rolled by hand, under a normal force of 1 N.
struct Rolled {
    law: SpringDashpotSlider<RollingSprings<HertzMindlin>>,
    normal: Vec3,
    history: Vec3,
}

impl Rolled {
    fn new(damping: f64) -> Self {
        let springs = RollingSprings { springs: HertzMindlin::new(&GLASS), rolling: resistance(damping) };
        let law = SpringDashpotSlider { springs, friction: 0.3, damping: 0.0, kept: 0.0 };
        Self { law, normal: Vec3::z(), history: Vec3::zeros() }
    }

    /// One step with these spins (rad/s), to a new normal; the rolling force, N.
    fn step(&mut self, spins: [Vec3; 2], normal: Vec3) -> Vec3 {
        let distance = 2.0 * RADIUS;
        let c = ContactKinematics {
            normal: lanes(normal),
            inverse_distance: 1.0 / distance,
            overlap: 1e-8,
            contact_radius: (R_EFF * 1e-8).sqrt(),
            contact_radius_before: (R_EFF * 1e-8).sqrt(),
            m_eff: 1.0,
            relative_velocity: lanes((normal - self.normal) * distance / DT),
            spin_velocity: lanes((spins[0] + spins[1]) * RADIUS),
            spin_sum: lanes(spins[0] + spins[1]),
        };
        let velocity = lanes((spins[1] - spins[0]).cross(&normal) * R_EFF);
        let f = self.law.rolling_force::<f64, true>(&c, velocity, 1.0, lanes(self.history), DT);
        let vector = |v: LaneVec3<f64>| Vec3::new(v.x, v.y, v.z);
        (self.history, self.normal) = (vector(f.history), normal);
        vector(f.total)
    }

    /// Rolls by the displacement `d` (m) along x, without turning the normal.
    fn roll(&mut self, d: f64) -> Vec3 {
        self.step([Vec3::zeros(), Vec3::y() * (d / (R_EFF * DT))], Vec3::z())
    }
}

/// An independent writing of the update of LAMMPS's `rolling sds` (granular/rolling_sds, without dashpot): history in m, normal
/// from j to i, torque on i.
#[test]
fn without_dashpots_the_torque_is_that_of_lammps() {
    let mut pair = Rolled::new(0.0);
    let (nx, mut history) = (-Vec3::z(), Vec3::zeros());
    let mut random = Random::new(12345);
    let mut slid = 0;
    for _ in 0..2000 {
        // No spin about the normal: LAMMPS does not turn the history with it.
        let mut spin = || Vec3::new(random.between(-0.45, 0.55), random.between(-0.45, 0.55), 0.0) * 4e6;
        let (omega_i, omega_j) = (spin(), spin());
        let vrl = (omega_i - omega_j).cross(&nx) * R_EFF;
        history += vrl * DT;
        let mut fr = -STIFFNESS * history;
        if fr.norm() > FRICTION {
            fr *= FRICTION / fr.norm();
            history = -fr / STIFFNESS;
            slid += 1;
        }
        let torque = nx.cross(&fr) * R_EFF;
        let ours = Vec3::z().cross(&pair.step([omega_i, omega_j], Vec3::z())) * R_EFF;
        assert!((ours - torque).norm() < 1e-12 * FRICTION * R_EFF, "{ours:?} {torque:?}");
    }
    assert!(slid > 100 && slid < 1900, "{slid} steps of sliding");
}

#[test]
fn a_rigid_rotation_of_a_rolled_pair_rotates_its_rolling_force() {
    let error = |axis: Vec3, steps: u32| {
        let mut pair = Rolled::new(0.0);
        let loaded = pair.roll(0.5 * FRICTION / STIFFNESS);
        let (axis, total) = (Unit::new_normalize(axis), 2.0f64);
        let spin = axis.into_inner() * (total / f64::from(steps) / DT);
        let mut last = loaded;
        for k in 1..=steps {
            let turn = Rotation3::from_axis_angle(&axis, total * f64::from(k) / f64::from(steps));
            last = pair.step([spin; 2], turn * Vec3::z());
        }
        (last - Rotation3::from_axis_angle(&axis, total) * loaded).norm() / loaded.norm()
    };
    for axis in [Vec3::z(), Vec3::y(), Vec3::x(), Vec3::new(1.0, -2.0, 0.5)] {
        let (coarse, fine) = (error(axis, 2000), error(axis, 4000));
        assert!(fine < 1e-6, "axis {axis:?}: {fine}");
        assert!(fine < 0.3 * coarse || fine < 1e-10, "axis {axis:?}: {coarse} to {fine}");
    }
}

/// Two grains in a row that closes on itself, pressed by the overlap `OVERLAP` at both contacts and spun in opposite senses
/// at `spin` (rad/s): they roll on each other without slip.
fn pressed_row(springs: SpringLaw, damping: f64, spin: f64, dt: f64) -> Engine {
    let law = ContactLaw::of(springs).with_rolling(resistance(damping));
    let length = 2.0 * (2.0 * RADIUS - OVERLAP);
    let cell = box_of(length, 20.0 * RADIUS, 20.0 * RADIUS);
    let x = vec![Vec3::zeros(), Vec3::x() * (0.5 * length)];
    let spins = vec![Vec3::y() * spin, Vec3::y() * -spin];
    let pair = Packing { law, spins, ..Packing::at_rest(cell, vec![RADIUS; 2], x) };
    taken_up(&pair, setting(0.5, dt))
}

const OVERLAP: f64 = 4e-8;
const SPRINGS: &[SpringLaw] = &SpringLaw::EXAMPLES;

fn spins(e: &Engine) -> [f64; 2] {
    let p = packing(e);
    assert!(p.contacts.iter().all(|c| c.tangential_force.norm() < 1e-9 * c.normal_force), "no slip");
    [p.spins[0].y, p.spins[1].y]
}

fn inertia() -> f64 {
    0.4 * GLASS.sphere_mass(RADIUS) * RADIUS * RADIUS
}

#[test]
fn beyond_the_limit_rolling_grains_slow_down_at_a_constant_rate() {
    for springs in SPRINGS.iter().copied() {
        let force = springs.normal_force(&GLASS, R_EFF, OVERLAP);
        // The torque μ F_n R* of each of two contacts.
        let deceleration = 2.0 * FRICTION * force * R_EFF / inertia();
        let dt = 1e-9;
        let spin = deceleration * 4e-4;
        let mut e = pressed_row(springs, 0.0, spin, dt);
        // The force has reached its limit by then.
        e.run(100_000).unwrap();
        let start = spins(&e)[0];
        e.run(100_000).unwrap();
        let end = spins(&e);
        assert!((end[0] + end[1]).abs() < 1e-9 * spin, "the spins stay opposite: {end:?}");
        let measured = (start - end[0]) / (1e5 * dt);
        assert!((measured / deceleration - 1.0).abs() < 1e-9, "{springs:?}: {measured} {deceleration}");
    }
}

#[test]
fn below_the_limit_rolling_grains_oscillate_as_a_damped_spring() {
    for springs in SPRINGS.iter().copied() {
        // Two contacts turn both grains: I dΩ/dt = −4 R*² (k ∫Ω dt + γ Ω), with Ω the relative spin.
        let omega = (4.0 * STIFFNESS * R_EFF * R_EFF / inertia()).sqrt();
        let ratio = 0.02;
        let damping = 2.0 * ratio * STIFFNESS / omega;
        let limit = FRICTION * springs.normal_force(&GLASS, R_EFF, OVERLAP);
        let spin = 0.1 * limit * omega / (2.0 * STIFFNESS * R_EFF);
        // Five periods. Dashpots act on velocities half a step old, so the steps are short.
        let damped = omega * (1.0 - ratio * ratio).sqrt();
        for (gamma, frequency, decay) in [(0.0, omega, 0.0), (damping, damped, ratio * omega)] {
            let dt = std::f64::consts::TAU / frequency / 20_000.0;
            let mut e = pressed_row(springs, gamma, spin, dt);
            let mut crossings = Vec::new();
            let (mut last, mut lowest) = (spins(&e)[0], 0.0f64);
            for step in 1..100_000 {
                e.step().unwrap();
                let now = spins(&e)[0];
                if last > 0.0 && now <= 0.0 {
                    crossings.push((f64::from(step) - now / (now - last)) * dt);
                }
                // The last half period.
                if step > 85_000 {
                    lowest = lowest.min(now);
                }
                last = now;
            }
            let periods = (crossings.len() - 1) as f64;
            let measured = std::f64::consts::TAU * periods / (crossings[crossings.len() - 1] - crossings[0]);
            assert!((measured / frequency - 1.0).abs() < 1e-5, "{springs:?}: {measured} {frequency}");
            let time = 4.5 * std::f64::consts::TAU / frequency;
            let expected = -spin * (-decay * time).exp();
            assert!((lowest / expected - 1.0).abs() < 2e-3, "{springs:?}: {lowest} {expected}");
        }
    }
}
