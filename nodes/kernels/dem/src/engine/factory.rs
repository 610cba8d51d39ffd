//! The engine behind the contract of a run.

use super::checkpoint::Checkpoint;
use super::engine::Engine;
use crate::simd::instruction_set::Simd;
use grainlab_core::{Mat3, Packing};
use grainlab_engine::{
    Compute, EnergyBalance, EngineError, EngineFactory, EngineSettings, Features, Observables, ParticleEngine,
};
use std::sync::Arc;

/// Starts engines of this crate.
#[derive(Clone, Copy, Debug)]
pub struct Dem {
    /// Instruction set of the engines. Results do not depend on it.
    pub simd: Simd,
}

/// Engines with the widest instruction set of this processor.
impl Default for Dem {
    fn default() -> Self {
        Self { simd: Simd::best() }
    }
}

impl EngineFactory for Dem {
    fn start(
        &self,
        packing: &Packing,
        settings: &EngineSettings,
        rate: &[f64; 6],
        compute: &Compute,
    ) -> Result<Box<dyn ParticleEngine>, EngineError> {
        let mut engine = Engine::from_packing(packing, *settings)?;
        engine.set_simd(self.simd);
        engine.set_compute(compute.clone());
        engine.set_rate(rate)?;
        engine.initialise()?;
        Ok(Box::new(DemEngine { engine, kept: None }))
    }
}

/// An engine and the state that it returns to.
#[derive(Clone, Debug)]
struct DemEngine {
    engine: Engine,
    kept: Option<Arc<Checkpoint>>,
}

impl ParticleEngine for DemEngine {
    fn settings(&self) -> &EngineSettings {
        self.engine.settings()
    }

    /// Forces and stress are evaluated again, as in a resumed run, so that both give the same result.
    fn begin_phase(&mut self, settings: &EngineSettings) -> Result<(), EngineError> {
        self.engine.set_settings(*settings)?;
        // A resumed run does not sort here, but its packing has the order of this one.
        self.engine.sort_spatially();
        self.engine.initialise()?;
        self.engine.update_time_step();
        Ok(())
    }

    fn set_rate(&mut self, rate: &[f64; 6]) -> Result<(), EngineError> {
        self.engine.set_rate(rate)
    }

    fn rate(&self) -> [f64; 6] {
        self.engine.rate()
    }

    fn run(&mut self, steps: u32) -> Result<(Mat3, Observables), EngineError> {
        let compute = self.engine.compute().clone();
        compute.install(|| {
            let deformation = self.engine.run(steps)?;
            self.engine.gather();
            Ok((deformation, self.observables()?))
        })
    }

    fn steps(&self) -> u64 {
        self.engine.steps()
    }

    fn time(&self) -> f64 {
        self.engine.time()
    }

    fn time_step(&self) -> f64 {
        self.engine.time_step()
    }

    fn observables(&self) -> Result<Observables, EngineError> {
        let seen = self.engine.observables()?;
        Ok(Observables {
            stress: seen.stress,
            cell: *self.engine.cell(),
            unbalanced: seen.unbalanced,
            speed: self.engine.speed(),
            contacts: seen.contacts,
            tangent: Some(seen.tangent),
            solid_fraction: Some(seen.solid_fraction),
        })
    }

    fn packing(&self, deformation: Mat3) -> Result<Packing, EngineError> {
        Ok(self.engine.packing(deformation))
    }

    fn set_compute(&mut self, compute: &Compute) {
        self.engine.set_compute(compute.clone());
    }

    fn measure_energy(&mut self, on: bool) {
        self.engine.measure_energy(on);
    }

    fn energy(&self) -> Option<EnergyBalance> {
        self.engine.energy()
    }

    fn save(&mut self) -> bool {
        self.kept = Some(Arc::new(self.engine.checkpoint()));
        true
    }

    fn restore(&mut self) -> bool {
        let Some(kept) = self.kept.take() else { return false };
        let restored = self.engine.restore(Arc::unwrap_or_clone(kept));
        // The forces of this state were valid when it was kept. If they fail now, the state is restored all the same.
        let _ = self.engine.initialise();
        restored.is_ok()
    }

    fn fork(&self) -> Option<Box<dyn ParticleEngine>> {
        Some(Box::new(self.clone()))
    }

    fn left_out(&self) -> String {
        left_out(self.engine.settings(), self.engine.equal_sized())
    }
}

/// Description of the parts left out under these settings. `equal_sized`: all grains have one size.
fn left_out(settings: &EngineSettings, equal_sized: bool) -> String {
    let mut parts = match settings.features() {
        Features::Frictionless => vec!["spins", "tangential springs"],
        Features::Sliding => vec![],
        Features::NoSlip => vec!["the Coulomb check"],
    };
    if equal_sized {
        parts.push("unequal sizes");
    }
    if parts.is_empty() {
        "with the whole contact law".into()
    } else {
        format!("without {}", parts.join(", "))
    }
}
