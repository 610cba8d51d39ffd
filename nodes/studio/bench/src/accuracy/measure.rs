//! One run of a scene, in this thread alone: the servo is a function call.

use super::knobs::Servoed;
use super::statistics::Observables;
use crate::cpu_time::thread_seconds;
use grainlab_core::{ComponentControl, Packing, ServoLaw};
use grainlab_dem::EnergyBalance;
use grainlab_experiment::Simulation;
use grainlab_scene::Scene;

/// Cost and result of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outcome {
    /// The packing at the end of the path; moduli in Pa.
    pub(crate) observables: Observables<f64>,
    /// CPU time of the run, without the measurement at its end, s.
    pub(crate) seconds: f64,
    /// Solver steps.
    pub(crate) steps: u64,
    /// The last request under stress control.
    pub(crate) servoed: Option<Servoed>,
    /// The energy balance after the gas, if the scene asks for it.
    pub(crate) energy: Option<EnergyBalance>,
}

/// Runs the scene to its end and measures the packing. A run that is not finished after `limit` solver steps
/// fails.
pub(crate) fn measure(scene: &Scene, limit: u64) -> Result<Outcome, String> {
    let clock = || thread_seconds().map_err(|e| e.to_string());
    let begin = clock()?;
    let run = finished(scene, limit)?;
    let seconds = clock()? - begin;
    let Finished { simulation, servoed, energy } = run;
    let (observables, steps) = (observe(&simulation)?, simulation.engine().steps());
    Ok(Outcome { observables, seconds, steps, servoed, energy })
}

/// The packing at the end of the path.
pub(crate) fn prepared(scene: &Scene) -> Result<Packing, String> {
    Ok(finished(scene, u64::MAX)?.simulation.packing())
}

/// A run at its end.
struct Finished {
    simulation: Simulation,
    servoed: Option<Servoed>,
    energy: Option<EnergyBalance>,
}

fn finished(scene: &Scene, limit: u64) -> Result<Finished, String> {
    let mut run = Simulation::new(scene.clone()).map_err(|e| e.to_string())?;
    let (mut servoed, mut energy) = (None, None);
    while let Some(r) = run.request() {
        if r.step > limit {
            return Err(format!(
                "not done after {limit} steps, in phase {}",
                run.scene().phases[r.phase as usize - 1].name
            ));
        }
        if r.input.controls.iter().any(|c| matches!(c, ComponentControl::Stress(_))) {
            if let ServoLaw::Scaled { response_time } = r.input.law
                && r.input.control_interval >= 2.0 * response_time
            {
                let interval = r.input.control_interval;
                return Err(format!(
                    "a control interval of {interval:.1e} s is not below twice the response time"
                ));
            }
            let tangent = r.input.tangent.unwrap_or_default()[..3].iter().copied().fold(0.0, f64::max);
            servoed = Some(Servoed { tangent, interval: r.input.control_interval });
        }
        let answer = grainlab_servo::control(&r.input).map_err(|e| e.to_string())?;
        let outcome = run.advance(&answer.rate).map_err(|e| e.to_string())?;
        energy = outcome.energy.or(energy);
    }
    Ok(Finished { simulation: run, servoed, energy })
}

fn observe(run: &Simulation) -> Result<Observables<f64>, String> {
    let settings = grainlab_micromechanics::Settings::default();
    let r = grainlab_micromechanics::analyze(&run.packing(), &settings).map_err(|e| e.to_string())?.report;
    let (k, eps, phi) = (r.contacts.coordination, r.fabric.contact_anisotropy, r.solid_fraction);
    let c = r.elasticity.map_err(|e| e.to_string())?.tensor;
    Ok(Observables { k, eps, phi, g12: c.transverse_isotropy().g12, theta: c.bulk_voigt() })
}
