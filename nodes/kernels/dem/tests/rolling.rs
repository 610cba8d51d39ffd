//! Rolling resistance: one contact by hand, two grains against closed form, and many that survive whatever happens to lists.

use grainlab_core::contact::{
    ContactKinematics, ContactLaw, HertzMindlin, RollingResistance, RollingSprings, SpringDashpotSlider,
    SpringLaw,
};
use grainlab_core::lanes::LaneVec3;
use grainlab_core::{Cell, Mat3, Material, Packing, Vec3};
use grainlab_dem::{Compute, Engine, EngineSettings, Simd, TimeStep, gas};
use nalgebra::{Rotation3, Unit};

const GLASS: Material = Material::GLASS;
const RADIUS: f64 = 1e-4;
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

#[test]
fn the_rolling_force_is_elastic_up_to_its_limit() {
    let mut pair = Rolled::new(0.0);
    let d = FRICTION / STIFFNESS / 1000.0;
    for k in 1..=2000 {
        let expected = (STIFFNESS * d * f64::from(k)).min(FRICTION);
        let f = pair.roll(d);
        assert!((f.x / expected - 1.0).abs() < 1e-10 && f.y == 0.0, "{f:?} {expected}");
    }
    let back = pair.roll(-d).x;
    assert!((back - (FRICTION - STIFFNESS * d)).abs() < 1e-12, "elastic again after reversal: {back}");
}

/// An independent writing of the update of LAMMPS's `rolling sds` (granular/rolling_sds, without dashpot): history in m, normal
/// from j to i, torque on i.
#[test]
fn without_dashpots_the_torque_is_that_of_lammps() {
    let mut pair = Rolled::new(0.0);
    let (nx, mut history) = (-Vec3::z(), Vec3::zeros());
    let mut random = 12345u64;
    let mut next = || {
        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (random >> 11) as f64 / (1u64 << 53) as f64 - 0.45
    };
    let mut slid = 0;
    for _ in 0..2000 {
        // No spin about the normal: LAMMPS does not turn the history with it.
        let mut spin = || Vec3::new(next(), next(), 0.0) * 4e6;
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
fn no_closed_cycle_of_rolling_creates_energy() {
    // Paths beyond the limit and within it; the work of the trapezium rule is exact for a linear spring.
    for size in [0.5, 3.0] {
        let (mut pair, mut work, mut last) = (Rolled::new(0.0), 0.0, Vec3::zeros());
        let leg = size * FRICTION / STIFFNESS / 500.0;
        for direction in [1.0, -1.0, -1.0, 1.0] {
            for _ in 0..500 {
                let f = pair.roll(direction * leg);
                work += 0.5 * (last + f).x * direction * leg;
                last = f;
            }
        }
        let energy = 0.5 * FRICTION * FRICTION / STIFFNESS;
        if size < 1.0 {
            assert!(work.abs() < 1e-9 * energy, "elastic: {work}");
        } else {
            assert!(work > energy, "dissipated: {work}");
        }
    }
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
    let cell = Cell::new(Mat3::from_diagonal(&Vec3::new(length, 20.0 * RADIUS, 20.0 * RADIUS))).unwrap();
    let x = [Vec3::zeros(), Vec3::x() * (0.5 * length)];
    let settings = EngineSettings {
        friction: 0.5,
        skin: 0.1 * RADIUS,
        time_step: TimeStep::Fixed(dt),
        ..EngineSettings::default()
    };
    let mut e = Engine::new(cell, GLASS, vec![RADIUS; 2], &x, settings).unwrap().with_law(law).unwrap();
    e.set_spins(&[Vec3::y() * spin, Vec3::y() * -spin]).unwrap();
    e.initialise().unwrap();
    e
}

const OVERLAP: f64 = 4e-8;
const SPRINGS: &[SpringLaw] = &SpringLaw::EXAMPLES;

fn spins(e: &Engine) -> [f64; 2] {
    let p = e.packing(Mat3::identity());
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

const GRAINS: u32 = 4500;

/// Grains of two sizes that are strained into contact while they spin.
fn start(law: SpringLaw, grains: u32, compute: Compute) -> Engine {
    let law = ContactLaw::of(law).with_rolling(RollingResistance { damping: 1e-3, ..resistance(0.0) });
    let settings = EngineSettings {
        friction: 0.3,
        damping: 0.2,
        skin: 0.1 * RADIUS,
        time_step: TimeStep::FractionOfStable(0.5),
        ..EngineSettings::default()
    };
    let gas = gas::random_sequential_addition(grains, 2.0 * RADIUS, 0.35, 0.2, 7).unwrap();
    let radii = (0..grains).map(|i| if i % 3 == 0 { 0.9 * RADIUS } else { RADIUS }).collect();
    let mut e = Engine::new(gas.cell, GLASS, radii, &gas.positions, settings).unwrap().with_law(law).unwrap();
    e.set_compute(compute);
    e.set_velocities(&gas.velocities).unwrap();
    e.set_spins(&gas.velocities.iter().map(|v| v.cross(&Vec3::x()) * 1e4).collect::<Vec<_>>()).unwrap();
    e.set_rate(&[-900.0, -1100.0, -1000.0, 60.0, -50.0, 90.0]).unwrap();
    e.sort_spatially();
    e.initialise().unwrap();
    e
}

fn seen(e: &Engine) -> Packing {
    let p = e.packing(Mat3::identity());
    let rolled = p.contacts.iter().filter(|c| c.rolling_force.norm() > 0.0).count();
    assert!(rolled > 20, "{rolled} contacts with a rolling force");
    p
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    for law in SPRINGS.iter().copied() {
        let run = |simd| {
            let mut e = start(law, 300, Compute::new(simd, 1).unwrap());
            e.run(6000).unwrap();
            seen(&e)
        };
        let scalar = run(Simd::Scalar);
        for simd in Simd::available() {
            assert!(run(simd) == scalar, "{simd}, {law:?}");
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let run = |threads: usize| {
        let compute = Compute::new(Simd::best(), threads).unwrap();
        let mut e = start(SpringLaw::HertzMindlin, GRAINS, compute.clone());
        compute.install(|| e.run(3000)).unwrap();
        seen(&e)
    };
    let one = run(1);
    for threads in [2, 3] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

/// Expected: the same bits when a run goes on from a checkpoint, from a packing, and with its lists found anew.
#[test]
fn a_run_that_is_interrupted_goes_on_to_the_same_bits() {
    let mut e = start(SpringLaw::HertzMindlin, 300, Compute::default());
    e.run(6000).unwrap();
    let (checkpoint, packing, rate) = (e.checkpoint(), seen(&e), e.rate());
    let mut from_packing = Engine::from_packing(&packing, *e.settings()).unwrap();
    from_packing.set_rate(&rate).unwrap();
    e.run(500).unwrap();
    let expected = seen(&e);
    e.restore(checkpoint).unwrap();
    for mut again in [e, from_packing] {
        again.initialise().unwrap();
        assert!(again.packing(Mat3::identity()) == packing, "nothing is lost");
        again.run(500).unwrap();
        assert!(seen(&again) == expected, "the same bits");
    }
}

#[test]
fn the_order_of_grains_in_memory_changes_no_rolling_force() {
    let run = |sorted: bool| {
        let mut e = start(SpringLaw::HertzMindlin, 300, Compute::default());
        e.run(6000).unwrap();
        if sorted {
            e.sort_spatially();
            e.initialise().unwrap();
        }
        e.run(100).unwrap();
        let p = seen(&e);
        let mut forces: Vec<(u32, u32, Vec3)> = Vec::new();
        for c in &p.contacts {
            let (i, j) = (p.ids[c.i as usize], p.ids[c.j as usize]);
            forces.push((i.min(j), i.max(j), c.rolling_force));
        }
        forces.sort_by_key(|f| (f.0, f.1));
        forces
    };
    let (sorted, plain) = (run(true), run(false));
    let largest = plain.iter().map(|f| f.2.norm()).fold(0.0, f64::max);
    assert_eq!(sorted.len(), plain.len());
    for (a, b) in sorted.iter().zip(&plain) {
        assert!((a.0, a.1) == (b.0, b.1) && (a.2 - b.2).norm() < 1e-8 * largest, "{a:?} {b:?}");
    }
}

#[test]
fn without_friction_nothing_rolls() {
    let mut e = start(SpringLaw::HertzMindlin, 300, Compute::default());
    e.run(6000).unwrap();
    seen(&e);
    e.set_settings(EngineSettings { friction: 0.0, ..*e.settings() }).unwrap();
    e.run(10).unwrap();
    let p = e.packing(Mat3::identity());
    assert!(p.contacts.iter().all(|c| c.rolling_force == Vec3::zeros()));
    assert!(p.spins.iter().all(|w| *w == Vec3::zeros()));
}
