//! LAMMPS beside our engine, on the same packings.

use grainlab_core::contact::ContactLaw;
use grainlab_core::{Cell, Mat3, Material, Packing, Vec3};
use grainlab_dem::{Compute, EngineSettings, TimeStep};
use grainlab_experiment::{Dem, EngineFactory, ParticleEngine, Simulation};
use grainlab_lammps::Lammps;
use grainlab_scene::Scene;

/// 100 grains without friction, nearly at rest at 50 kPa.
fn pressed() -> Packing {
    let mut run = Simulation::new(Scene::parse(include_str!("pressed.toml")).unwrap()).unwrap();
    while let Some(request) = run.request() {
        run.advance(&grainlab_servo::control(&request.input).unwrap().rate).unwrap();
    }
    run.packing().unwrap()
}

fn started(factory: &dyn EngineFactory, packing: &Packing, settings: &EngineSettings) -> Box<dyn ParticleEngine> {
    let mut engine = factory.start(packing, settings, &[0.0; 6], &Compute::default()).unwrap();
    engine.begin_phase(settings).unwrap();
    engine
}

#[test]
fn measure() {
    let packing = pressed();
    for friction in [0.0, 0.3] { for damping in [0.0, 0.3] { for kick in [0.0, 1e-4] {
        let mut packing = packing.clone(); packing.time_step = 4e-8;
        for (n, v) in packing.velocities.iter_mut().enumerate() { *v += kick * Vec3::new((n % 3) as f64 - 1.0, (n % 5) as f64 - 2.0, (n % 7) as f64 - 3.0); }
        let settings = EngineSettings { friction, damping, skin: 1e-5, time_step: TimeStep::Fixed(4e-8), ..EngineSettings::default() };
        let run = |f: &dyn EngineFactory, n: u32| { let mut e = started(f, &packing, &settings); let r = e.run(n).unwrap(); (r.1, e.packing(Mat3::identity()).unwrap()) };
        for n in [1, 1000] {
        let (a, b) = (run(&Dem, n), run(&Lammps::default(), n));
        let (s, t) = (a.0.stress.tensor.matrix(), b.0.stress.tensor.matrix());
        let ft = |p: &Packing| p.contacts.iter().map(|c| c.tangential_force.norm()).sum::<f64>() / p.contacts.iter().map(|c| c.normal_force).sum::<f64>();
        let st = |p: &Packing| grainlab_core::stress::stress(p).tensor.matrix();
        println!("mu {friction} zeta {damping} kick {kick} n {n}: stress {:.3e}; from contacts {:.2e}; p {:.1} ft/fn {:.2e} speed {:.3e} {:.2e}, unbalanced {:.2e} {:.2e}", (s - t).norm() / s.norm(), (st(&a.1)-st(&b.1)).norm()/s.norm(), a.0.stress.tensor.mean(), ft(&a.1), a.0.speed, a.0.speed - b.0.speed, a.0.unbalanced, b.0.unbalanced);
        }
    }}}
}

#[test]
fn deform() {
    for seed in [0.0, 1e-4] {
    let packing = pressed();
    for (friction, damping) in [(0.0,0.0),(0.3,0.0),(0.0,0.3),(0.3,0.3)] { 
        for n in [250, 500, 1000, 2000, 4000] {
        let dt = 2e-5 / n as f64;
        let mut packing = Packing { time_step: dt, ..packing.clone() };
        packing.velocities.fill(Vec3::zeros());
        for (n, v) in packing.velocities.iter_mut().enumerate() { *v += seed * Vec3::new((n % 3) as f64 - 1.0, (n % 5) as f64 - 2.0, (n % 7) as f64 - 3.0); }
        let settings = EngineSettings { friction, damping, skin: 1e-5, time_step: TimeStep::Fixed(dt), ..EngineSettings::default() };
        let run = |f: &dyn EngineFactory| { let mut e = started(f, &packing, &settings); e.set_rate(&[-4.0, 2.0, -3.0, 1.0, -0.5, 2.0]).unwrap(); let mut r = e.run(n/10).unwrap(); for _ in 1..10 { r = e.run(n/10).unwrap(); } (r.1, e.packing(Mat3::identity()).unwrap()) };
        let (a, b) = (run(&Dem), run(&Lammps::default()));
        let (s, t) = (a.0.stress.tensor.matrix(), b.0.stress.tensor.matrix());
        let st = |p: &Packing| grainlab_core::stress::stress(p).tensor.matrix();
        let x = (0..100).map(|k| (a.1.positions[a.1.ids.iter().position(|i| *i == k).unwrap()] - b.1.positions[b.1.ids.iter().position(|i| *i == k).unwrap()]).norm()).fold(0.0, f64::max);
        println!("kick {seed} mu {friction} zeta {damping} n {n}: stress {:.3e}; from contacts {:.3e}; self-b {:.3e} positions {:.2e} p {:.1} {:.3}", (s - t).norm() / s.norm(), (st(&a.1)-st(&b.1)).norm()/s.norm(), (t-st(&b.1)).norm()/s.norm(), x, a.0.stress.tensor.mean(), s[(0,1)]/s[(0,0)]);
        }
    }}
}
