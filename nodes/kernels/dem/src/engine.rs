//! Stepping grains at a given strain rate.

use crate::approach::Approach;
use crate::checkpoint::Checkpoint;
use crate::compute::Compute;
use crate::contacts::Contacts;
use crate::error::DemError;
use crate::homes::Homes;
use crate::images::Images;
use crate::integrate::{self, Moved};
use crate::neighbours::Neighbours;
use crate::observe::{self, Snapshot};
use crate::order;
use crate::state::{State, twist, vector};
use crate::stress::Seen;
use crate::sweep::{self, Job, Sweep};
use crate::time_step;
use grainlab_core::{Cell, Mat3, Material, Packing, SymTensor, Vec3};
use grainlab_scene::Tangential;
use std::borrow::Cow;

/// Solver steps between two looks at the stiffness of the contacts for the time step.
const TIME_STEP_INTERVAL: u64 = 200;

/// Steps that a contact list should last.
const DRAW_INTERVAL: f64 = 100.0;

/// Which parts of the contact law a phase needs; the engine is compiled for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Features {
    /// No friction: no spins, no tangential springs.
    Frictionless,
    /// Tangential springs with the Coulomb limit.
    Coulomb,
    /// Tangential springs that never slide (infinite friction).
    Stuck,
}

/// How the time step is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeStep {
    /// This share of the stability bound, followed as contacts stiffen.
    Safety(f64),
    /// Exactly this, s; too long a step ends in [`DemError::Unstable`].
    Fixed(f64),
}

/// What the engine is set to during a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Friction coefficient, 0 to infinity.
    pub friction: f64,
    /// Contact damping, share of critical.
    pub damping: f64,
    /// Drag on velocities relative to the affine motion, 1/s.
    pub drag: f64,
    /// Drag on spins, 1/s.
    pub spin_drag: f64,
    /// How the tangential force follows a change of normal stiffness.
    pub tangential: Tangential,
    /// How the time step is chosen.
    pub time_step: TimeStep,
    /// Verlet skin, m.
    pub skin: f64,
    /// Root mean square speed that the grains are kept from exceeding, m/s: a gas's thermostat.
    pub speed_cap: Option<f64>,
}

impl Setting {
    /// The part of the contact law that this setting needs.
    pub fn features(&self) -> Features {
        if self.friction == 0.0 {
            Features::Frictionless
        } else if self.friction.is_infinite() {
            Features::Stuck
        } else {
            Features::Coulomb
        }
    }
}

/// Grains in a deforming periodic cell.
#[derive(Clone, Debug)]
pub struct Engine {
    pub(crate) state: State,
    pub(crate) contacts: Contacts,
    homes: Homes,
    setting: Setting,
    compute: Compute,
    neighbours: Neighbours,
    /// How far any pair may have come closer since the neighbours were found.
    found: Approach,
    /// And since the contacts were drawn from them.
    drawn: Approach,
    listed: bool,
    /// Whether the forces are those of the present state.
    ready: bool,
}

impl Engine {
    /// Grains at rest at `positions` (m), without history.
    pub fn new(
        cell: Cell,
        material: Material,
        radii: Vec<f64>,
        positions: &[Vec3],
        setting: Setting,
    ) -> Self {
        let ids = (0..radii.len() as u32).collect();
        let state = State::new(cell, material, ids, radii, positions);
        let contacts = Contacts::none(&state);
        Self::with(state, contacts, setting)
    }

    /// Grains as they are in `packing`, contact history included.
    pub fn from_packing(packing: &Packing, setting: Setting) -> Self {
        let mut state = State::new(
            packing.cell,
            packing.material,
            packing.ids.clone(),
            packing.radii.clone(),
            &packing.positions,
        );
        state.twist = packing.velocities.iter().zip(&packing.spins).map(|(v, w)| twist(v, w)).collect();
        state.step = packing.step;
        state.time = packing.time;
        state.time_step = packing.time_step;
        let contacts = Contacts::from_packing(packing, &state);
        Self::with(state, contacts, setting)
    }

    fn with(state: State, contacts: Contacts, setting: Setting) -> Self {
        let (found, drawn) = (Approach::new(setting.skin), Approach::new(setting.skin));
        let mut engine = Self {
            state,
            contacts,
            homes: Homes::default(),
            setting,
            compute: Compute::default(),
            neighbours: Neighbours::default(),
            found,
            drawn,
            listed: false,
            ready: false,
        };
        engine.set(setting);
        engine
    }

    /// Instruction set and threads from now on; results do not depend on them.
    pub fn set_compute(&mut self, compute: Compute) {
        // Another number of threads shares out the contacts anew.
        self.listed &= compute.threads() == self.compute.threads();
        self.compute = compute;
    }

    /// Instruction set and threads in use.
    pub fn compute(&self) -> &Compute {
        &self.compute
    }

    /// Sets velocities relative to the affine motion, m/s, one a grain.
    pub fn set_velocities(&mut self, velocities: &[Vec3]) {
        self.leave();
        self.state.twist.iter_mut().zip(velocities).for_each(|(t, v)| t.0[..3].copy_from_slice(v.as_slice()));
    }

    /// Sets spins, rad/s, one a grain.
    pub fn set_spins(&mut self, spins: &[Vec3]) {
        self.leave();
        self.state.twist.iter_mut().zip(spins).for_each(|(t, w)| t.0[4..7].copy_from_slice(w.as_slice()));
    }

    /// Adds to the velocities of some grains, m/s.
    pub fn kick(&mut self, kicks: impl IntoIterator<Item = (usize, Vec3)>) {
        self.leave();
        for (grain, by) in kicks {
            self.state.twist[grain].0[..3].iter_mut().zip(by.iter()).for_each(|(v, by)| *v += by);
        }
    }

    /// Velocities relative to the affine motion, m/s, one a grain: those half a step before the positions.
    pub fn velocities(&self) -> Vec<Vec3> {
        self.settled().velocities().collect()
    }

    /// The setting in force.
    pub fn setting(&self) -> &Setting {
        &self.setting
    }

    /// Changes the setting; takes effect with the next step. Without friction spins and tangential forces are dropped.
    pub fn set(&mut self, setting: Setting) {
        if setting.features() == Features::Frictionless {
            self.leave();
            self.state.twist.iter_mut().for_each(|t| t.0[4..].fill(0.0));
            self.contacts.forget();
        }
        if setting.skin != self.setting.skin {
            self.listed = false;
        }
        self.setting = setting;
    }

    /// Imposes a strain rate (Voigt order, tensor components, 1/s, positive in extension).
    pub fn set_rate(&mut self, rate: &[f64; 6]) -> Result<(), DemError> {
        const NAMES: [&str; 6] = ["xx", "yy", "zz", "yz", "xz", "xy"];
        if let Some(c) = rate.iter().position(|r| !r.is_finite()) {
            return Err(DemError::Rate { component: NAMES[c], value: rate[c] });
        }
        self.state.rate = SymTensor::from_voigt(*rate).matrix();
        Ok(())
    }

    /// The strain rate in force, Voigt order, 1/s.
    pub fn rate(&self) -> [f64; 6] {
        SymTensor::symmetric_part(&self.state.rate).voigt()
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

    /// Puts grains that are neighbours in space next to each other in memory, which large packings gain from. Their
    /// ids go with them. Call [`Engine::prepare`] before the next step.
    pub fn sort(&mut self) {
        self.leave();
        let order = order::along_curve(&self.state);
        self.contacts = order::reorder(&mut self.state, &self.contacts, &order);
        (self.listed, self.ready) = (false, false);
    }

    /// Finds contacts and evaluates forces at the present state without moving on: needed once before the first step.
    pub fn prepare(&mut self) -> Result<(), DemError> {
        self.find()?;
        self.sweep(Job::Resume, false);
        self.ready = true;
        if self.state.time_step == 0.0 {
            self.renew_time_step();
        }
        Ok(())
    }

    /// One step: kick, drift and strain, then forces at the new positions. Returns the deformation of the cell.
    pub fn step(&mut self) -> Result<Mat3, DemError> {
        self.run(1)
    }

    /// As many steps as told, the same as one by one but faster. Returns the deformation of the cell.
    pub fn run(&mut self, steps: u32) -> Result<Mat3, DemError> {
        self.drive(steps, None)
    }

    /// As many steps as told; `each` is given the stress at the end of each (Pa, positive in compression): Love–Weber of
    /// all contact forces, dashpots included, which is the momentum that contacts carry. Where nothing moves it is that
    /// of a [`Snapshot`], and it costs far less.
    pub fn run_measured(&mut self, steps: u32, mut each: impl FnMut(SymTensor)) -> Result<Mat3, DemError> {
        self.drive(steps, Some(&mut each))
    }

    fn drive(&mut self, steps: u32, mut each: Option<&mut dyn FnMut(SymTensor)>) -> Result<Mat3, DemError> {
        if !self.ready {
            self.prepare()?;
        }
        let mut total = Mat3::identity();
        // Motion under the forces of this step's positions, if it was done with them.
        let mut gone: Option<Moved> = None;
        for left in (0..steps).rev() {
            let moved = gone.take().unwrap_or_else(|| self.sweep(Job::Advance, false).1);
            let stretch = integrate::stretch(&self.state);
            total = stretch * total;
            self.arrive(&moved, &stretch)?;
            // The next motion waits for the last step's observers, and for a new time step.
            let renew = self.state.step.is_multiple_of(TIME_STEP_INTERVAL);
            let wait = left == 0 || renew;
            let job = if wait { Job::Evaluate } else { Job::EvaluateAndAdvance };
            let (seen, moved) = self.sweep(job, each.is_some());
            gone = (!wait).then_some(moved);
            if let Some(each) = &mut each {
                each(seen.stress(self.state.cell.volume()));
            }
            if renew {
                self.renew_time_step();
            }
        }
        Ok(total)
    }

    fn sweep(&mut self, job: Job, look: bool) -> (Seen, Moved) {
        let Self { state, homes, contacts, setting, compute, .. } = self;
        Sweep { state, homes, contacts, setting, compute }.run(job, look)
    }

    /// Brings the state back from where several threads have it: before it is looked at more than once.
    pub(crate) fn settle(&mut self) {
        self.homes.settle(&mut self.state, &self.compute);
    }

    /// The same, and takes it from them: before it is changed.
    fn leave(&mut self) {
        self.settle();
        self.homes.leave();
    }

    /// The state, wherever it is.
    fn settled(&self) -> Cow<'_, State> {
        let mut state = Cow::Borrowed(&self.state);
        if self.homes.have_it_alone() {
            self.homes.tell(state.to_mut(), &self.compute);
        }
        state
    }

    /// What follows when all grains have moved: checks, thermostat, cell, lists.
    fn arrive(&mut self, moved: &Moved, stretch: &Mat3) -> Result<(), DemError> {
        self.check(moved)?;
        if let Some(cap) = self.setting.speed_cap {
            let mean = moved.sum_square_speed() / self.state.grains() as f64;
            if mean > cap * cap {
                let factor = cap / mean.sqrt();
                self.slow(factor);
            }
        }
        self.state.step += 1;
        self.state.time += self.state.time_step;
        // Beyond 1 two axes could turn inside out at once and leave a positive volume.
        let strain = self.state.rate.norm() * self.state.time_step;
        let deformed = self.state.cell.deformed(stretch).filter(|_| strain < 1.0);
        self.state.cell = deformed.ok_or(DemError::Cell { step: self.state.step })?;
        self.relist(moved)
    }

    /// Multiplies all velocities.
    fn slow(&mut self, factor: f64) {
        if self.homes.have_it_alone() {
            self.homes.scale(factor);
        } else {
            self.leave();
            self.state.twist.iter_mut().flat_map(|t| &mut t.0[..4]).for_each(|v| *v *= factor);
        }
    }

    /// Refuses what no longer moves as grains do.
    fn check(&mut self, moved: &Moved) -> Result<(), DemError> {
        let limit = 0.1 * self.state.smallest_radius / self.state.time_step;
        // A sum that is not finite betrays any speed that is not.
        if moved.sum_square_speed().is_finite() && moved.largest_square_speed() <= limit * limit {
            return Ok(());
        }
        self.settle();
        // The bound may be too large where several grains are fast.
        let fast = |v: Vec3| {
            let speed = v.norm();
            !speed.is_finite() || speed > limit
        };
        if self.state.velocities().any(fast) { Err(self.unstable()) } else { Ok(()) }
    }

    /// Brings the lists up to date.
    fn relist(&mut self, moved: &Moved) -> Result<(), DemError> {
        let travel = moved.largest_square_speed().sqrt() * self.state.time_step;
        let strain = self.state.rate.norm() * self.state.time_step;
        self.found.advance(travel, strain);
        self.drawn.advance(travel, strain);
        let reach = 2.0 * self.state.largest_radius;
        if !self.listed || self.found.is_stale(reach) {
            self.find()
        } else {
            self.contacts.images.follow(&self.state.cell);
            if self.drawn.is_stale(reach) {
                self.draw(self.contacts.images.clone());
            }
            Ok(())
        }
    }

    fn find(&mut self) -> Result<(), DemError> {
        self.settle();
        let (neighbours, images) = Neighbours::find(&self.state, self.setting.skin)?;
        self.neighbours = neighbours;
        self.found = Approach::new(self.setting.skin);
        self.listed = true;
        self.draw(images);
        Ok(())
    }

    /// Draws the contact list from the neighbours, with a skin that lasts for a while at the present speed.
    fn draw(&mut self, images: Images) {
        self.settle();
        // What pairs come closer in one step, now and on the average of late.
        let (dt, last) = (self.state.time_step, self.drawn);
        let now = 2.0 * self.state.largest_speed() * dt + self.state.rate.norm() * dt * self.reach();
        let late = (2.0 * last.travel + last.strained * self.reach()) / last.steps.max(1) as f64;
        // Near its end the neighbour list bounds what can be drawn; it is found anew before that matters.
        let left = self.setting.skin - 2.0 * self.found.travel - self.found.strained * self.reach();
        let skin = (DRAW_INTERVAL * now.max(late)).max(1e-3 * self.setting.skin).min(left.max(0.0));
        self.contacts = self.neighbours.draw(&self.state, images, &self.contacts, skin, &self.compute);
        self.drawn = Approach::new(skin);
        self.leave();
    }

    fn reach(&self) -> f64 {
        2.0 * self.state.largest_radius + self.setting.skin
    }

    pub(crate) fn checkpoint(&self) -> Checkpoint {
        Checkpoint::of(&self.settled(), &self.contacts)
    }

    /// Goes back; forces must be evaluated anew before the next step.
    pub(crate) fn restore(&mut self, kept: Checkpoint) {
        self.leave();
        self.contacts = kept.restore(&mut self.state);
        (self.listed, self.ready) = (false, false);
    }

    /// Stress, tangent stiffness and balance of the present contacts.
    pub fn snapshot(&self) -> Result<Snapshot, DemError> {
        let state = self.settled();
        let view = sweep::view(&state, self.contacts.images.shifts(), &self.setting);
        observe::snapshot(&state, &self.contacts, view, &self.compute)
    }

    /// Root mean square speed relative to the affine motion, m/s.
    pub fn speed(&self) -> f64 {
        self.settled().mean_square_speed().sqrt()
    }

    /// The mechanical state; `deformation` is the deformation gradient since the reference state.
    pub fn packing(&self, deformation: Mat3) -> Packing {
        let s = &*self.settled();
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
            contacts: self.contacts.contacts(s),
            material: s.material,
            friction: self.setting.friction,
            time_step: s.time_step,
        }
    }

    /// Chooses the time step anew from the contacts present (or, in a gas, from the speeds).
    pub fn renew_time_step(&mut self) {
        self.settle();
        let safety = match self.setting.time_step {
            TimeStep::Safety(share) => share,
            TimeStep::Fixed(step) => {
                self.state.time_step = step;
                return;
            }
        };
        let bound = match self.setting.speed_cap {
            // Collisions come and go between two looks: take the stiffest likely one, at six times the mean speed.
            Some(speed) => time_step::collision(&self.state, 6.0 * speed, self.setting.damping),
            None => time_step::stable(&self.state, &self.contacts, &self.setting)
                .min(time_step::rayleigh(&self.state)),
        };
        self.state.time_step = time_step::settle(self.state.time_step, safety * bound);
    }

    fn unstable(&self) -> DemError {
        let s = &self.state;
        // The first grain that is too fast, or not finite.
        let limit = 0.1 * s.smallest_radius / s.time_step;
        let too_fast = |v: Vec3| !v.norm().is_finite() || v.norm() > limit;
        let grain = s.velocities().position(too_fast).unwrap_or(0);
        let at_grain = self.contacts.touching().filter(|p| p.i as usize == grain || p.j as usize == grain);
        let cause = at_grain.max_by(|a, b| a.root.total_cmp(&b.root)).map_or(String::new(), |p| {
            let (i, j) = (p.i as usize, p.j as usize);
            let overlap =
                p.root * p.root / grainlab_core::material::effective_radius(s.radius[i], s.radius[j]);
            format!(", pushed hardest at its contact of grains {} and {}", s.ids[i], s.ids[j])
                + &format!(" with an overlap of {overlap:e} m")
        });
        let speed = s.velocities().nth(grain).map_or(0.0, |v| v.norm());
        DemError::Unstable { step: s.step, grain: s.ids[grain], speed, time_step: s.time_step, cause }
    }
}
