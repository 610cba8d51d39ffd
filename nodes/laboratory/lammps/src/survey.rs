//! Time step and tangent stiffness of a state, by our engine.

use grainlab_core::Packing;
use grainlab_dem::{Engine, EngineSettings};
use grainlab_experiment::{ExperimentError, Observables};

/// Change of the load of contacts after which a state is surveyed again.
const CHANGE: f64 = 1.1;

/// Steps between two surveys at least, as between two choices of the time step by our engine.
const INTERVAL: u64 = 200;

/// A state, as our engine has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Survey {
    step: u64,
    pub(crate) time_step: f64,
    tangent: [f64; 6],
    load: Load,
}

/// Measures of the stiffness of contacts, all of which LAMMPS reduces itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load {
    /// Number of contacts.
    pub(crate) contacts: f64,
    /// Sum of their normal forces, N.
    pub(crate) sum: f64,
    /// Largest of them, N.
    pub(crate) largest: f64,
}

impl Load {
    /// Measures of k_n ∝ F^(1/3): of all contacts, and of the stiffest one.
    fn stiffness(&self) -> [f64; 2] {
        [self.contacts.powi(2) * self.sum, self.largest].map(f64::cbrt)
    }
}

impl Survey {
    /// Surveys a packing. Grains that overlap too far are found.
    pub(crate) fn of(packing: &Packing, settings: &EngineSettings) -> Result<(Self, Observables), ExperimentError> {
        let mut engine = Engine::from_packing(packing, *settings)?;
        engine.initialise()?;
        engine.update_time_step();
        let seen = engine.observables()?;
        let forces = engine.packing(packing.deformation).contacts.into_iter().map(|c| c.normal_force);
        let (sum, largest) = forces.fold((0.0f64, 0.0f64), |(sum, largest), f| (sum + f, largest.max(f)));
        let load = Load { contacts: f64::from(seen.contacts), sum, largest };
        let survey = Self { step: packing.step, time_step: engine.time_step(), tangent: seen.tangent, load };
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
        let changed = |(now, then): (f64, f64)| now > CHANGE * then || CHANGE * now < then;
        step >= self.step + INTERVAL && load.stiffness().into_iter().zip(self.load.stiffness()).any(changed)
    }

    /// Affine tangent stiffness, Pa, in proportion to the stiffness of all contacts.
    pub(crate) fn tangent(&self, load: &Load) -> [f64; 6] {
        let ([now, _], [then, _]) = (load.stiffness(), self.load.stiffness());
        self.tangent.map(|c| if then > 0.0 { c * now / then } else { c })
    }
}
