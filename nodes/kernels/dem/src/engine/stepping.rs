//! Steps of the engine, with checks, thermostat and upkeep of the lists of pairs.

use super::engine::Engine;
use crate::force::virial::Virial;
use crate::pairs::displacement_bound::DisplacementBound;
use crate::pairs::images::Images;
use crate::pairs::neighbours::Neighbours;
use crate::step::integrate::{self, SpeedStats};
use crate::step::pass::{Pass, PassKind};
use crate::step::time_step;
use grainlab_core::{Mat3, SymTensor, Vec3};
use grainlab_engine::{EngineError, TimeStep};

/// Steps between two updates of the time step from the stiffness of the contacts.
const TIME_STEP_INTERVAL: u64 = 200;

/// Steps for which the list of pairs of the force kernel should stay valid.
const PRUNING_INTERVAL: f64 = 100.0;

impl Engine {
    /// Finds contacts and evaluates forces at the present state, without a step. Needed once before the first step.
    pub fn initialise(&mut self) -> Result<(), EngineError> {
        self.find_neighbours()?;
        self.pass(PassKind::ForcesAsSaved, false);
        self.has_forces = true;
        if self.state.time_step == 0.0 {
            self.update_time_step();
        }
        Ok(())
    }

    /// One step: kick, drift and strain, then forces at the new positions. Returns the deformation of the cell.
    pub fn step(&mut self) -> Result<Mat3, EngineError> {
        self.run(1)
    }

    /// Several steps, with the same result as one by one but faster. Returns the deformation of the cell.
    ///
    /// # Errors
    /// [`EngineError::Stopped`] after any number of them if the flag of the compute settings is set; others if the state is lost.
    pub fn run(&mut self, steps: u32) -> Result<Mat3, EngineError> {
        self.run_steps(steps, None)
    }

    /// Several steps, with the stress at the end of each given to `each` (Pa, positive in compression): Love–Weber of all
    /// contact forces, dashpots included, which is the momentum that contacts carry. Where nothing moves it equals that of
    /// [`Engine::observables`], and it costs far less.
    pub fn run_with_stress(
        &mut self,
        steps: u32,
        mut each: impl FnMut(SymTensor),
    ) -> Result<Mat3, EngineError> {
        self.run_steps(steps, Some(&mut each))
    }

    fn run_steps(
        &mut self,
        steps: u32,
        mut each: Option<&mut dyn FnMut(SymTensor)>,
    ) -> Result<Mat3, EngineError> {
        if !self.has_forces {
            self.initialise()?;
        }
        let mut total = Mat3::identity();
        // Speeds of a motion that was done together with the forces of the step before.
        let mut moved: Option<SpeedStats> = None;
        for left in (0..steps).rev() {
            if self.compute.is_stopped() {
                return Err(EngineError::Stopped);
            }
            let stats = moved.take().unwrap_or_else(|| self.move_grains());
            let deformation = integrate::deformation(&self.state);
            total = deformation * total;
            self.finish_motion(&stats, &deformation)?;
            // The next motion must wait for the caller after the last step, and for a new time step.
            let new_time_step = self.state.step.is_multiple_of(TIME_STEP_INTERVAL);
            let wait = left == 0 || new_time_step || self.energy.is_some();
            let kind = if wait { PassKind::Forces } else { PassKind::ForcesAndMotion };
            let (virial, stats) = self.evaluate_forces(kind, each.is_some());
            moved = (!wait).then_some(stats);
            if let Some(each) = &mut each {
                each(virial.stress(self.state.cell.volume()));
            }
            if new_time_step {
                self.update_time_step();
            }
        }
        Ok(total)
    }

    /// Moves all grains, with the work of the kick added to the energy balance.
    fn move_grains(&mut self) -> SpeedStats {
        if self.energy.is_some() {
            self.gather();
        }
        let Self { state, contacts, settings, energy, .. } = self;
        if let Some(meter) = energy {
            meter.add_kick(state, contacts, settings);
        }
        self.pass(PassKind::Motion, false).1
    }

    /// Evaluates forces, with the works along the paths of contacts added to the energy balance.
    fn evaluate_forces(&mut self, kind: PassKind, with_virial: bool) -> (Virial, SpeedStats) {
        if let Some(meter) = &mut self.energy {
            meter.save_history(&self.contacts);
        }
        let results = self.pass(kind, with_virial);
        if self.energy.is_some() {
            self.gather();
        }
        let Self { state, contacts, settings, energy, .. } = self;
        if let Some(meter) = energy {
            meter.add_paths(state, contacts, settings);
        }
        results
    }

    fn pass(&mut self, kind: PassKind, with_virial: bool) -> (Virial, SpeedStats) {
        let Self { state, copies, contacts, settings, compute, simd, .. } = self;
        Pass { state, copies, contacts, settings, compute, simd: *simd, kind, with_virial }.run()
    }

    /// After all grains have moved: checks, thermostat, cell, lists of pairs.
    fn finish_motion(&mut self, stats: &SpeedStats, deformation: &Mat3) -> Result<(), EngineError> {
        self.check_speeds(stats)?;
        if let Some(limit) = self.settings.thermostat_speed {
            let mean = stats.sum_square_speed() / self.state.len() as f64;
            if mean > limit * limit {
                let factor = limit / mean.sqrt();
                self.scale_velocities(factor);
            }
        }
        self.state.step += 1;
        self.state.time += self.state.time_step;
        // Beyond a strain of 1 two axes could invert at once and leave a positive volume.
        let strain = self.state.rate.norm() * self.state.time_step;
        let deformed = self.state.cell.deformed(deformation).filter(|_| strain < 1.0);
        self.state.cell = deformed.ok_or(EngineError::Cell { step: self.state.step })?;
        self.update_pairs(stats)
    }

    fn scale_velocities(&mut self, factor: f64) {
        if self.energy.is_some() {
            self.gather();
        }
        if let Some(meter) = &mut self.energy {
            meter.add_thermostat(&self.state, factor);
        }
        if self.copies.is_authoritative {
            self.copies.scale_velocities(factor);
        } else {
            self.reclaim_state();
            self.state.twist.iter_mut().flat_map(|t| &mut t.0[..4]).for_each(|v| *v *= factor);
        }
    }

    /// An error if a grain moved by more than a tenth of a radius, or its velocity is not finite.
    fn check_speeds(&mut self, stats: &SpeedStats) -> Result<(), EngineError> {
        let limit = 0.1 * self.state.smallest_radius / self.state.time_step;
        // If any speed is not finite, the sum is not.
        if stats.sum_square_speed().is_finite() && stats.largest_square_speed() <= limit * limit {
            return Ok(());
        }
        self.gather();
        // The bound adds the largest components of different grains, so it may be too large.
        let too_fast = |v: Vec3| !v.norm().is_finite() || v.norm() > limit;
        let first = self.state.velocities().position(too_fast);
        first.map_or(Ok(()), |grain| Err(self.unstable_error(grain)))
    }

    fn unstable_error(&self, grain: usize) -> EngineError {
        let s = &self.state;
        let at_grain = self.contacts.touching().filter(|p| p.i as usize == grain || p.j as usize == grain);
        let largest = at_grain.max_by(|a, b| a.history.contact_radius.total_cmp(&b.history.contact_radius));
        let cause = largest.map_or(String::new(), |p| {
            let overlap = p.overlap(&s.radius, p.history.contact_radius);
            let [first, second] = [p.i, p.j].map(|grain| s.ids[grain as usize]);
            format!(", pushed hardest at its contact of grains {first} and {second}")
                + &format!(" with an overlap of {overlap:e} m")
        });
        let speed = s.velocities().nth(grain).map_or(0.0, |v| v.norm());
        EngineError::Unstable { step: s.step, grain: s.ids[grain], speed, time_step: s.time_step, cause }
    }

    fn update_pairs(&mut self, stats: &SpeedStats) -> Result<(), EngineError> {
        let displacement = stats.largest_square_speed().sqrt() * self.state.time_step;
        let strain = self.state.rate.norm() * self.state.time_step;
        self.since_search.advance(displacement, strain);
        self.since_pruning.advance(displacement, strain);
        let reach = 2.0 * self.state.largest_radius;
        if !self.has_neighbours || self.since_search.is_stale(reach) {
            self.find_neighbours()
        } else {
            self.contacts.images.update(&self.state.cell);
            if self.since_pruning.is_stale(reach) {
                self.prune_neighbours(self.contacts.images.clone());
            }
            Ok(())
        }
    }

    fn find_neighbours(&mut self) -> Result<(), EngineError> {
        self.gather();
        let (neighbours, images) = Neighbours::find(&self.state, self.settings.skin)?;
        self.neighbours = neighbours;
        self.since_search = DisplacementBound::new(self.settings.skin);
        self.has_neighbours = true;
        self.prune_neighbours(images);
        Ok(())
    }

    /// Prunes the neighbours to the pairs of the force kernel, with a skin that lasts for a while at the present speed.
    fn prune_neighbours(&mut self, images: Images) {
        self.gather();
        // Approach of pairs in one step: now, and on average since the last pruning.
        let (dt, last) = (self.state.time_step, self.since_pruning);
        let now = 2.0 * self.state.largest_speed() * dt + self.state.rate.norm() * dt * self.reach();
        let average = (2.0 * last.displacement + last.strain * self.reach()) / last.steps.max(1) as f64;
        // The rest of the Verlet skin bounds the new skin. The neighbours are found again before that matters.
        let left = self.settings.skin
            - 2.0 * self.since_search.displacement
            - self.since_search.strain * self.reach();
        let skin = (PRUNING_INTERVAL * now.max(average)).max(1e-3 * self.settings.skin).min(left.max(0.0));
        self.contacts = self.neighbours.prune(&self.state, images, &self.contacts, skin, &self.compute);
        self.since_pruning = DisplacementBound::new(skin);
        self.reclaim_state();
    }

    fn reach(&self) -> f64 {
        2.0 * self.state.largest_radius + self.settings.skin
    }

    /// Chooses the time step anew from the present contacts, or with a thermostat from its speed.
    pub fn update_time_step(&mut self) {
        self.gather();
        let fraction = match self.settings.time_step {
            TimeStep::FractionOfStable(fraction) => fraction,
            TimeStep::Fixed(step) => {
                self.state.time_step = step;
                return;
            }
        };
        let bound = match self.settings.thermostat_speed {
            // Collisions begin and end between two updates: assume the stiffest likely one, at six times the thermostat's
            // root mean square speed.
            Some(speed) => time_step::collision(&self.state, 6.0 * speed, self.settings.damping),
            None => time_step::stable(&self.state, &self.contacts, &self.settings)
                .min(time_step::rayleigh(&self.state)),
        };
        self.state.time_step = time_step::quantized(self.state.time_step, fraction * bound);
    }
}
