//! Runs of a scene, each in one thread alone: the servo is a function call.

use super::statistics::Observables;
use crate::cpu_time::thread_seconds;
use grainlab_console::Failure;
use grainlab_core::{ComponentControl, Packing, ServoLaw};
use grainlab_engine::EnergyBalance;
use grainlab_experiment::Simulation;
use grainlab_node_kit::Exit;
use grainlab_scene::Scene;
use rayon::prelude::*;

/// The path of 200 grains to 50 kPa.
pub(crate) fn press() -> Result<Scene, Failure> {
    Scene::parse(include_str!("press.toml")).map_err(Failure::failed)
}

/// The packing at the end of the path, with this number of grains.
pub(crate) fn prepared(grains: u32) -> Result<Packing, Failure> {
    let (run, _) = run(&Scene { grains, ..press()? }, u64::MAX)
        .map_err(|why| Failure::new(Exit::PhysicsInvalid, why))?;
    run.packing().map_err(Failure::failed)
}

/// Cost and result of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outcome {
    /// The packing at the end of the path; moduli in Pa.
    pub(super) observables: Observables,
    /// CPU time of the run, without the measurement at its end, s.
    pub(super) seconds: f64,
    /// Number of solver steps.
    pub(super) steps: u64,
    /// The energy balance after the gas, if the scene asks for it.
    pub(super) energy: Option<EnergyBalance>,
}

/// The outcome of one scene at each seed.
pub(super) type Sample = Vec<Result<Outcome, String>>;

pub(crate) struct Runs {
    /// Seeds of each scene, counted up from that of the scene.
    pub(crate) seeds: u32,
    /// Number of parallel runs.
    pub(crate) threads: usize,
}

impl Runs {
    /// Outcomes of each scene, with limits on the solver steps of each seed, if any. Seed by seed, so that other load on the
    /// machine affects all scenes alike; a run stays on one thread, so that the CPU time of the thread is that of the run.
    pub(super) fn every_seed(&self, scenes: &[(&Scene, Option<&[u64]>)]) -> Result<Vec<Sample>, Failure> {
        let seeds = 0..self.seeds as usize;
        let jobs: Vec<_> = seeds.flat_map(|at| scenes.iter().map(move |scene| (at, scene))).collect();
        let run = |(at, (scene, limits)): &(usize, &(&Scene, Option<&[u64]>))| {
            let seed = scene.seed.wrapping_add(*at as u64);
            measure(&Scene { seed, ..(*scene).clone() }, limits.map_or(u64::MAX, |limits| limits[*at]))
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build();
        let outcomes: Sample =
            pool.map_err(Failure::failed)?.install(|| jobs.par_iter().with_max_len(1).map(run).collect());
        let of = |scene: usize| outcomes.iter().skip(scene).step_by(scenes.len()).cloned().collect();
        Ok((0..scenes.len()).map(of).collect())
    }
}

/// A value of each run that succeeded.
pub(super) fn finished<T>(sample: &Sample, part: impl Fn(&Outcome) -> T) -> Vec<T> {
    sample.iter().filter_map(|r| r.as_ref().ok()).map(part).collect()
}

/// Reason of the first run that failed.
pub(super) fn reason(sample: &Sample) -> Option<String> {
    sample.iter().find_map(|r| r.as_ref().err().cloned())
}

/// Runs the scene to its end and measures the packing. A run that is not finished after `limit` solver steps
/// fails.
fn measure(scene: &Scene, limit: u64) -> Result<Outcome, String> {
    let clock = || thread_seconds().map_err(|e| e.to_string());
    let begin = clock()?;
    let (run, energy) = run(scene, limit)?;
    let seconds = clock()? - begin;
    Ok(Outcome { observables: observe(&run)?, seconds, steps: run.engine().steps(), energy })
}

fn run(scene: &Scene, limit: u64) -> Result<(Simulation, Option<EnergyBalance>), String> {
    let mut run = Simulation::new(scene.clone()).map_err(|e| e.to_string())?;
    let mut energy = None;
    while let Some(r) = run.request() {
        if r.step > limit {
            return Err(format!(
                "not done after {limit} steps, in phase {}",
                run.scene().phases[r.phase as usize - 1].name
            ));
        }
        if r.input.controls.iter().any(|c| matches!(c, ComponentControl::Stress(_)))
            && let ServoLaw::Scaled { response_time } = r.input.law
            && r.input.control_interval >= 2.0 * response_time
        {
            let interval = r.input.control_interval;
            return Err(format!(
                "a control interval of {interval:.1e} s is not below twice the response time"
            ));
        }
        let answer = grainlab_servo::control(&r.input).map_err(|e| e.to_string())?;
        let outcome = run.advance(&answer.rate).map_err(|e| e.to_string())?;
        energy = outcome.energy.or(energy);
    }
    Ok((run, energy))
}

fn observe(run: &Simulation) -> Result<Observables, String> {
    let settings = grainlab_micromechanics::Settings::default();
    let r = grainlab_micromechanics::analyze(&run.packing().map_err(|e| e.to_string())?, &settings)
        .map_err(|e| e.to_string())?
        .report;
    let (k, eps, phi) = (r.contacts.coordination, r.fabric.contact_anisotropy, r.solid_fraction);
    let c = r.elasticity.map_err(|e| e.to_string())?.tensor;
    Ok([k, eps, phi, c.transverse_isotropy().g12, c.bulk_voigt()])
}
