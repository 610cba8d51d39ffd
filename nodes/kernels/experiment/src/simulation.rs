//! A scene run along its loading path.

use crate::error::ExperimentError;
use crate::left_out::left_out;
use crate::phase_settings::phase_settings;
use crate::request::{ServoRequest, StepOutcome};
use crate::rollback::Rollback;
use crate::run_state::{RunState, StrainOrigin};
use grainlab_core::{Mat3, Packing, ServoLaw, SymTensor};
use grainlab_dem::gas::{HardSpheres, mean_free_time, random_placement};
use grainlab_dem::{Compute, DemError, Engine, Observables};
use grainlab_scene::{
    Condition, GasMethod, Measure, Observation, PathEvent, PathState, Phase, PhaseKind, Scene, Travelled,
};

/// Solver steps between two copies of the state that a failing run returns to.
const ROLLBACK_INTERVAL: u64 = 100;

/// A run: scene, path, engine and clock. It advances only when it is given a strain rate.
#[derive(Clone, Debug)]
pub struct Simulation {
    scene: Scene,
    engine: Engine,
    path: PathState,
    sequence: u64,
    packings: u64,
    /// Friction coefficient of the present forces. At the end of a phase the engine already has that of the
    /// next one.
    friction: f64,
    /// Deformation gradient since the reference state; since the first step until a phase sets one.
    deformation: Mat3,
    phase_deformation: Mat3,
    /// Integral over time of the largest component of the strain rate since the phase began.
    phase_strain: f64,
    strain_origin: StrainOrigin,
    /// The present state is within a phase, not at the end of one.
    within_phase: bool,
    observables: Observables,
    rollback: Option<Rollback>,
}

/// Parameters of an event-driven phase.
#[derive(Clone, Copy, Debug)]
struct EventDriven {
    /// Solver step, s.
    step: f64,
    /// Root mean square speed of the thermostat, m/s.
    speed: f64,
}

impl Simulation {
    /// The start of a scene: grains placed at random with thermal velocities.
    pub fn new(scene: Scene) -> Result<Self, ExperimentError> {
        let (fraction, speed) = match scene.phases.first().map(|p| &p.kind) {
            Some(PhaseKind::Gas { initial_solid_fraction, speed, .. }) => (*initial_solid_fraction, *speed),
            _ => return Err(ExperimentError::Resume("the path does not begin with a gas phase".into())),
        };
        let radii: Vec<f64> = scene.sizes.diameters(scene.grains).iter().map(|d| 0.5 * d).collect();
        let gas = random_placement(&radii, fraction, speed, scene.seed)?;
        let settings = phase_settings(&scene, &scene.phases[0]);
        let mut engine =
            Engine::new(gas.cell, scene.material, radii, &gas.positions, settings)?.with_law(scene.law)?;
        engine.set_velocities(&gas.velocities)?;
        let friction = engine.settings().friction;
        let mut run = Self::begin(scene, engine, friction)?;
        run.within_phase = true;
        Ok(run)
    }

    /// The start of a scene whose path begins with this packing. Its clock and its strain are set to 0.
    pub fn from_packing(scene: Scene, packing: &Packing) -> Result<Self, ExperimentError> {
        let phase = scene.phases.first();
        let phase = phase.ok_or(ExperimentError::Resume("the scene has no phases".into()))?;
        // The time step of the packing was set under other settings.
        let start = Packing { step: 0, time: 0.0, time_step: 0.0, ..packing.clone() };
        let engine = Engine::from_packing(&start, phase_settings(&scene, phase))?;
        let mut run = Self::begin(scene, engine, packing.friction)?;
        // It is published before the first request.
        run.packings = 1;
        Ok(run)
    }

    fn begin(scene: Scene, mut engine: Engine, friction: f64) -> Result<Self, ExperimentError> {
        engine.initialise()?;
        // Hard spheres that only collide have no balance.
        let hard = |p: &Phase| matches!(p.kind, PhaseKind::Gas { method: GasMethod::EventDriven, .. });
        engine.measure_energy(scene.numerics.energy_balance && !scene.phases.first().is_some_and(hard));
        let observables = engine.observables()?;
        Ok(Self {
            friction,
            scene,
            engine,
            path: PathState::START,
            sequence: 0,
            packings: 0,
            deformation: Mat3::identity(),
            phase_deformation: Mat3::identity(),
            phase_strain: 0.0,
            strain_origin: StrainOrigin::FirstStep,
            within_phase: false,
            observables,
            rollback: None,
        })
    }

    /// Resumes from a packing and the run state that was published with it.
    pub fn resume(scene: Scene, packing: &Packing, run_state: &[u8]) -> Result<Self, ExperimentError> {
        let saved = RunState::decode(run_state)?;
        if saved.scene != fingerprint(&scene) {
            return Err(ExperimentError::Resume("the packing belongs to another scene or seed".into()));
        }
        if saved.strain_origin == StrainOrigin::Unknown || packing.strain().is_none() {
            let why = "an earlier version recorded the packing, without the strain since the first step; begin the run anew";
            return Err(ExperimentError::Resume(why.into()));
        }
        let phase = scene.phases.get(saved.path.phase).or(scene.phases.last());
        let phase = phase.ok_or(ExperimentError::Resume("the scene has no phases".into()))?;
        let mut engine = Engine::from_packing(packing, phase_settings(&scene, phase))?;
        engine.set_time(saved.time)?;
        engine.set_rate(&saved.rate)?;
        engine.initialise()?;
        let observables = engine.observables()?;
        Ok(Self {
            friction: packing.friction,
            engine,
            path: saved.path,
            sequence: saved.sequence,
            packings: saved.packings,
            deformation: packing.deformation,
            phase_deformation: saved.phase_deformation,
            phase_strain: saved.phase_strain,
            strain_origin: saved.strain_origin,
            within_phase: saved.within_phase,
            observables,
            rollback: None,
            scene,
        })
    }

    /// The scene being run.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Position of the run on its path.
    pub fn path(&self) -> &PathState {
        &self.path
    }

    /// Whether the path is done.
    pub fn finished(&self) -> bool {
        self.path.phase >= self.scene.phases.len()
    }

    /// Number of packings due so far.
    pub fn packings(&self) -> u64 {
        self.packings
    }

    /// Sets instruction set and threads, on which results do not depend, and the flag that stops a computation.
    pub fn set_compute(&mut self, compute: Compute) {
        self.engine.set_compute(compute);
    }

    /// The engine.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// What the present phase leaves out of the model, and the operations saved, in one line; empty once the
    /// path is done.
    pub fn left_out(&self) -> String {
        let phase = self.path.phase(&self.scene);
        phase.map_or_else(String::new, |phase| left_out(&self.scene, phase, self.engine.equal_sized()))
    }

    /// The present request; `None` once the path is done.
    pub fn request(&self) -> Option<ServoRequest> {
        let phase = self.path.phase(&self.scene)?;
        let fixed = ServoLaw::Scaled { response_time: 1.0 };
        let law = if let PhaseKind::Servo { law, .. } = phase.kind { law } else { fixed };
        Some(ServoRequest {
            sequence: self.sequence,
            step: self.engine.steps(),
            time: self.engine.time(),
            phase: self.path.phase as u32,
            observables: self.observables,
            controls: phase.controls(),
            rate: self.engine.rate(),
            // A limit must be positive, also in a phase that imposes no rate.
            rate_limit: phase.kind.rate_limit().filter(|limit| *limit > 0.0).unwrap_or(1.0),
            law,
            control_interval: self.event_driven(phase).map_or(self.engine.time_step(), |gas| gas.step)
                * f64::from(phase.control_period),
            strain: SymTensor::logarithmic_strain(&self.deformation),
        })
    }

    /// Strains at `rate` (Voigt order, 1/s) for one control period. On failure, and if the flag of its compute settings is
    /// set, the run returns to a copy of its state at a request: the present one in an event-driven gas, else one at most a
    /// hundred steps and one control period ago. It goes on from there to the same bytes.
    pub fn advance(&mut self, rate: &[f64; 6]) -> Result<StepOutcome, ExperimentError> {
        let none = StepOutcome { ended: None, packing_due: false, finished: self.finished(), energy: None };
        let Some(phase) = self.path.phase(&self.scene) else { return Ok(none) };
        let period = phase.control_period;
        // Saved with the rate that its forces were evaluated with.
        self.save_rollback();
        self.engine.set_rate(rate)?;
        self.friction = self.engine.settings().friction;
        let compute = self.engine.compute().clone();
        compute.install(|| self.run_period(period)).inspect_err(|_| self.roll_back())
    }

    fn run_period(&mut self, period: u32) -> Result<StepOutcome, ExperimentError> {
        let (before, time) = (self.travelled(), self.engine.time());
        let gas = self.path.phase(&self.scene).and_then(|phase| self.event_driven(phase));
        let deformation = match gas {
            Some(gas) => self.run_event_driven(gas, period)?,
            None => self.engine.run(period)?,
        };
        self.accumulate(&deformation, self.engine.time() - time);
        self.engine.gather();
        self.observables = self.engine.observables()?;
        self.sequence += 1;
        let input = self.observation();
        let energy = self.engine.energy();
        let index = self.path.phase;
        let record = self.scene.phases[index].record;
        let packing_due = record.is_some_and(|r| r.is_due(&before, &self.travelled()));
        match self.path.observe(&self.scene, &input)? {
            PathEvent::Stay => {
                self.within_phase = true;
                if packing_due {
                    self.packings += 1;
                    // A failing run does not return beyond a packing that was published.
                    self.rollback = None;
                }
                Ok(StepOutcome { ended: None, packing_due, finished: false, energy })
            }
            PathEvent::PhaseEnded { reference, publish, finished } => {
                self.begin_phase(reference)?;
                let publish = publish || packing_due;
                // A state that is not published here is saved by an interruption alone, as the first of the next phase.
                self.within_phase = !publish;
                self.packings += u64::from(publish);
                let ended = Some(self.scene.phases[index].name.clone());
                Ok(StepOutcome { ended, packing_due: publish, finished, energy })
            }
        }
    }

    /// The present state, as the path evaluates it.
    fn observation(&self) -> Observation {
        Observation {
            time: self.engine.time(),
            stress: self.observables.stress.tensor,
            strain: SymTensor::logarithmic_strain(&self.phase_deformation),
            solid_fraction: self.observables.solid_fraction,
            unbalanced: self.observables.unbalanced,
            speed: self.engine.speed(),
        }
    }

    /// The conditions of the present phase that do not hold, each with its value and its bound, in one line; empty once the
    /// path is done.
    pub fn unmet(&self) -> String {
        self.path.unmet(&self.scene, &self.observation())
    }

    /// Share of the present phase that is done, 0 to 1; `None` if its end is not known beforehand.
    pub fn phase_share(&self) -> Option<f64> {
        self.path.phase_share(&self.scene, &self.observation())
    }

    /// Progress of the phase.
    fn travelled(&self) -> Travelled {
        let (steps, time) = (self.engine.steps(), self.engine.time() - self.path.began);
        Travelled { steps, time, strain: self.phase_strain }
    }

    /// Adds a deformation that took `interval` (s).
    fn accumulate(&mut self, deformation: &Mat3, interval: f64) {
        self.phase_strain += interval * self.engine.rate().iter().fold(0.0f64, |a, r| a.max(r.abs()));
        self.phase_deformation = deformation * self.phase_deformation;
        self.deformation = deformation * self.deformation;
    }

    /// Parameters of an event-driven phase; `None` in any other phase.
    ///
    /// The solver step is a mean free time at the present solid fraction and at the speed of the phase, but short enough not to
    /// exceed, in one control period, the solid fraction at which the phase ends.
    fn event_driven(&self, phase: &Phase) -> Option<EventDriven> {
        let PhaseKind::Gas { method: GasMethod::EventDriven, speed, rate, .. } = phase.kind else {
            return None;
        };
        let present = self.observables.solid_fraction;
        let mut step = mean_free_time(present, self.scene.sizes.mean(), speed);
        for condition in &phase.until.all {
            if let Condition::AtLeast(Measure::SolidFraction, wanted) = condition
                && *wanted > present
            {
                // Slightly more, so that rounding does not leave the condition unmet.
                let strain = (wanted / present).ln() / 3.0 + 1e-9;
                step = step.min(strain / -rate / f64::from(phase.control_period));
            }
        }
        Some(EventDriven { step, speed })
    }

    /// One control period of an event-driven phase.
    fn run_event_driven(&mut self, gas: EventDriven, period: u32) -> Result<Mat3, DemError> {
        let rate = self.engine.rate();
        if rate != [rate[0], rate[0], rate[0], 0.0, 0.0, 0.0] {
            let what = format!("a strain rate of {rate:?} 1/s is not isotropic");
            return Err(DemError::HardSpheres(what));
        }
        let old = self.engine.packing(Mat3::identity());
        let interval = gas.step * f64::from(period);
        let mut spheres =
            HardSpheres::new(old.cell, old.radii.clone(), old.positions.clone(), old.velocities.clone())?;
        let compute = self.engine.compute().clone();
        let (deformation, _) = spheres.advance_unless(rate[0], interval, &|| compute.is_stopped())?;
        spheres.apply_thermostat(gas.speed);
        let packing = Packing {
            step: old.step + u64::from(period),
            time: old.time + interval,
            time_step: gas.step,
            cell: *spheres.cell(),
            positions: spheres.positions().to_vec(),
            velocities: spheres.velocities().to_vec(),
            contacts: Vec::new(),
            ..old
        };
        self.engine = Engine::from_packing(&packing, *self.engine.settings())?;
        self.engine.set_compute(compute);
        self.engine.set_rate(&rate)?;
        self.engine.initialise()?;
        Ok(deformation)
    }

    /// Sets the engine to the present phase. Forces and stress are evaluated again, as in a resumed run, so that both give the
    /// same result.
    fn begin_phase(&mut self, reference: bool) -> Result<(), DemError> {
        // A failing phase does not return beyond its start, where a packing may have been published.
        self.rollback = None;
        (self.phase_deformation, self.phase_strain) = (Mat3::identity(), 0.0);
        if reference {
            self.strain_origin = StrainOrigin::Reference;
            self.deformation = Mat3::identity();
        }
        if let Some(phase) = self.path.phase(&self.scene) {
            self.engine.set_settings(phase_settings(&self.scene, phase))?;
            // A resumed run does not sort here, but its packing has the order of this one.
            self.engine.sort_spatially();
            self.engine.initialise()?;
            self.engine.update_time_step();
            self.engine.measure_energy(self.scene.numerics.energy_balance);
        }
        self.observables = self.engine.observables()?;
        Ok(())
    }

    /// The packing.
    pub fn packing(&self) -> Packing {
        Packing { friction: self.friction, ..self.engine.packing(self.deformation) }
    }

    /// The part of the state that is not in the packing. [`Simulation::resume`] takes both.
    pub fn run_state(&self) -> Vec<u8> {
        RunState {
            sequence: self.sequence,
            packings: self.packings,
            path: self.path,
            time: self.engine.time(),
            rate: self.engine.rate(),
            phase_deformation: self.phase_deformation,
            phase_strain: self.phase_strain,
            strain_origin: self.strain_origin,
            within_phase: self.within_phase,
            scene: fingerprint(&self.scene),
        }
        .encode()
    }

    fn save_rollback(&mut self) {
        // A period of hard spheres is long, and a copy is short beside it.
        let hard = self.path.phase(&self.scene).is_some_and(|phase| self.event_driven(phase).is_some());
        let due = |r: &Rollback| hard || self.engine.steps() - r.engine.step() >= ROLLBACK_INTERVAL;
        if self.rollback.as_ref().is_none_or(due) {
            self.rollback = Some(Rollback {
                engine: self.engine.checkpoint(),
                path: self.path,
                sequence: self.sequence,
                friction: self.friction,
                deformation: self.deformation,
                phase_deformation: self.phase_deformation,
                phase_strain: self.phase_strain,
                within_phase: self.within_phase,
                observables: self.observables,
            });
        }
    }

    fn roll_back(&mut self) {
        if let Some(saved) = self.rollback.take() {
            // It is a checkpoint of this engine.
            let _ = self.engine.restore(saved.engine);
            (self.path, self.sequence, self.friction) = (saved.path, saved.sequence, saved.friction);
            (self.deformation, self.phase_deformation) = (saved.deformation, saved.phase_deformation);
            (self.phase_strain, self.within_phase) = (saved.phase_strain, saved.within_phase);
            self.observables = saved.observables;
            // The forces of this state were valid when it was saved. If they fail now, the state is restored all the same.
            let _ = self.engine.initialise();
        }
    }
}

/// FNV-1a of the whole scene, seed included: a state can be resumed only in the scene that it came from.
fn fingerprint(scene: &Scene) -> u64 {
    let text = format!("{scene:?}");
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}
