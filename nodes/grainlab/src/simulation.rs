//! Runs of scenes in one process.

use crate::error::Error;
use crate::state::State;
use grainlab_core::Mat3;
use grainlab_engine::Compute;
use grainlab_recordings::scenes;
use std::time::{Duration, Instant};

/// A run of a scene: an iterator over the packings that the scene publishes, the same bit for bit as those of
/// `grainlab launch`. After an error it has ended.
#[derive(Debug)]
pub struct Simulation {
    run: grainlab_experiment::Simulation,
    /// The packing that the scene starts from, which is returned first.
    start: Option<State>,
    notes: Vec<String>,
    failed: bool,
}

/// Starts a run of a scene: a built-in name such as `demo`, a file, or a text of several lines. `settings` replace keys, as
/// `grainlab launch --set`: `grains.count=500`, `seed=2`.
///
/// # Errors
/// If there is no such scene, or it has faults; all of them are named.
pub fn simulate(scene: &str, settings: &[&str]) -> Result<Simulation, Error> {
    let found = read(scene, settings)?;
    let simulation = |e: grainlab_experiment::ExperimentError| Error::Simulation(e.to_string());
    let run = match &found.start {
        Some(packing) => grainlab_experiment::Simulation::from_packing(found.scene, packing),
        None => grainlab_experiment::Simulation::new(found.scene),
    };
    let run = run.map_err(simulation)?;
    // As the run holds it: at its first step, without the strain of the file.
    let start = found.start.is_some().then(|| present(&run)).transpose().map_err(simulation)?;
    Ok(Simulation { run, start, notes: found.notes, failed: false })
}

/// Goes on with a run of the same scene and settings from one of its states, to the same packings bit for bit.
///
/// # Errors
/// As [`simulate`]; if the state is of another scene or seed, or of no run, or contradicts itself.
pub fn resume(scene: &str, settings: &[&str], state: &State) -> Result<Simulation, Error> {
    let found = read(scene, settings)?;
    let simulation = |e: &dyn std::fmt::Display| Error::Simulation(e.to_string());
    state.packing.check().and_then(|()| state.packing.check_consistency()).map_err(|e| simulation(&e))?;
    let run = grainlab_experiment::Simulation::resume(found.scene, &state.packing, &state.run_state);
    let run = run.map_err(|e| simulation(&e))?;
    Ok(Simulation { run, start: None, notes: found.notes, failed: false })
}

fn read(scene: &str, settings: &[&str]) -> Result<scenes::SceneText, Error> {
    let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
    scenes::read(scene, &settings, None).map_err(|e| match e.exit {
        grainlab_msgs::Exit::Failure => Error::File(e.to_string()),
        _ => Error::Scene(e.to_string()),
    })
}

fn present(run: &grainlab_experiment::Simulation) -> Result<State, grainlab_experiment::ExperimentError> {
    Ok(State { packing: run.packing()?, run_state: run.run_state()?, notes: Vec::new() })
}

impl Simulation {
    /// Sets the number of threads of the run, 1 or more. The packings stay the same bit for bit.
    ///
    /// # Errors
    /// If there are no or too many threads.
    pub fn with_threads(mut self, threads: usize) -> Result<Self, Error> {
        let compute = Compute::new(threads).map_err(|e| Error::Scene(e.to_string()))?;
        self.run.set_compute(compute);
        Ok(self)
    }

    /// Name of the scene.
    pub fn name(&self) -> &str {
        &self.run.scene().name
    }

    /// Name of the phase under way; `None` once the path is done.
    pub fn phase(&self) -> Option<&str> {
        self.run.path().phase(self.run.scene()).map(|phase| phase.name.as_str())
    }

    /// Share of that phase that is done, 0 to 1; `None` if its end is not known beforehand.
    pub fn progress(&self) -> Option<f64> {
        self.run.phase_share()
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.run.engine().time()
    }

    /// Stress, Pa, positive in compression.
    ///
    /// # Errors
    /// An engine that does not answer.
    pub fn stress(&self) -> Result<Mat3, Error> {
        let seen = self.run.engine().observables().map_err(|e| Error::Simulation(e.to_string()))?;
        Ok(seen.stress.tensor.matrix())
    }

    /// The present state, whether a packing is due or not.
    ///
    /// # Errors
    /// An engine that does not answer.
    pub fn state(&self) -> Result<State, Error> {
        present(&self.run).map_err(|e| Error::Simulation(e.to_string()))
    }

    /// Steps so far.
    pub fn steps(&self) -> u64 {
        self.run.engine().steps()
    }

    /// True once nothing follows: the loading path is done, or the run has failed.
    pub fn finished(&self) -> bool {
        self.failed || self.start.is_none() && self.run.finished()
    }

    /// Notes on the packing that the scene starts from.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Notes on the scene, as `grainlab scene check` prints them: other frictions before, an implausible density.
    pub fn scene_notes(&self) -> Vec<String> {
        self.run.scene().notes()
    }

    /// Goes on until a packing is due, a phase has ended, `limit` has passed, or the path is done, for one exchange at least; the
    /// packing, if one is due. For programs that have to look for signals, or at the run.
    ///
    /// # Errors
    /// If the run cannot go on; it has ended then.
    pub fn advance(&mut self, limit: Duration) -> Result<Option<State>, Error> {
        let found = self.try_advance(limit);
        self.failed |= found.is_err();
        found
    }

    fn try_advance(&mut self, limit: Duration) -> Result<Option<State>, Error> {
        if self.failed {
            return Ok(None);
        }
        if let Some(state) = self.start.take() {
            return Ok(Some(state));
        }
        let began = Instant::now();
        while let Some(outcome) = self.run.exchange().map_err(|e| Error::Simulation(e.to_string()))? {
            if outcome.packing_due {
                return self.state().map(Some);
            }
            if outcome.ended.is_some() {
                self.run.end_phase_here();
                break;
            }
            if began.elapsed() >= limit {
                break;
            }
        }
        Ok(None)
    }
}

impl Iterator for Simulation {
    type Item = Result<State, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.advance(Duration::MAX).transpose() {
                None if self.finished() => return None,
                None => {}
                found => return found,
            }
        }
    }
}
