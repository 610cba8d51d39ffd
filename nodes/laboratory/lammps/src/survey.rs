//! Time step and tangent stiffness of a state, by our engine.

use grainlab_core::Packing;
use grainlab_dem::Engine;
use grainlab_engine::{EngineError, EngineSettings, Observables};
use serde::{Deserialize, Serialize};

/// Change of the load of contacts after which a state is surveyed again.
const CHANGE: f64 = 1.1;

/// Steps between two surveys at least, as between two choices of the time step by our engine.
const INTERVAL: u64 = 200;

/// A state, as our engine has it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Survey {
    step: u64,
    pub(crate) time_step: f64,
    tangent: [f64; 6],
    load: Load,
    /// Sum of normal forces over the trace of the virial, 1/m.
    forces: f64,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Load {
    pub(crate) contacts: f64,
    /// Trace of their virial, J: normal forces times distances.
    pub(crate) virial: f64,
}

impl Load {
    /// A measure of the sum of k_n ∝ F^(1/3).
    fn stiffness(&self) -> f64 {
        (self.contacts.powi(2) * self.virial).cbrt()
    }
}

impl Survey {
    /// Surveys a packing. Grains that overlap too far are found.
    pub(crate) fn of(
        packing: &Packing,
        settings: &EngineSettings,
    ) -> Result<(Self, Observables), EngineError> {
        let mut engine = Engine::from_packing(packing, *settings)?;
        engine.initialise()?;
        engine.update_time_step();
        let seen = engine.observables()?;
        let forces: f64 = engine.packing(packing.deformation).contacts.iter().map(|c| c.normal_force).sum();
        let virial = 3.0 * seen.stress.tensor.mean() * packing.cell.volume();
        let (time_step, tangent) = (engine.time_step(), seen.tangent);
        // About 1/(2 R) until there are contacts.
        let forces = if virial > 0.0 { forces / virial } else { 0.5 / packing.radii[0] };
        let load = Load { contacts: f64::from(seen.contacts), virial };
        let survey = Self { step: packing.step, time_step, tangent, load, forces };
        let observables = Observables {
            stress: seen.stress,
            cell: packing.cell,
            unbalanced: seen.unbalanced,
            speed: engine.speed(),
            contacts: seen.contacts,
            tangent: Some(seen.tangent),
            solid_fraction: Some(seen.solid_fraction),
        };
        Ok((survey, observables))
    }

    /// True if the contacts at `step` are too different for the time step and the tangent stiffness of this survey.
    pub(crate) fn is_stale(&self, step: u64, load: &Load) -> bool {
        let (now, then) = (load.stiffness(), self.load.stiffness());
        step >= self.step + INTERVAL && (now > CHANGE * then || CHANGE * now < then)
    }

    /// Affine tangent stiffness, Pa, in proportion to the stiffness of all contacts.
    pub(crate) fn tangent(&self, load: &Load) -> [f64; 6] {
        let (now, then) = (load.stiffness(), self.load.stiffness());
        self.tangent.map(|c| if then > 0.0 { c * now / then } else { c })
    }

    /// Mean normal force, N.
    pub(crate) fn mean_force(&self, load: &Load) -> f64 {
        self.forces * load.virial / load.contacts
    }
}
