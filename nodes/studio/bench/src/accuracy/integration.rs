//! The energy that a finite time step creates or removes along the path of a scene: an error of the integration alone, which
//! is known at every seed, while differences between packings are mostly chance.

use super::{every_seed, row::finished, seeds};
use crate::numbers::median;
use grainlab_console::Failure;
use grainlab_dem::EnergyBalance;
use grainlab_node_kit::Exit;
use grainlab_scene::Scene;

/// The outcome of one time step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Integration {
    /// Share of the stability bound that the time step takes.
    pub(crate) share: f64,
    /// Median CPU time of a run without the energy balance, s.
    pub(crate) seconds: f64,
    /// The energy created, over the largest other term of the balance; root mean square over the seeds. It is a sum of both
    /// signs, so that one run may have far less by chance.
    pub(crate) error: f64,
    /// Runs that succeeded.
    pub(crate) runs: usize,
}

/// Runs the scene at each time step and seed, timed without and then repeated with its energy balance.
///
/// # Errors
/// If no run with one of the time steps succeeds.
pub(crate) fn integration(
    scene: &Scene,
    shares: &[f64],
    count: u32,
    threads: usize,
) -> Result<Vec<Integration>, Failure> {
    let seeds = seeds(scene, count);
    let unlimited = vec![u64::MAX; seeds.len()];
    let with = |share: f64, energy: bool| {
        let mut turned = scene.clone();
        turned.numerics.time_step_safety = share;
        turned.numerics.energy_balance = energy;
        turned
    };
    let scenes: Vec<Scene> = shares.iter().flat_map(|s| [with(*s, false), with(*s, true)]).collect();
    let jobs: Vec<_> = scenes.iter().map(|scene| (scene, &unlimited)).collect();
    let samples = every_seed(&jobs, &seeds, threads, "energy");
    let of = |(share, pair): (&f64, &[super::Sample])| {
        let seconds = finished(&pair[0], |o| o.seconds);
        let errors: Vec<f64> = finished(&pair[1], |o| o.energy.map(relative)).into_iter().flatten().collect();
        if seconds.is_empty() || errors.is_empty() {
            let reason = pair.iter().flatten().find_map(|r| r.as_ref().err().cloned());
            let reason = reason.unwrap_or_else(|| "no energy balance".to_owned());
            return Err(Failure::new(Exit::PhysicsInvalid, format!("time step {share}: {reason}")));
        }
        let runs = errors.len();
        let error = (errors.iter().map(|e| e * e).sum::<f64>() / runs as f64).sqrt();
        Ok(Integration { share: *share, seconds: median(seconds), error, runs })
    };
    shares.iter().zip(samples.chunks(2)).map(of).collect()
}

/// The energy created over the largest other term.
fn relative(balance: EnergyBalance) -> f64 {
    let terms = [balance.start, balance.strain_work, balance.stored(), balance.dissipated()];
    balance.integration.abs() / terms.into_iter().fold(f64::MIN_POSITIVE, |a, t| a.max(t.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_energy_that_a_time_step_creates_is_taken_over_the_largest_other_term() {
        let balance =
            EnergyBalance { strain_work: 4.0, sliding: 3.0, integration: -0.2, ..Default::default() };
        assert_eq!(relative(balance), 0.05);
    }
}
