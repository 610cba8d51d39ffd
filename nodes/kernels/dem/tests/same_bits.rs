//! Results do not depend on instruction set, threads, or how steps are grouped.

use grainlab_core::contact::{ContactLaw, RollingResistance, SpringLaw, TangentialLaw};
use grainlab_core::{Contact, Packing, Vec3};
use grainlab_dem::{Engine, Simd};
use grainlab_engine::{Compute, EngineSettings, TimeStep};
use grainlab_testkit::engine::{self, RADIUS, bits, gas, packing};

/// Grains enough for several threads to have something to do: more than two of the parts that they work on.
const PARTS: u32 = 4500;

fn setting(friction: f64, tangential: TangentialLaw) -> EngineSettings {
    let time_step = TimeStep::FractionOfStable(0.5);
    EngineSettings { damping: 0.2, tangential, time_step, ..engine::setting(friction, 0.0) }
}

/// Returns the law of smooth grains with these springs and resistance to rolling.
fn rolling(springs: SpringLaw) -> ContactLaw {
    let resistance = RollingResistance { stiffness: 1e4, damping: 1e-3, friction: 0.1 };
    ContactLaw::of(springs).with_rolling(resistance)
}

/// A gas that is strained into contact; `unequal` mixes sizes.
fn start(grains: u32, law: ContactLaw, setting: EngineSettings, unequal: bool, compute: Compute) -> Engine {
    let gas = gas(&vec![RADIUS; grains as usize], 0.2, 7);
    let radius = |i: u32| if unequal && i.is_multiple_of(3) { 0.8 * RADIUS } else { RADIUS };
    let radii = (0..grains).map(radius).collect();
    let spins = gas.velocities.iter().map(|v| v.cross(&Vec3::x()) * 1e4).collect();
    let mut engine = Engine::from_packing(&Packing { law, radii, spins, ..gas }, setting).unwrap();
    engine.set_compute(compute);
    engine.set_rate(&[-900.0, -1100.0, -1000.0, 60.0, -50.0, 90.0]).unwrap();
    engine.sort_spatially();
    engine.initialise().unwrap();
    engine
}

fn end(mut engine: Engine, steps: u32) -> Vec<u64> {
    let compute = engine.compute().clone();
    compute.install(|| engine.run(steps)).unwrap();
    seen(&engine)
}

/// Every number of a packing with contacts, which roll where the law resists.
fn seen(engine: &Engine) -> Vec<u64> {
    let packing = packing(engine);
    assert!(packing.contacts.len() > 50, "{} contacts", packing.contacts.len());
    let rolled = packing.contacts.iter().filter(|c| c.rolling_force.norm() > 0.0).count();
    assert_eq!(rolled > 20, packing.law.rolling.is_some(), "{rolled} contacts with a rolling force");
    bits(&packing)
}

#[test]
fn every_instruction_set_gives_the_same_bits_in_every_feature_set() {
    assert!(
        Simd::available().len() > 1 || !cfg!(target_arch = "x86_64"),
        "nothing to compare on this processor"
    );
    let mut cases = Vec::new();
    for friction in [0.0, 0.3, f64::INFINITY] {
        for tangential in [TangentialLaw::Rescaled, TangentialLaw::Incremental] {
            cases.extend([false, true].map(|unequal| (ContactLaw::default(), friction, tangential, unequal)));
        }
    }
    cases.extend(SpringLaw::EXAMPLES.map(|law| (rolling(law), 0.3, TangentialLaw::Rescaled, true)));
    for (law, friction, tangential, unequal) in cases {
        // Small grains take longer to meet.
        let steps = if unequal { 6000 } else { 3000 };
        let run = |simd| {
            let setting = setting(friction, tangential);
            let mut engine = start(300, law, setting, unequal, Compute::default());
            engine.set_simd(simd);
            engine.initialise().unwrap();
            end(engine, steps)
        };
        let scalar = run(Simd::Scalar);
        for simd in Simd::available() {
            assert!(run(simd) == scalar, "{simd}, {law}, friction {friction}, {tangential:?}, {unequal}");
        }
    }
}

/// A gas that is held at a speed, strained into contact, then given friction, spins and another order in memory, by as
/// many threads as each leg of the way is told; everything seen along it.
fn journey(threads: &[usize], unequal: bool) -> Vec<u64> {
    let compute = |leg: usize| Compute::new(threads[leg % threads.len()]).unwrap();
    let gas = EngineSettings { thermostat_speed: Some(0.15), ..setting(0.0, TangentialLaw::Rescaled) };
    let law = if unequal { rolling(SpringLaw::HertzMindlin) } else { ContactLaw::default() };
    let mut engine = start(PARTS, law, gas, unequal, compute(0));
    let (mut seen, mut contacts) = (Vec::new(), 0);
    for leg in 0..12 {
        engine.set_compute(compute(leg));
        match leg {
            4 => engine.set_settings(setting(0.3, TangentialLaw::Rescaled)).unwrap(),
            6 => {
                let spins: Vec<Vec3> = (0..PARTS).map(|i| Vec3::y() * f64::from(i % 7)).collect();
                engine.set_spins(&spins).unwrap();
            }
            8 => engine.sort_spatially(),
            10 => engine.set_rate(&[-500.0, 0.0, 0.0, 0.0, 0.0, 100.0]).unwrap(),
            _ => {}
        }
        let steps = if leg % 3 == 0 { 1 } else { 211 };
        let pool = engine.compute().clone();
        let run = || engine.run_with_stress(steps, |s| seen.extend(s.voigt().map(f64::to_bits)));
        pool.install(run).unwrap();
        let look = engine.observables().unwrap();
        seen.extend(look.stress.tensor.voigt().iter().chain(&look.tangent).map(|v| v.to_bits()));
        seen.extend([look.unbalanced.to_bits(), engine.speed().to_bits()]);
        let packing = packing(&engine);
        seen.extend(bits(&packing));
        contacts = contacts.max(packing.contacts.len());
    }
    assert!(contacts > 50, "{contacts} contacts");
    seen
}

#[test]
fn threads_may_come_and_go_along_the_way() {
    for unequal in [false, true] {
        let alone = journey(&[1], unequal);
        for threads in [&[2][..], &[3], &[2, 1], &[1, 3, 2, 4]] {
            assert!(journey(threads, unequal) == alone, "{threads:?} threads, unequal: {unequal}");
        }
    }
}

#[test]
fn steps_one_by_one_and_steps_together_are_the_same() {
    let engine = || {
        start(300, ContactLaw::default(), setting(0.3, TangentialLaw::Rescaled), false, Compute::default())
    };
    let mut single = engine();
    for _ in 0..2500 {
        single.step().unwrap();
    }
    assert!(bits(&packing(&single)) == end(engine(), 2500));
}

#[test]
fn the_stress_measured_along_the_way_is_that_of_a_snapshot_where_nothing_is_damped() {
    let undamped = EngineSettings { damping: 0.0, ..setting(0.3, TangentialLaw::Rescaled) };
    let compute = |threads| Compute::new(threads).unwrap();
    let mut ends = Vec::new();
    for threads in [1, 2] {
        let mut engine = start(PARTS, ContactLaw::default(), undamped, true, compute(threads));
        let mut measured = Vec::new();
        engine.run_with_stress(3000, |s| measured.push(s.voigt())).unwrap();
        assert_eq!(measured.len(), 3000);
        let seen = engine.observables().unwrap().stress.tensor.voigt();
        let size = seen.iter().fold(0.0f64, |a, s| a.max(s.abs()));
        assert!(size > 0.0);
        for (a, b) in measured[2999].iter().zip(seen) {
            assert!((a - b).abs() < 1e-12 * size, "{a} {b}");
        }
        ends.push(measured);
    }
    assert!(ends[0] == ends[1], "whatever the threads");
}

#[test]
fn the_order_of_grains_in_memory_does_not_change_what_happens() {
    let short = |sorted: bool| {
        let setting = setting(0.3, TangentialLaw::Rescaled);
        let mut engine = start(PARTS, rolling(SpringLaw::HertzMindlin), setting, true, Compute::default());
        engine.run(1500).unwrap();
        if sorted {
            engine.sort_spatially();
            engine.initialise().unwrap();
        }
        engine.run(100).unwrap();
        let packing = packing(&engine);
        let place = |k: u32| (packing.ids[k as usize], packing.positions[k as usize]);
        let mut grains: Vec<_> = (0..PARTS).map(place).collect();
        grains.sort_by_key(|g| g.0);
        let ids = |c: &Contact| [c.i, c.j].map(|k| packing.ids[k as usize]);
        let mut forces: Vec<_> = packing.contacts.iter().map(|c| (ids(c), c.rolling_force)).collect();
        forces.iter_mut().for_each(|(ids, _)| ids.sort_unstable());
        forces.sort_by_key(|f| f.0);
        (grains, forces)
    };
    let (sorted, plain) = (short(true), short(false));
    for ((a, x), (b, y)) in sorted.0.iter().zip(&plain.0) {
        assert_eq!(a, b);
        assert!((x - y).norm() < 1e-12 * RADIUS, "grain {a}: {:e}", (x - y).norm());
    }
    let largest = plain.1.iter().map(|f| f.1.norm()).fold(0.0, f64::max);
    assert!(largest > 0.0 && sorted.1.len() == plain.1.len());
    for (a, b) in sorted.1.iter().zip(&plain.1) {
        assert!(a.0 == b.0 && (a.1 - b.1).norm() < 1e-8 * largest, "{a:?} {b:?}");
    }
}

#[test]
fn an_instruction_set_that_is_not_there_is_refused_by_name() {
    assert_eq!("avx512".parse::<Simd>(), Ok(Simd::Avx512));
    assert!("avx1024".parse::<Simd>().unwrap_err().to_string().contains("avx1024"));
    assert!(Compute::new(0).is_err());
    for simd in Simd::ALL {
        assert_eq!(simd.if_available().is_ok(), simd.is_available());
    }
}

#[test]
fn kicked_grains_go_on_as_if_they_had_been_that_fast() {
    let setting = setting(0.3, TangentialLaw::Incremental);
    for threads in [1, 3] {
        let compute = Compute::new(threads).unwrap();
        let mut kicked = start(PARTS, ContactLaw::default(), setting, false, compute);
        kicked.run(7).unwrap();
        let mut set = kicked.clone();
        let by = Vec3::new(1e-3, -2e-3, 5e-4);
        let hit = |grain: &usize| grain.is_multiple_of(5);
        kicked.add_velocities((0..PARTS as usize).filter(hit).map(|grain| (grain, by))).unwrap();
        let mut velocities = set.velocities();
        velocities.iter_mut().enumerate().filter(|(grain, _)| hit(grain)).for_each(|(_, v)| *v += by);
        set.set_velocities(&velocities).unwrap();
        kicked.run(20).unwrap();
        set.run(20).unwrap();
        assert_eq!(packing(&kicked), packing(&set));
        let mut without = start(PARTS, ContactLaw::default(), setting, false, Compute::default());
        without.run(27).unwrap();
        assert_ne!(kicked.velocities(), without.velocities());
    }
}
