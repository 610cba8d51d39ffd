//! The engine of a run, as a trait: what a run asks of the program that moves the grains.

use crate::compute::Compute;
use crate::energy::EnergyBalance;
use crate::error::EngineError;
use crate::settings::EngineSettings;
use grainlab_core::stress::Stress;
use grainlab_core::{Cell, EngineProgram, Mat3, Packing};
use std::fmt::Debug;

/// Measurements of an engine on its present contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observables {
    /// Love–Weber stress of the elastic contact forces, Pa, positive in compression.
    pub stress: Stress,
    /// The periodic cell, m.
    pub cell: Cell,
    /// Mean net force of non-rattlers over mean contact force, which another program may know to 1e-4; 1 where nothing is in contact.
    pub unbalanced: f64,
    /// Root mean square speed relative to the affine motion, m/s. Half its square is the kinetic energy per mass of equal
    /// grains.
    pub speed: f64,
    /// Number of contacts.
    pub contacts: u32,
    /// Affine tangent stiffness of the contacts, Pa: C_iiii for xx, yy, zz and C_ijij for yz, xz, xy. Without it only the
    /// integral law of the servo has an answer.
    pub tangent: Option<[f64; 6]>,
    /// Solid fraction; `None`: the volume of the grains over that of the cell.
    pub solid_fraction: Option<f64>,
}

/// An engine: grains in a periodic cell that deforms at a given strain rate.
///
/// # Contract
/// - An engine changes only in the methods that take `&mut self`, and is a function of what it was told: the same calls give
///   the same bits, unless it [states otherwise](Self::is_repeatable). Where it is [another program](Self::program), observing
///   it changes rounding errors.
/// - Strain and strain rate are positive in extension, stress in compression; six components have Voigt order, as tensor
///   components. Velocities are relative to the affine motion.
/// - After an error of [`run`](Self::run) an engine with [`save`](Self::save) returns by [`restore`](Self::restore); one
///   without is not used again. Other errors leave it as it was.
/// - [`packing`](Self::packing) is the complete state: an engine that starts from it continues the run.
///
/// `grainlab_verify::conformance` has a test of each point.
pub trait ParticleEngine: Debug + Send + Sync {
    /// The settings in force.
    fn settings(&self) -> &EngineSettings;

    /// Takes the settings of a new phase: chooses the time step anew, and evaluates forces under the new friction.
    ///
    /// # Errors
    /// A setting that is out of range or that the engine does not have, by name.
    fn begin_phase(&mut self, settings: &EngineSettings) -> Result<(), EngineError>;

    /// Imposes a strain rate, 1/s.
    ///
    /// # Errors
    /// A component that is not finite.
    fn set_rate(&mut self, rate: &[f64; 6]) -> Result<(), EngineError>;

    /// The strain rate in force, 1/s.
    fn rate(&self) -> [f64; 6];

    /// Does `steps` solver steps at the strain rate in force. Returns the deformation gradient of the cell over them, and what
    /// is then observed.
    ///
    /// # Errors
    /// A state beyond the contact law, an instability, or [`EngineError::Stopped`].
    fn run(&mut self, steps: u32) -> Result<(Mat3, Observables), EngineError>;

    /// Solver steps done, counted from those of the packing that the engine started from.
    fn steps(&self) -> u64;

    /// Simulated time, s, counted from that of the packing.
    fn time(&self) -> f64;

    /// Time step in force, s.
    fn time_step(&self) -> f64;

    /// The present contacts, observed.
    ///
    /// # Errors
    /// Grains that overlap beyond the contact law.
    fn observables(&self) -> Result<Observables, EngineError>;

    /// The present state; `deformation` is the deformation gradient since the reference state.
    ///
    /// # Errors
    /// A program that does not answer.
    fn packing(&self, deformation: Mat3) -> Result<Packing, EngineError>;

    /// The program, if it is not ours.
    fn program(&self) -> Option<&EngineProgram> {
        None
    }

    /// False if the same calls may give other rounding errors, as where a graphics processor sums in no fixed order. A run is
    /// then not repeated bit for bit.
    fn is_repeatable(&self) -> bool {
        true
    }

    /// State beside the packing that [`EngineFactory::resume`] needs; empty for most engines.
    ///
    /// # Errors
    /// A program that does not answer.
    fn own_state(&self) -> Result<Vec<u8>, EngineError> {
        Ok(Vec::new())
    }

    /// Sets threads and the flag that stops a computation. No result depends on them. Engines that divide
    /// their work otherwise ignore it.
    fn set_compute(&mut self, _compute: &Compute) {}

    /// Switches the energy balance on, from the present state, or off. Optional.
    fn measure_energy(&mut self, _on: bool) {}

    /// The energy balance since it was switched on; `None` without one.
    fn energy(&self) -> Option<EnergyBalance> {
        None
    }

    /// Keeps a copy of the present state, in place of an earlier one. False: the engine cannot; a run that fails is then not
    /// saved. Optional.
    fn save(&mut self) -> bool {
        false
    }

    /// Returns to the state that [`save`](Self::save) kept, and drops the copy. False: no state is kept.
    fn restore(&mut self) -> bool {
        false
    }

    /// A second engine in the same state, for steps with a predicted strain rate. `None`: steps are not computed in advance.
    /// Optional.
    fn fork(&self) -> Option<Box<dyn ParticleEngine>> {
        None
    }

    /// Parts of the model without effect under the present settings, which are left out, in one line; empty if unknown.
    fn left_out(&self) -> String {
        String::new()
    }
}

/// Starts engines of one kind.
pub trait EngineFactory: Debug + Send + Sync {
    /// Name of the program, as [`EngineProgram::name`]; `None` for ours.
    fn name(&self) -> Option<&'static str> {
        None
    }

    /// An engine in the state of `packing`, with the [`ParticleEngine::own_state`] that was saved with it.
    ///
    /// # Errors
    /// As those of [`EngineFactory::start`], and a state of another version.
    fn resume(
        &self,
        packing: &Packing,
        _own_state: &[u8],
        settings: &EngineSettings,
        rate: &[f64; 6],
        compute: &Compute,
    ) -> Result<Box<dyn ParticleEngine>, EngineError> {
        self.start(packing, settings, rate, compute)
    }

    /// An engine with the grains, contacts, step and time of `packing`, with forces evaluated at `rate` (1/s).
    ///
    /// # Errors
    /// A packing that is invalid or that the engine cannot take, settings out of range. Overlaps beyond the contact law are
    /// found here or by [`ParticleEngine::observables`].
    fn start(
        &self,
        packing: &Packing,
        settings: &EngineSettings,
        rate: &[f64; 6],
        compute: &Compute,
    ) -> Result<Box<dyn ParticleEngine>, EngineError>;
}
