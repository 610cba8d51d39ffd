//! Tests that every engine passes: the contract of [`ParticleEngine`], claim by claim. A crate with an engine of its own has this
//! one among its dev-dependencies:
//!
//! ```
//! use grainlab_dem::Dem;
//! use grainlab_verify::conformance::CLAIMS;
//! for claim in CLAIMS {
//!     claim.check(&Dem::default()).unwrap();
//! }
//! ```

use grainlab_core::contact::ContactLaw;
use grainlab_core::{Cell, Mat3, Material, Packing, SymTensor, Vec3};
use grainlab_engine::{Compute, EngineError, EngineFactory, EngineSettings, Observables, ParticleEngine};

/// A point of the contract.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// The claim, as the name of a test.
    pub name: &'static str,
    test: fn(&Bench<'_>) -> Result<(), String>,
}

impl Claim {
    /// Tests the claim on engines of `factory`.
    ///
    /// # Errors
    /// The claim, and what was found.
    pub fn check(&self, factory: &dyn EngineFactory) -> Result<(), String> {
        (self.test)(&Bench { factory }).map_err(|found| format!("{}: {found}", self.name))
    }
}

/// Every claim of the contract.
pub const CLAIMS: [Claim; 16] = [
    Claim { name: "an_engine_has_the_grains_of_its_packing", test: has_the_grains },
    Claim { name: "steps_and_time_count_from_those_of_the_packing", test: counts_steps },
    Claim { name: "the_cell_follows_the_strain_rate", test: strains },
    Claim { name: "grains_follow_the_strain_of_the_cell", test: follows },
    Claim { name: "grains_that_are_pressed_together_have_positive_pressure", test: has_pressure },
    Claim { name: "the_observables_are_those_of_the_packing", test: observes_the_packing },
    Claim { name: "contacts_have_the_forces_of_the_law_of_the_packing", test: has_the_law },
    Claim { name: "a_grain_is_accelerated_along_the_net_force_on_it", test: accelerates },
    Claim { name: "overlapping_grains_are_pushed_apart_and_momentum_is_kept", test: repels },
    Claim { name: "drag_slows_grains_down", test: drags },
    Claim { name: "friction_and_damping_act_or_are_refused", test: acts },
    Claim { name: "the_same_calls_give_the_same_bits", test: repeats },
    Claim { name: "observing_changes_nothing", test: observing_is_free },
    Claim { name: "an_engine_that_starts_from_a_packing_continues_the_run", test: continues },
    Claim { name: "invalid_input_is_refused_and_changes_nothing", test: refuses },
    Claim { name: "a_saved_state_is_returned_to_and_a_fork_is_independent", test: saves_and_forks },
];

/// Radius of the grains, m.
const RADIUS: f64 = 1e-4;
/// Overlap of neighbours, m: some 400 kPa.
const OVERLAP: f64 = 5e-8;

struct Bench<'a> {
    factory: &'a dyn EngineFactory,
}

impl Bench<'_> {
    fn start(&self, packing: &Packing, settings: &EngineSettings) -> Result<Box<dyn ParticleEngine>, String> {
        let engine = self.try_start(packing, settings).map_err(|e| e.to_string())?;
        if engine.settings() != settings {
            return Err(format!("its settings are {:?}", engine.settings()));
        }
        Ok(engine)
    }

    /// Started, and in a phase of its own.
    fn ready(&self, packing: &Packing) -> Result<Box<dyn ParticleEngine>, String> {
        let mut engine = self.start(packing, &settings())?;
        engine.begin_phase(&settings()).map_err(|e| e.to_string())?;
        Ok(engine)
    }

    fn try_start(
        &self,
        packing: &Packing,
        settings: &EngineSettings,
    ) -> Result<Box<dyn ParticleEngine>, EngineError> {
        self.factory.start(packing, settings, &[0.0; 6], &Compute::default())
    }
}

fn settings() -> EngineSettings {
    EngineSettings { skin: 0.1 * RADIUS, ..EngineSettings::default() }
}

/// A simple cubic lattice of 4 x 4 x 4 grains at rest.
fn lattice() -> Packing {
    let (count, edge) = (4, 2.0 * RADIUS - OVERLAP);
    let place = |n: usize| {
        let (x, y, z) = (n % count, n / count % count, n / (count * count));
        edge * Vec3::new(x as f64 + 0.5, y as f64 + 0.5, z as f64 + 0.5)
    };
    let n = count * count * count;
    Packing {
        step: 40,
        time: 2.5e-3,
        ids: (0..n as u32).map(|i| 100 + i).collect(),
        ..Packing::at_rest(
            Cell::cube(count as f64 * edge).expect("a cube with a volume"),
            vec![RADIUS; n],
            (0..n).map(place).collect(),
        )
    }
}

/// The lattice with one grain moved along x, so that it presses on one neighbour more than on the other.
fn uneven() -> Packing {
    let mut packing = lattice();
    packing.positions[21].x += 0.5 * OVERLAP;
    packing
}

/// Unequal grains of another material in a sheared cell: no stress component is zero, none is another.
fn crooked() -> Packing {
    let mut packing = lattice();
    let shear = Mat3::new(1.0, 3e-3, -2e-3, 0.0, 1.0, 4e-3, 0.0, 0.0, 1.0);
    packing.cell = packing.cell.deformed(&shear).expect("a cell with a volume");
    packing.positions.iter_mut().for_each(|p| *p = shear * *p);
    packing.radii.iter_mut().enumerate().for_each(|(n, r)| *r += (7 * n % 5) as f64 * 0.1 * OVERLAP);
    packing.material = Material { shear_modulus: 5e9, poisson_ratio: 0.35, density: 1400.0 };
    packing
}

/// Net contact force on each grain, N.
fn net_forces(packing: &Packing) -> Vec<Vec3> {
    let mut net = vec![Vec3::zeros(); packing.grains()];
    for c in &packing.contacts {
        let on_i = c.tangential_force - c.normal * c.normal_force;
        net[c.i as usize] += on_i;
        net[c.j as usize] -= on_i;
    }
    net
}

fn state(engine: &dyn ParticleEngine) -> Result<Packing, String> {
    engine.packing(Mat3::identity()).map_err(|e| e.to_string())
}

fn run(engine: &mut dyn ParticleEngine, steps: u32) -> Result<(Mat3, Observables), String> {
    engine.run(steps).map_err(|e| e.to_string())
}

fn holds(holds: bool, found: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(found()) }
}

fn close(what: &str, found: f64, expected: f64, tolerance: f64) -> Result<(), String> {
    holds((found - expected).abs() <= tolerance * expected.abs(), || {
        format!("{what} is {found:e}, expected {expected:e}")
    })
}

fn has_the_grains(bench: &Bench<'_>) -> Result<(), String> {
    let given = lattice();
    let found = state(&*bench.start(&given, &settings())?)?;
    let id = |n: usize| (0..found.grains()).find(|m| found.ids[*m] == given.ids[n]);
    for n in 0..given.grains() {
        let m = id(n).ok_or_else(|| format!("grain {} is missing", given.ids[n]))?;
        let apart = found.cell.inverse() * (found.positions[m] - given.positions[n]);
        let apart = (found.cell.matrix() * apart.map(|s| s - s.round())).norm();
        holds(found.radii[m] == given.radii[n] && apart < 1e-12 * RADIUS, || {
            format!("grain {} is {apart:e} m from its place", given.ids[n])
        })?;
    }
    holds(found.grains() == given.grains(), || format!("{} grains", found.grains()))?;
    holds(found.material == given.material && found.law == given.law, || "another material".to_owned())?;
    close("the volume", found.cell.volume(), given.cell.volume(), 1e-12)
}

fn counts_steps(bench: &Bench<'_>) -> Result<(), String> {
    let mut engine = bench.ready(&lattice())?;
    holds((engine.steps(), engine.time()) == (40, 2.5e-3), || {
        format!("begins at step {}, {:e} s", engine.steps(), engine.time())
    })?;
    let step = engine.time_step();
    holds(step > 0.0 && step < 1e-6, || format!("a time step of {step:e} s for grains of {RADIUS} m"))?;
    run(&mut *engine, 7)?;
    holds(engine.steps() == 47, || format!("{} steps after 7", engine.steps() - 40))?;
    close("the time of 7 steps", engine.time() - 2.5e-3, 7.0 * step, 1e-6)?;
    let packing = state(&*engine)?;
    holds((packing.step, packing.time) == (47, engine.time()), || "the packing has another step".to_owned())
}

fn strains(bench: &Bench<'_>) -> Result<(), String> {
    let mut engine = bench.ready(&lattice())?;
    let rate = [-3.0, 1.0, 0.5, 0.4, 0.2, -0.3];
    engine.set_rate(&rate).map_err(|e| e.to_string())?;
    holds(engine.rate() == rate, || format!("the strain rate is {:?}", engine.rate()))?;
    let (before, time) = (state(&*engine)?.cell, engine.time());
    let (deformation, seen) = run(&mut *engine, 50)?;
    let interval = engine.time() - time;
    let [xx, yy, zz, yz, xz, xy] = rate;
    let step = Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) * interval;
    let expected = Mat3::identity() + step + 0.5 * step * step;
    let off = (deformation - expected).norm() / step.norm();
    holds(off < 1e-4, || format!("the deformation is off by {off:e} of the strain"))?;
    close("the volume", seen.cell.volume(), deformation.determinant() * before.volume(), 1e-9)
}

fn follows(bench: &Bench<'_>) -> Result<(), String> {
    let mut engine = bench.ready(&lattice())?;
    engine.set_rate(&[-900.0, 300.0, 150.0, 12.0, 120.0, -600.0]).map_err(|e| e.to_string())?;
    let before = state(&*engine)?;
    let (nothing, _) = run(&mut *engine, 0)?;
    holds(nothing == Mat3::identity() && state(&*engine)? == before, || "no step is one".to_owned())?;
    let mut parts = bench.ready(&lattice())?;
    parts.set_rate(&engine.rate()).map_err(|e| e.to_string())?;
    run(&mut *engine, 60)?;
    for steps in [1, 2, 57] {
        run(&mut *parts, steps)?;
    }
    let (after, in_parts) = (state(&*engine)?, state(&*parts)?);
    for (n, id) in before.ids.iter().enumerate() {
        let of = |p: &Packing| (0..p.grains()).find(|m| p.ids[*m] == *id).unwrap_or_default();
        let place = |p: &Packing| p.cell.inverse() * p.positions[of(p)];
        let moved = (place(&after) - before.cell.inverse() * before.positions[n]).map(|s| s - s.round());
        // By symmetry a lattice is strained as its cell.
        holds(moved.amax() < 1e-6, || {
            format!("grain {id} leaves its place in the cell by {:e}", moved.amax())
        })?;
        let apart = (after.positions[of(&after)] - in_parts.positions[of(&in_parts)]).norm();
        holds(apart < 1e-9 * RADIUS, || format!("60 steps at once differ from 1, 2 and 57 by {apart:e} m"))?;
    }
    Ok(())
}

fn has_pressure(bench: &Bench<'_>) -> Result<(), String> {
    let seen = bench.ready(&lattice())?.observables().map_err(|e| e.to_string())?;
    // Hertz: F = 4/3 E* sqrt(R*) overlap^(3/2), one force on each face of the cube of a grain.
    let glass = Material::GLASS;
    let modulus = glass.shear_modulus / (1.0 - glass.poisson_ratio);
    let force = 4.0 / 3.0 * modulus * (0.5 * RADIUS).sqrt() * OVERLAP.powf(1.5);
    let expected = force / (2.0 * RADIUS - OVERLAP).powi(2);
    for (found, name) in seen.stress.tensor.voigt().into_iter().zip(SymTensor::COMPONENTS).take(3) {
        close(&format!("the stress {name}"), found, expected, 1e-6)?;
    }
    let shear = seen.stress.tensor.yz.abs() + seen.stress.tensor.xz.abs() + seen.stress.tensor.xy.abs();
    holds(shear < 1e-9 * expected, || format!("a shear stress of {shear:e} Pa in a lattice"))?;
    holds(seen.contacts == 192, || format!("{} contacts, 192 expected", seen.contacts))?;
    holds(seen.unbalanced < 1e-6, || format!("an unbalanced force of {:e} in a lattice", seen.unbalanced))
}

fn observes_the_packing(bench: &Bench<'_>) -> Result<(), String> {
    let mut engine = bench.ready(&crooked())?;
    let (_, seen) = run(&mut *engine, 20)?;
    let deformation = Mat3::new(1.0, 0.1, 0.0, 0.2, 0.9, 0.0, 0.0, 0.3, 1.1);
    let packing = engine.packing(deformation).map_err(|e| e.to_string())?;
    holds(packing.deformation == deformation, || "another deformation".to_owned())?;
    let stress = grainlab_core::stress::stress(&packing).tensor.voigt();
    for ((found, expected), name) in
        seen.stress.tensor.voigt().into_iter().zip(stress).zip(SymTensor::COMPONENTS)
    {
        close(&format!("the stress {name}"), found, expected, 1e-9)?;
    }
    let net: f64 = net_forces(&packing).iter().map(|f| f.norm()).sum();
    let forces: f64 = packing.contacts.iter().map(|c| c.normal_force).sum();
    let unbalanced = net / packing.grains() as f64 / (forces / packing.contacts.len() as f64);
    // Another program may know the mean force from its stress alone.
    close("the unbalanced force", seen.unbalanced, unbalanced, engine.program().map_or(1e-6, |_| 1e-4))?;
    holds(seen.contacts as usize == packing.contacts.len(), || {
        format!("{} contacts, {} in the packing", seen.contacts, packing.contacts.len())
    })?;
    holds(seen.cell == packing.cell, || "another cell".to_owned())?;
    let squares: f64 = packing.velocities.iter().map(|v| v.norm_squared()).sum();
    close("the speed", seen.speed, (squares / packing.grains() as f64).sqrt(), 1e-9)
}

fn has_the_law(bench: &Bench<'_>) -> Result<(), String> {
    for law in ContactLaw::examples() {
        let given = Packing { law, ..crooked() };
        // A law that the engine does not have is refused.
        let Ok(mut engine) = bench.try_start(&given, &settings()) else { continue };
        engine.begin_phase(&settings()).map_err(|e| e.to_string())?;
        let packing = state(&*engine)?;
        let off = packing.law_difference();
        holds(packing.law == law && off < 1e-6, || format!("forces are off those of {law:?} by {off:e}"))?;
        packing.check().and_then(|()| packing.check_consistency()).map_err(|e| e.to_string())?;
    }
    Ok(())
}

fn accelerates(bench: &Bench<'_>) -> Result<(), String> {
    let mut given = crooked();
    given.positions[21] += 0.3 * OVERLAP * Vec3::new(1.0, -0.7, 0.4);
    let mut engine = bench.ready(&given)?;
    let before = state(&*engine)?;
    run(&mut *engine, 1)?;
    let after = state(&*engine)?;
    let of = |p: &Packing| (0..p.grains()).find(|n| p.ids[*n] == given.ids[21]).unwrap_or_default();
    let force = net_forces(&before)[of(&before)];
    let gained = after.velocities[of(&after)] - before.velocities[of(&before)];
    let expected = force / given.material.sphere_mass(given.radii[21]) * engine.time_step();
    // Velocities may be half a step behind.
    let share = gained.norm() / expected.norm();
    let along = gained.normalize().dot(&expected.normalize());
    holds((0.45..1.05).contains(&share) && along > 0.999, || {
        format!("a force gives {share:.3} of its impulse in a step, and cos {along:.4} of its direction")
    })
}

fn acts(bench: &Bench<'_>) -> Result<(), String> {
    let mut engine = bench.ready(&lattice())?;
    if engine.begin_phase(&EngineSettings { friction: 0.3, ..settings() }).is_ok() {
        engine.set_rate(&[0.0, 0.0, 0.0, 0.0, 10.0, 0.0]).map_err(|e| e.to_string())?;
        run(&mut *engine, 50)?;
        let slip = state(&*engine)?.contacts.iter().any(|c| c.tangential_force != Vec3::zeros());
        holds(slip, || "friction is taken, and no contact has a tangential force".to_owned())?;
    }
    let speed = |damping: f64| {
        let mut engine = bench.ready(&uneven())?;
        if engine.begin_phase(&EngineSettings { damping, ..settings() }).is_err() {
            return Ok(None);
        }
        (0..20).try_fold(0.0, |sum, _| Ok::<_, String>(sum + run(&mut *engine, 10)?.1.speed)).map(Some)
    };
    let Some((free, damped)) = speed(0.0)?.zip(speed(0.5)?) else { return Ok(()) };
    holds(damped < 0.9 * free, || format!("damping is taken, and speeds are {damped:e} to {free:e} m/s"))
}

fn repels(bench: &Bench<'_>) -> Result<(), String> {
    let mut engine = bench.ready(&uneven())?;
    run(&mut *engine, 5)?;
    let packing = state(&*engine)?;
    let at = |id: u32| (0..packing.grains()).find(|n| packing.ids[*n] == id).unwrap_or_default();
    let moved = packing.velocities[at(121)].x;
    holds(moved < 0.0, || format!("a grain that is pressed towards -x moves at {moved:e} m/s"))?;
    let momentum: Vec3 = packing.velocities.iter().sum();
    holds(momentum.norm() < 1e-9 * moved.abs(), || format!("velocities sum to {:e} m/s", momentum.norm()))
}

fn drags(bench: &Bench<'_>) -> Result<(), String> {
    let mut packing = lattice();
    packing.velocities = vec![Vec3::new(0.0, 1e-3, 0.0); packing.grains()];
    let mut engine = bench.ready(&packing)?;
    let free = run(&mut *engine, 10)?.1.speed;
    close("the speed without drag", free, 1e-3, 1e-9)?;
    let drag = 1e6;
    engine.begin_phase(&EngineSettings { drag, ..settings() }).map_err(|e| e.to_string())?;
    let time = engine.time();
    let slower = run(&mut *engine, 10)?.1.speed;
    close("the logarithm of the slowing", (free / slower).ln(), drag * (engine.time() - time), 0.05)
}

fn repeats(bench: &Bench<'_>) -> Result<(), String> {
    let once = || {
        let mut engine = bench.ready(&uneven())?;
        engine.set_rate(&[-2.0, 0.0, 0.0, 0.0, 0.0, 0.1]).map_err(|e| e.to_string())?;
        let seen = run(&mut *engine, 100)?;
        Ok::<_, String>((seen, state(&*engine)?, engine.is_repeatable()))
    };
    let ((first, left, is_repeatable), (second, right, _)) = (once()?, once()?);
    if is_repeatable {
        return holds((first, left) == (second, right), || "two runs differ".to_owned());
    }
    same_but_for_rounding(&left, &right)
}

fn same_but_for_rounding(left: &Packing, right: &Packing) -> Result<(), String> {
    let largest = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| (a - b).amax()).fold(0.0, f64::max);
    let speed = left.velocities.iter().map(|v| v.amax()).fold(0.0, f64::max);
    let off = largest(&left.velocities, &right.velocities) / speed;
    holds(left.ids == right.ids && off < 1e-8, || format!("velocities of two runs differ by {off:e}"))
}

fn observing_is_free(bench: &Bench<'_>) -> Result<(), String> {
    let (mut plain, mut watched) = (bench.ready(&uneven())?, bench.ready(&uneven())?);
    for _ in 0..5 {
        run(&mut *plain, 10)?;
        watched.observables().map_err(|e| e.to_string())?;
        let _ = (state(&*watched)?, watched.energy(), watched.left_out());
        run(&mut *watched, 10)?;
    }
    let (left, right) = (state(&*plain)?, state(&*watched)?);
    if plain.program().is_none() && plain.is_repeatable() {
        return holds(left == right, || "the observed run differs".to_owned());
    }
    same_but_for_rounding(&left, &right)
}

fn continues(bench: &Bench<'_>) -> Result<(), String> {
    let mut first = bench.ready(&uneven())?;
    run(&mut *first, 50)?;
    let mut second = bench.start(&state(&*first)?, &settings())?;
    let (found, expected) = (run(&mut *second, 50)?.1, run(&mut *first, 50)?.1);
    holds(second.steps() == first.steps(), || format!("step {} and {}", second.steps(), first.steps()))?;
    close("the stress xx", found.stress.tensor.xx, expected.stress.tensor.xx, 1e-9)?;
    close("the speed", found.speed, expected.speed, 1e-6)
}

fn refuses(bench: &Bench<'_>) -> Result<(), String> {
    let refused = |what: &str, packing: &Packing, settings: &EngineSettings| {
        let started = bench.try_start(packing, settings).and_then(|engine| engine.observables());
        holds(started.is_err(), || format!("{what} is taken"))
    };
    let mut engine = bench.ready(&lattice())?;
    let before = state(&*engine)?;
    holds(engine.set_rate(&[0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0]).is_err(), || {
        "a rate of NaN is taken".to_owned()
    })?;
    let negative = EngineSettings { drag: -1.0, ..settings() };
    holds(engine.begin_phase(&negative).is_err(), || "a negative drag is taken".to_owned())?;
    holds(engine.rate() == [0.0; 6] && engine.settings() == &settings(), || {
        "a refusal changed it".to_owned()
    })?;
    holds(state(&*engine)? == before, || "a refusal changed the state".to_owned())?;
    refused("a negative drag", &lattice(), &negative)?;
    let mut packing = lattice();
    packing.positions[3].y = f64::NAN;
    refused("a position of NaN", &packing, &settings())?;
    let mut packing = lattice();
    packing.positions[5] = packing.positions[4] + Vec3::new(0.1 * RADIUS, 0.0, 0.0);
    refused("an overlap of nearly a diameter", &packing, &settings())
}

fn saves_and_forks(bench: &Bench<'_>) -> Result<(), String> {
    let mut engine = bench.ready(&uneven())?;
    run(&mut *engine, 20)?;
    let here = state(&*engine)?;
    holds(!engine.restore(), || "returns to a state that was not kept".to_owned())?;
    if engine.save() {
        run(&mut *engine, 30)?;
        holds(engine.restore(), || "does not return".to_owned())?;
        holds(state(&*engine)? == here, || "returns to another state".to_owned())?;
    }
    let Some(mut fork) = engine.fork() else { return Ok(()) };
    run(&mut *fork, 30)?;
    holds(state(&*engine)? == here, || "a fork moves its origin".to_owned())?;
    run(&mut *engine, 30)?;
    let (left, right) = (state(&*fork)?, state(&*engine)?);
    if engine.is_repeatable() {
        return holds(left == right, || "a fork differs".to_owned());
    }
    same_but_for_rounding(&left, &right)
}
