//! Stepping grains at a given strain rate.

use crate::error::DemError;
use crate::integrate::{kick_and_drift, spin_up, stretch};
use crate::neighbours;
use crate::observe::{self, Snapshot};
use crate::pairs::Pairs;
use crate::pass;
use crate::state::{Soa, State};
use crate::time_step;
use grains::{Cell, Mat3, Material, Packing, Vec3};
use scene::Tangential;

/// Solver steps between two looks at the stiffness of the contacts for the time step.
const TIME_STEP_INTERVAL: u64 = 200;

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
    pub(crate) pairs: Pairs,
    setting: Setting,
    /// Displacement relative to the affine motion since the neighbour list was built, m.
    travel: Soa,
    /// Sum of |L| dt since then: bounds how far the cell brought pairs together.
    strained: f64,
    listed: bool,
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
        Self::with(State::new(cell, material, ids, radii, positions), Pairs::default(), setting)
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
        state.velocity = Soa::from_vectors(&packing.velocities);
        state.spin = Soa::from_vectors(&packing.spins);
        state.step = packing.step;
        state.time = packing.time;
        state.time_step = packing.time_step;
        Self::with(state, Pairs::from_packing(packing), setting)
    }

    fn with(state: State, pairs: Pairs, setting: Setting) -> Self {
        let travel = Soa::zeros(state.grains());
        let mut engine = Self { state, pairs, setting, travel, strained: 0.0, listed: false };
        engine.set(setting);
        engine
    }

    /// Sets velocities relative to the affine motion, m/s, one a grain.
    pub fn set_velocities(&mut self, velocities: &[Vec3]) {
        self.state.velocity = Soa::from_vectors(velocities);
    }

    /// Sets spins, rad/s, one a grain.
    pub fn set_spins(&mut self, spins: &[Vec3]) {
        self.state.spin = Soa::from_vectors(spins);
    }

    /// The setting in force.
    pub fn setting(&self) -> &Setting {
        &self.setting
    }

    /// Changes the setting; takes effect with the next step. Without friction spins and tangential forces are dropped.
    pub fn set(&mut self, setting: Setting) {
        if setting.features() == Features::Frictionless {
            self.state.spin.fill(0.0);
            self.pairs.tangential.fill(0.0);
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
        self.state.rate = grains::SymTensor::from_voigt(*rate).matrix();
        Ok(())
    }

    /// The strain rate in force, Voigt order, 1/s.
    pub fn rate(&self) -> [f64; 6] {
        grains::SymTensor::symmetric_part(&self.state.rate).voigt()
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

    /// Finds contacts and evaluates forces at the present state without moving on: needed once before the first step.
    pub fn prepare(&mut self) -> Result<(), DemError> {
        self.relist()?;
        pass::evaluate(&mut self.state, &mut self.pairs, &self.setting, false);
        if self.state.time_step == 0.0 {
            self.renew_time_step();
        }
        Ok(())
    }

    /// One step: kick, drift and strain, then forces at the new positions. Returns the deformation of the cell.
    pub fn step(&mut self) -> Result<Mat3, DemError> {
        let features = self.setting.features();
        if features != Features::Frictionless {
            spin_up(&mut self.state, &self.setting);
        }
        let stretch = stretch(&self.state);
        let moved = kick_and_drift(&mut self.state, &mut self.travel, &self.setting);
        let limit =
            0.1 * self.state.radius.iter().copied().fold(f64::INFINITY, f64::min) / self.state.time_step;
        // A sum that is not finite betrays any speed that is not.
        if !moved.sum_square_speed.is_finite() || moved.largest_square_speed > limit * limit {
            return Err(self.unstable());
        }
        if let Some(cap) = self.setting.speed_cap {
            let mean = moved.sum_square_speed / self.state.grains() as f64;
            if mean > cap * cap {
                let factor = cap / mean.sqrt();
                for v in [&mut self.state.velocity.x, &mut self.state.velocity.y, &mut self.state.velocity.z]
                {
                    v.iter_mut().for_each(|v| *v *= factor);
                }
            }
        }
        self.state.step += 1;
        self.state.time += self.state.time_step;
        let strain = self.state.rate.norm() * self.state.time_step;
        // Beyond 1 two axes could turn inside out at once and leave a positive volume.
        let deformed = self.state.cell.deformed(&stretch).filter(|_| strain < 1.0);
        self.state.cell = deformed.ok_or(DemError::Cell { step: self.state.step })?;
        self.strained += strain;
        if self.list_is_stale(moved.largest_square_travel.sqrt()) {
            self.relist()?;
        } else {
            self.pairs.follow(&self.state);
        }
        pass::evaluate(&mut self.state, &mut self.pairs, &self.setting, true);
        if self.state.step.is_multiple_of(TIME_STEP_INTERVAL) {
            self.renew_time_step();
        }
        Ok(stretch)
    }

    /// Stress, tangent stiffness and balance of the present contacts.
    pub fn snapshot(&self) -> Result<Snapshot, DemError> {
        observe::snapshot(&self.state, &self.pairs, self.setting.friction)
    }

    /// Root mean square speed relative to the affine motion, m/s.
    pub fn speed(&self) -> f64 {
        self.state.mean_square_speed().sqrt()
    }

    /// The mechanical state; `deformation` is the deformation gradient since the reference state.
    pub fn packing(&self, deformation: Mat3) -> Packing {
        let s = &self.state;
        Packing {
            step: s.step,
            time: s.time,
            cell: s.cell,
            deformation,
            ids: s.ids.clone(),
            radii: s.radius.clone(),
            positions: s.position.vectors(),
            velocities: s.velocity.vectors(),
            spins: s.spin.vectors(),
            contacts: self.pairs.contacts(s),
            material: s.material,
            friction: self.setting.friction,
            time_step: s.time_step,
        }
    }

    /// Chooses the time step anew from the contacts present (or, in a gas, from the speeds).
    pub fn renew_time_step(&mut self) {
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
            None => time_step::stable(&self.state, &self.pairs, &self.setting)
                .min(time_step::rayleigh(&self.state)),
        };
        self.state.time_step = time_step::settle(self.state.time_step, safety * bound);
    }

    /// Whether a pair missing from the list could touch: the list holds pairs closer than S + skin, the affine motion
    /// brings the others no closer than (1 − strained)(S + skin), and each grain of a pair travelled at most `travel`.
    fn list_is_stale(&self, travel: f64) -> bool {
        let reach = 2.0 * self.state.largest_radius();
        (1.0 - self.strained) * (reach + self.setting.skin) - 2.0 * travel <= reach || !self.listed
    }

    fn relist(&mut self) -> Result<(), DemError> {
        self.pairs = neighbours::build(&self.state, &self.pairs, self.setting.skin)?;
        self.travel.fill(0.0);
        self.strained = 0.0;
        self.listed = true;
        Ok(())
    }

    fn unstable(&self) -> DemError {
        let s = &self.state;
        // The first grain that is too fast, or not finite.
        let too_fast = |i: usize| {
            let speed = s.velocity.get(i).norm();
            !speed.is_finite() || speed > 0.1 * s.radius[i] / s.time_step
        };
        let grain = (0..s.grains()).find(|i| too_fast(*i)).unwrap_or(0);
        let contact = (0..self.pairs.len())
            .filter(|p| self.pairs.i[*p] as usize == grain || self.pairs.j[*p] as usize == grain)
            .max_by(|a, b| self.pairs.overlap[*a].total_cmp(&self.pairs.overlap[*b]));
        let cause = contact.filter(|p| self.pairs.overlap[*p] > 0.0).map_or(String::new(), |p| {
            let (i, j) = (self.pairs.i[p] as usize, self.pairs.j[p] as usize);
            format!(", pushed hardest at its contact of grains {} and {}", s.ids[i], s.ids[j])
                + &format!(" with an overlap of {:e} m", self.pairs.overlap[p])
        });
        let speed = s.velocity.get(grain).norm();
        DemError::Unstable { step: s.step, grain: s.ids[grain], speed, time_step: s.time_step, cause }
    }
}
