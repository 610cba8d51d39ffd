//! Construction, settings and observation of the engine.

use super::checkpoint::Checkpoint;
use super::spatial_order;
use crate::domain::distributed_state::DistributedState;
use crate::domain::state::{State, vector};
use crate::observe::energy_meter::EnergyMeter;
use crate::observe::observables::{self, Observables};
use crate::pairs::contacts::Contacts;
use crate::pairs::displacement_bound::DisplacementBound;
use crate::pairs::neighbours::Neighbours;
use crate::simd::instruction_set::Simd;
use grainlab_core::contact::ContactLaw;
use grainlab_core::{Cell, Mat3, Material, Packing, PackingError, SymTensor, Vec3};
use grainlab_engine::{Compute, EnergyBalance, EngineError, EngineSettings, Features};
use std::borrow::Cow;

/// Number of grains that is worth a thread of its own.
const GRAINS_PER_THREAD: usize = 2000;

/// Grains in a deforming periodic cell, stepped at a given strain rate.
#[derive(Clone, Debug)]
pub struct Engine {
    pub(crate) state: State,
    pub(crate) contacts: Contacts,
    pub(super) copies: DistributedState,
    pub(super) settings: EngineSettings,
    pub(super) simd: Simd,
    pub(super) compute: Compute,
    pub(super) neighbours: Neighbours,
    /// Bound on the approach of any pair since the neighbours were found.
    pub(super) since_search: DisplacementBound,
    /// And since they were pruned to the pairs of the force kernel.
    pub(super) since_pruning: DisplacementBound,
    pub(super) has_neighbours: bool,
    /// True if the forces are those of the present state.
    pub(super) has_forces: bool,
    /// Sums the energy balance, if it is switched on.
    pub(super) energy: Option<Box<EnergyMeter>>,
}

impl Engine {
    /// Grains at rest at `positions` (m), without contact history. Their contact law is the default, Hertz–Mindlin; for others,
    /// see [`Engine::from_packing`].
    ///
    /// # Errors
    /// Arrays of different lengths, numbers out of their range, no grains. [`Engine::initialise`] finds overlaps beyond
    /// the contact law, and grains too many cells away.
    pub fn new(
        cell: Cell,
        material: Material,
        radii: Vec<f64>,
        positions: &[Vec3],
        settings: EngineSettings,
    ) -> Result<Self, EngineError> {
        let at_rest = Packing {
            material,
            friction: settings.friction,
            ..Packing::at_rest(cell, radii, positions.to_vec())
        };
        Self::from_packing(&at_rest, settings)
    }

    /// Grains as they are in `packing`, contact law and history included.
    ///
    /// # Errors
    /// Numbers that are no packing, settings out of their range, no grains.
    pub fn from_packing(packing: &Packing, settings: EngineSettings) -> Result<Self, EngineError> {
        packing.check()?;
        ContactLaw::new(packing.law.name(), &packing.law.parameters())?;
        settings.check()?;
        if packing.radii.is_empty() {
            return Err(EngineError::NoGrains);
        }
        let state = State::of(packing);
        let mut engine = Self {
            contacts: Contacts::from_packing(packing, &state),
            state,
            copies: DistributedState::default(),
            settings,
            simd: Simd::best(),
            compute: Compute::default(),
            neighbours: Neighbours::default(),
            since_search: DisplacementBound::new(settings.skin),
            since_pruning: DisplacementBound::new(settings.skin),
            has_neighbours: false,
            has_forces: false,
            energy: None,
        };
        engine.adopt(settings);
        Ok(engine)
    }

    /// Sets the instruction set; the widest of this processor unless it is set. Results do not depend on it.
    pub fn set_simd(&mut self, simd: Simd) {
        self.simd = simd;
    }

    /// Returns the number of threads that is worth using for this many grains and cores. Pairs across the border of two
    /// subdomains are evaluated in both, so that each thread needs some thousands of grains.
    pub fn useful_threads(grains: usize, cores: usize) -> usize {
        (grains / GRAINS_PER_THREAD).clamp(1, cores.max(1))
    }

    /// Sets threads, and the flag that stops a computation. Results do not depend on them.
    pub fn set_compute(&mut self, compute: Compute) {
        // The pairs are divided among as many subdomains as there are threads.
        self.has_neighbours &= compute.threads() == self.compute.threads();
        self.compute = compute;
    }

    /// Threads in use, and the flag that stops a computation.
    pub fn compute(&self) -> &Compute {
        &self.compute
    }

    /// Sets velocities relative to the affine motion, m/s, one per grain, all finite.
    pub fn set_velocities(&mut self, velocities: &[Vec3]) -> Result<(), EngineError> {
        self.one_per_grain("velocity", velocities)?;
        self.reclaim_state();
        self.state.twist.iter_mut().zip(velocities).for_each(|(t, v)| t.0[..3].copy_from_slice(v.as_slice()));
        Ok(())
    }

    /// Sets spins, rad/s, one per grain, all finite.
    pub fn set_spins(&mut self, spins: &[Vec3]) -> Result<(), EngineError> {
        self.one_per_grain("angular_velocity", spins)?;
        self.reclaim_state();
        self.state.twist.iter_mut().zip(spins).for_each(|(t, w)| t.0[4..7].copy_from_slice(w.as_slice()));
        Ok(())
    }

    /// Adds to the velocities of some grains, m/s, all finite.
    pub fn add_velocities(
        &mut self,
        increments: impl IntoIterator<Item = (usize, Vec3)>,
    ) -> Result<(), EngineError> {
        self.reclaim_state();
        let grains = self.state.len();
        for (grain, increment) in increments {
            let Some(twist) = self.state.twist.get_mut(grain) else {
                return Err(
                    PackingError::Length { field: "velocity", expected: grains, found: grain + 1 }.into()
                );
            };
            finite("velocity", grain, &increment)?;
            twist.0[..3].iter_mut().zip(increment.iter()).for_each(|(v, dv)| *v += dv);
        }
        Ok(())
    }

    fn one_per_grain(&self, field: &'static str, vectors: &[Vec3]) -> Result<(), EngineError> {
        let (expected, found) = (self.state.len(), vectors.len());
        if expected != found {
            return Err(PackingError::Length { field, expected, found }.into());
        }
        vectors.iter().enumerate().try_for_each(|(index, v)| finite(field, index, v))
    }

    /// Velocities relative to the affine motion, m/s, one per grain: those half a step before the positions.
    pub fn velocities(&self) -> Vec<Vec3> {
        self.current_state().velocities().collect()
    }

    /// The settings in force.
    pub fn settings(&self) -> &EngineSettings {
        &self.settings
    }

    /// Changes the settings, from the next step on. Without friction, spins and tangential forces become zero.
    ///
    /// # Errors
    /// A setting out of its range; nothing has changed.
    pub fn set_settings(&mut self, settings: EngineSettings) -> Result<(), EngineError> {
        settings.check()?;
        self.adopt(settings);
        Ok(())
    }

    fn adopt(&mut self, settings: EngineSettings) {
        if settings.features() == Features::Frictionless {
            self.reclaim_state();
            self.state.twist.iter_mut().for_each(|t| t.0[4..].fill(0.0));
            self.contacts.clear_history();
        }
        if settings.skin != self.settings.skin {
            self.has_neighbours = false;
        }
        self.settings = settings;
    }

    /// Imposes a strain rate (Voigt order, tensor components, 1/s, positive in extension).
    pub fn set_rate(&mut self, rate: &[f64; 6]) -> Result<(), EngineError> {
        if let Some(c) = rate.iter().position(|r| !r.is_finite()) {
            return Err(EngineError::Rate { component: SymTensor::COMPONENTS[c], value: rate[c] });
        }
        self.state.rate = SymTensor::from_voigt(*rate).matrix();
        Ok(())
    }

    /// The strain rate in force, Voigt order, 1/s.
    pub fn rate(&self) -> [f64; 6] {
        SymTensor::symmetric_part(&self.state.rate).voigt()
    }

    /// The contact law of the grains.
    pub fn law(&self) -> ContactLaw {
        self.state.law
    }

    /// The cell, m.
    pub fn cell(&self) -> &Cell {
        &self.state.cell
    }

    /// True if all grains are of one size.
    pub fn equal_sized(&self) -> bool {
        self.state.is_monodisperse()
    }

    /// Solver steps done.
    pub fn steps(&self) -> u64 {
        self.state.step
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Time step in force, s.
    pub fn time_step(&self) -> f64 {
        self.state.time_step
    }

    /// Moves grains that are neighbours in space next to each other in memory, which makes large packings faster. Their ids
    /// move with them. Call [`Engine::initialise`] before the next step.
    pub fn sort_spatially(&mut self) {
        self.reclaim_state();
        let order = spatial_order::along_curve(&self.state);
        self.contacts = spatial_order::reorder(&mut self.state, &self.contacts, &order);
        (self.has_neighbours, self.has_forces) = (false, false);
    }

    /// Copies the state back from the subdomains of the threads. It changes no result; it is worth calling before the state
    /// is read more than once.
    pub fn gather(&mut self) {
        self.copies.gather(&mut self.state, &self.compute);
    }

    /// Copies the state back from the subdomains, and makes their copies invalid: before the state is changed.
    pub(super) fn reclaim_state(&mut self) {
        self.gather();
        self.copies.invalidate();
    }

    /// The present state, wherever it is stored.
    fn current_state(&self) -> Cow<'_, State> {
        let mut state = Cow::Borrowed(&self.state);
        if self.copies.is_authoritative {
            self.copies.copy_to(state.to_mut(), &self.compute);
        }
        state
    }

    /// A state to return to.
    pub fn checkpoint(&self) -> Checkpoint {
        let contacts = self.contacts.saved().collect();
        Checkpoint { state: self.current_state().into_owned(), contacts }
    }

    /// Returns to a checkpoint, with the energy balance off. Call [`Engine::initialise`] before the next step.
    ///
    /// # Errors
    /// A checkpoint of another number of grains; nothing has changed.
    pub fn restore(&mut self, checkpoint: Checkpoint) -> Result<(), EngineError> {
        let (expected, found) = (self.state.len(), checkpoint.state.len());
        if expected != found {
            return Err(PackingError::Length { field: "position", expected, found }.into());
        }
        self.reclaim_state();
        self.contacts = Contacts::from_saved(&checkpoint.state, checkpoint.contacts);
        self.state = checkpoint.state;
        self.energy = None;
        (self.has_neighbours, self.has_forces) = (false, false);
        Ok(())
    }

    /// Stress, tangent stiffness and force balance of the present contacts.
    pub fn observables(&self) -> Result<Observables, EngineError> {
        let state = self.current_state();
        observables::observe(&state, &self.contacts, &self.settings, &self.compute, self.simd)
    }

    /// Switches the energy balance on, from the present state, or off. It changes no result; steps with it are several times
    /// slower. Forces must have been evaluated ([`Engine::initialise`]).
    pub fn measure_energy(&mut self, on: bool) {
        self.gather();
        let new = || Box::new(EnergyMeter::new(&self.state, &self.contacts, &self.settings));
        self.energy = on.then(new);
    }

    /// The energy balance since it was switched on; `None` if it is off.
    pub fn energy(&self) -> Option<EnergyBalance> {
        let meter = self.energy.as_ref()?;
        Some(meter.balance(&self.current_state(), &self.contacts, &self.settings))
    }

    /// Root mean square speed relative to the affine motion, m/s.
    pub fn speed(&self) -> f64 {
        self.current_state().mean_square_speed().sqrt()
    }

    /// The packing; `deformation` is the deformation gradient since the reference state.
    pub fn packing(&self, deformation: Mat3) -> Packing {
        let s = &*self.current_state();
        Packing {
            step: s.step,
            time: s.time,
            cell: s.cell,
            deformation,
            ids: s.ids.clone(),
            radii: s.radius.clone(),
            positions: s.position.iter().map(vector).collect(),
            velocities: s.velocities().collect(),
            spins: s.spins().collect(),
            contacts: self.contacts.to_contacts(s),
            material: s.material,
            law: s.law,
            friction: self.settings.friction,
            time_step: s.time_step,
            path: None,
        }
    }
}

fn finite(field: &'static str, index: usize, v: &Vec3) -> Result<(), EngineError> {
    match v.iter().find(|c| !c.is_finite()) {
        Some(value) => Err(PackingError::NotFinite { field, index, value: *value }.into()),
        None => Ok(()),
    }
}
