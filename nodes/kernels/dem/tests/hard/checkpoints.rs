//! Run 2N is run N, save, load, run N, bit for bit; and looking changes nothing.

use grainlab_core::contact::{RollingResistance, TangentialLaw};
use grainlab_core::{Packing, ServoLaw};
use grainlab_dem::Engine;
use grainlab_engine::{EngineSettings, Features, TimeStep};
use grainlab_testkit::Random;
use grainlab_testkit::engine::*;

const PERIOD: usize = 7;
const RATE: [f64; 6] = [-30.0, -20.0, -25.0, 4.0, -6.0, 5.0];

/// Source of the strain rate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drive {
    Strained,
    Servoed,
}

fn settings() -> Vec<EngineSettings> {
    let mut all = Vec::new();
    for friction in [0.0, 0.3, f64::INFINITY] {
        for tangential in [TangentialLaw::Rescaled, TangentialLaw::Incremental] {
            let mut s = setting(friction, 0.0);
            (s.tangential, s.time_step) = (tangential, TimeStep::FractionOfStable(0.8));
            (s.damping, s.drag, s.spin_drag) = (0.2, 3e3, 1e3);
            // Lists are renewed at other steps in the resumed run than in the one that went on.
            s.skin = 2e-3 * RADIUS;
            all.push(s);
        }
    }
    all
}

/// A packing on its way: pressed on from a loose one, so that contacts come, go and slide.
fn start(p: &Packing, s: EngineSettings) -> Engine {
    let mut e = Engine::from_packing(p, s).unwrap();
    let mut random = Random::new(1);
    e.set_velocities(&(0..p.grains()).map(|_| random.vector(0.02)).collect::<Vec<_>>()).unwrap();
    e.set_rate(&RATE).unwrap();
    e.initialise().unwrap();
    e
}

/// Steps to step number `end`, answering the servo at each control period.
fn run(e: &mut Engine, drive: Drive, origin: u64, end: u64, look: bool) {
    while e.steps() < end {
        if drive == Drive::Servoed && (e.steps() - origin).is_multiple_of(PERIOD as u64) {
            let law = ServoLaw::Scaled { response_time: 3e-6 };
            let rate = servo(e, isotropic(2e5), law, 100.0, PERIOD as u32).rate;
            e.set_rate(&rate).unwrap();
        }
        e.step().unwrap();
        if look {
            let _ = (e.observables().unwrap(), packing(e), e.speed(), e.clone());
        }
    }
}

/// The saved part of a run: the packing, and the rate that its forces arose under.
fn reloaded(e: &Engine, s: EngineSettings) -> Engine {
    let (saved, rate) = (packing(e).validated().unwrap(), e.rate());
    let mut loaded = Engine::from_packing(&saved, s).unwrap();
    loaded.set_rate(&rate).unwrap();
    loaded.initialise().unwrap();
    loaded
}

/// Expected: equal in every bit after another N steps, for N around the control period and the steps at which the time
/// step is looked at anew.
#[test]
fn a_state_saved_and_loaded_goes_on_bit_for_bit() {
    let plain = Sample::Loose.packing();
    let law = plain.law.with_rolling(RollingResistance { stiffness: 1e4, damping: 1e-3, friction: 0.1 });
    let rolling = Packing { law, ..plain.clone() };
    let (mut contacts, mut sliding) = (0, 0);
    for s in settings() {
        let loose = if s.tangential == TangentialLaw::Incremental { &rolling } else { &plain };
        for drive in [Drive::Strained, Drive::Servoed] {
            let mut e = start(loose, s);
            let origin = e.steps();
            for n in [1u64, 6, 7, 50, 199, 200, 201, 1000] {
                let (at, end) = (origin + n, origin + 2 * n);
                let mut whole = start(loose, s);
                run(&mut whole, drive, origin, end, false);
                run(&mut e, drive, origin, at, false);
                let mut second = reloaded(&e, s);
                assert_eq!(bits(&packing(&second)), bits(&packing(&e)), "loading changes nothing");
                run(&mut second, drive, origin, end, false);
                let what = format!("{:?} {:?} {drive:?}, N = {n}", s.features(), s.tangential);
                assert!(bits(&packing(&second)) == bits(&packing(&whole)), "{what}");
                assert_eq!(second.observables(), whole.observables(), "{what}");
                // Back to a checkpoint.
                let (mut third, checkpoint) = (e.clone(), e.checkpoint());
                run(&mut third, drive, origin, at + 3, false);
                third.restore(checkpoint).unwrap();
                third.initialise().unwrap();
                run(&mut third, drive, origin, end, false);
                assert!(bits(&packing(&third)) == bits(&packing(&whole)), "back to a checkpoint: {what}");
            }
            let p = packing(&e);
            contacts += p.contacts.len();
            if s.features() == Features::Sliding {
                let slides = |c: &&grainlab_core::Contact| c.tangential_force.norm() > 0.299 * c.normal_force;
                sliding += p.contacts.iter().filter(slides).count();
            }
        }
    }
    assert!(contacts > 400 && sliding > 20, "{contacts} contacts, {sliding} slide");
}

/// Expected: a run that is looked at after every step is the run that is not (LAMMPS, PR 1631: it was not).
#[test]
fn looking_at_every_step_changes_nothing() {
    let loose = Sample::Loose.packing();
    for s in settings() {
        for drive in [Drive::Strained, Drive::Servoed] {
            let (mut plain, mut watched) = (start(&loose, s), start(&loose, s));
            let origin = plain.steps();
            run(&mut plain, drive, origin, origin + 700, false);
            run(&mut watched, drive, origin, origin + 700, true);
            assert!(bits(&packing(&plain)) == bits(&packing(&watched)), "{:?} {drive:?}", s.features());
        }
    }
}

/// Expected: in a gas the thermostat and the time step that goes with it are part of the state, too.
#[test]
fn an_agitated_gas_saved_and_loaded_goes_on_bit_for_bit() {
    let gas = gas(&[RADIUS; 40], 0.5, 9);
    let mut s = setting(0.0, 0.0);
    (s.time_step, s.thermostat_speed, s.damping) = (TimeStep::FractionOfStable(0.8), Some(0.5), 0.002);
    let begin = || {
        let mut e = taken_up(&gas, s);
        e.set_rate(&[-60.0, -60.0, -60.0, 0.0, 0.0, 0.0]).unwrap();
        e
    };
    for n in [1, 333, 4000] {
        let mut whole = begin();
        steps(&mut whole, 2 * n);
        let mut first = begin();
        steps(&mut first, n);
        let mut second = reloaded(&first, s);
        steps(&mut second, n);
        assert!(bits(&packing(&second)) == bits(&packing(&whole)), "N = {n}");
    }
}
