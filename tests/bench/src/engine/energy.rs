//! The energy that a finite time step creates or removes along the path of a scene: an error of the integration alone, which
//! is known at every seed, while differences between packings are mostly chance.

use super::run::{Runs, finished, press, reason};
use crate::numbers::rms;
use crate::row::{Family, Row};
use grainlab_console::Failure;
use grainlab_engine::EnergyBalance;
use grainlab_node_kit::Exit;
use grainlab_page::median;
use grainlab_scene::Scene;

/// A row for each time step, as a share of the stability bound. Every run is timed without its energy balance, and repeated
/// with it. The energy is a sum of both signs, so that one run may have far less by chance: rms over the seeds.
///
/// # Errors
/// If no run with one of the time steps succeeds.
pub(crate) fn energy(shares: &[f64], runs: &Runs) -> Result<Vec<Row>, Failure> {
    let scene = press()?;
    let with = |share: f64, energy: bool| {
        let mut varied = scene.clone();
        varied.numerics.time_step_safety = share;
        varied.numerics.energy_balance = energy;
        varied
    };
    let scenes: Vec<Scene> = shares.iter().flat_map(|s| [with(*s, false), with(*s, true)]).collect();
    let samples = runs.every_seed(&scenes.iter().map(|scene| (scene, None)).collect::<Vec<_>>())?;
    let row = |(share, pair): (&f64, &[super::run::Sample])| {
        let seconds = finished(&pair[0], |o| o.seconds);
        let errors: Vec<f64> = finished(&pair[1], |o| o.energy.map(relative)).into_iter().flatten().collect();
        if seconds.is_empty() || errors.is_empty() {
            let reason = pair.iter().find_map(reason).unwrap_or_else(|| "no energy balance".to_owned());
            return Err(Failure::new(Exit::PhysicsInvalid, format!("time step {share}: {reason}")));
        }
        let (names, time) = (("time step", format!("{share} of the bound")), (median(seconds), errors.len()));
        let row = Row::new(Family::EngineEnergy, names, time, (Some(rms(&errors)), "no energy created"));
        Ok(Row { grains: Some(scene.grains as usize), ..row })
    };
    shares.iter().zip(samples.chunks(2)).map(row).collect()
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
