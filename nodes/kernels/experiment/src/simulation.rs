//! A scene run along its loading path.

use crate::error::ExperimentError;
use crate::gas::{EventDriven, at_random, is_event_driven};
use crate::phase_settings::phase_settings;
use crate::progress::{Progress, solid_fraction};
use crate::run_state::{RunState, SavedEngine, belongs};
use grainlab_core::{Mat3, Packing, PathPosition, ServoLaw, StrainOrigin, SymTensor};
use grainlab_dem::Dem;
use grainlab_engine::{Compute, EnergyBalance, EngineFactory, Observables, ParticleEngine};
use grainlab_scene::{PathState, PhaseEnded, PhaseKind, Scene, Travelled};
use grainlab_servo::{ServoInput, ServoRequest};
use std::sync::Arc;

/// Solver steps between two copies of the state that a failing run returns to.
const ROLLBACK_INTERVAL: u64 = 100;

/// A run: scene, path, engine and clock. It advances only when it is given a strain rate.
#[derive(Debug)]
pub struct Simulation {
    scene: Scene,
    factory: Arc<dyn EngineFactory>,
    compute: Compute,
    engine: Box<dyn ParticleEngine>,
    progress: Progress,
    /// Step and progress of the state that the engine has kept.
    rollback: Option<(u64, Progress)>,
    /// The packing that the run was resumed from is of another program than its engine.
    another_program: bool,
}

/// The result of one control period.
#[derive(Clone, Debug, PartialEq)]
pub struct StepOutcome {
    /// Name of the phase that ended, if one did.
    pub ended: Option<String>,
    /// The packing is due for publication.
    pub packing_due: bool,
    /// The path is done.
    pub finished: bool,
    /// Energy balance since the start of the phase, if the scene asks for it.
    pub energy: Option<EnergyBalance>,
}

impl Simulation {
    /// The start of a scene: grains placed at random with thermal velocities.
    pub fn new(scene: Scene) -> Result<Self, ExperimentError> {
        Self::with_engine(scene, Arc::new(Dem::default()), None)
    }

    /// The start of a scene whose path begins with this packing. Its clock and its strain are set to 0.
    pub fn from_packing(scene: Scene, packing: &Packing) -> Result<Self, ExperimentError> {
        Self::at_start(scene, Arc::new(Dem::default()), packing)
    }

    /// Resumes from a packing and the run state that was published with it.
    pub fn resume(scene: Scene, packing: &Packing, run_state: &[u8]) -> Result<Self, ExperimentError> {
        Self::resumed(scene, Arc::new(Dem::default()), packing, run_state)
    }

    /// A run with engines of `factory`, which take over where an event-driven gas ends: from grains at random, from a packing
    /// with the run state that was published with it, or at the start of a path that begins with a packing (no run state). A
    /// packing that another engine made is taken without what only that engine knows.
    ///
    /// # Errors
    /// A state that the engine does not take, and one of another scene or version.
    pub fn with_engine(
        scene: Scene,
        factory: Arc<dyn EngineFactory>,
        from: Option<(&Packing, &[u8])>,
    ) -> Result<Self, ExperimentError> {
        match from {
            None => Self::at_random(scene, factory),
            Some((packing, [])) if scene.start.is_some() => Self::at_start(scene, factory, packing),
            Some((packing, run_state)) => Self::resumed(scene, factory, packing, run_state),
        }
    }

    fn at_random(scene: Scene, factory: Arc<dyn EngineFactory>) -> Result<Self, ExperimentError> {
        let packing = at_random(&scene)?;
        let mut run = Self::at(scene, factory, &packing, None, 0, &[0.0; 6])?;
        run.measure_energy();
        run.progress.within_phase = true;
        Ok(run)
    }

    fn at_start(
        scene: Scene,
        factory: Arc<dyn EngineFactory>,
        packing: &Packing,
    ) -> Result<Self, ExperimentError> {
        // The time step of the packing was set under other settings.
        let start = Packing { step: 0, time: 0.0, time_step: 0.0, ..packing.clone() };
        let mut run = Self::at(scene, factory, &start, None, 0, &[0.0; 6])?;
        run.measure_energy();
        run.progress.friction = packing.friction;
        // It is published before the first request.
        run.progress.packings = 1;
        Ok(run)
    }

    /// The start of the path, with the engine of a phase (of the last one, once the path is done) at `rate` (1/s).
    fn at(
        scene: Scene,
        factory: Arc<dyn EngineFactory>,
        start: &Packing,
        own_state: Option<Vec<u8>>,
        phase: usize,
        rate: &[f64; 6],
    ) -> Result<Self, ExperimentError> {
        let phase = scene.phases.get(phase).or(scene.phases.last());
        let phase = phase.ok_or(ExperimentError::Resume("the scene has no phases".into()))?;
        let (settings, compute) = (phase_settings(&scene, phase), Compute::default());
        let (ours, is_gas) = (Dem::default(), is_event_driven(phase));
        let maker: &dyn EngineFactory = if is_gas { &ours } else { &*factory };
        let engine = match own_state {
            Some(state) => maker.resume(start, &state, &settings, rate, &compute)?,
            None => maker.start(start, &settings, rate, &compute)?,
        };
        let observables = engine.observables()?;
        let progress = Progress {
            path: PathState::START,
            sequence: 0,
            packings: 0,
            friction: settings.friction,
            deformation: Mat3::identity(),
            phase_deformation: Mat3::identity(),
            phase_strain: 0.0,
            strain_origin: StrainOrigin::FirstStep,
            within_phase: false,
            observables,
            solid_fraction: solid_fraction(&scene, &observables),
        };
        Ok(Self { scene, factory, compute, engine, progress, rollback: None, another_program: false })
    }

    fn resumed(
        scene: Scene,
        factory: Arc<dyn EngineFactory>,
        packing: &Packing,
        run_state: &[u8],
    ) -> Result<Self, ExperimentError> {
        let saved = RunState::decode(run_state)?;
        if saved.scene != scene.fingerprint {
            return Err(ExperimentError::Resume("the packing belongs to another scene or seed".into()));
        }
        // The stamp of a recorded packing has whole nanoseconds.
        if (packing.time - saved.time).abs() > 1e-9 {
            let (at, of) = (packing.time, saved.time);
            let why =
                format!("the packing is of {at} s, and the run state of {of} s: they do not belong together");
            return Err(ExperimentError::Resume(why));
        }
        if packing.strain().is_none() {
            let why = "the packing has no strain since the first step; begin the run anew";
            return Err(ExperimentError::Resume(why.into()));
        }
        belongs(packing, &scene)?;
        let start = Packing { time: saved.time, ..packing.clone() };
        let same = saved.engine.as_ref().filter(|e| Some(e.program.name.as_str()) == factory.name());
        let own_state = same.map(SavedEngine::own_state).transpose()?;
        let mut run = Self::at(scene, factory, &start, own_state, saved.phase, &saved.rate)?;
        let made_by = saved.engine.as_ref().map(|engine| &engine.program);
        run.another_program = made_by != run.engine.program() && !packing.contacts.is_empty();
        run.progress = Progress {
            path: PathState { phase: saved.phase, began: saved.began, holding_since: saved.holding_since },
            sequence: saved.sequence,
            packings: saved.packings,
            friction: packing.friction,
            deformation: packing.deformation,
            phase_deformation: saved.phase_deformation.into(),
            phase_strain: saved.phase_strain,
            strain_origin: saved.strain_origin,
            within_phase: saved.within_phase,
            ..run.progress
        };
        Ok(run)
    }

    /// Switches the energy balance on, if the scene asks for it. Hard spheres that only collide have none.
    fn measure_energy(&mut self) {
        let hard = self.progress.path.phase(&self.scene).is_some_and(is_event_driven);
        self.engine.measure_energy(self.scene.numerics.energy_balance && !hard);
    }

    /// A second run in the same state, for steps with a predicted strain rate; `None` if the engine cannot.
    pub fn fork(&self) -> Option<Self> {
        Some(Self {
            scene: self.scene.clone(),
            factory: self.factory.clone(),
            compute: self.compute.clone(),
            engine: self.engine.fork()?,
            progress: self.progress,
            rollback: self.rollback,
            another_program: self.another_program,
        })
    }

    /// Gives the first request of a run that another program goes on with the number `next`: those with lower numbers are recorded,
    /// and would have other stresses now.
    pub fn number_requests_from(&mut self, next: u64) {
        if self.another_program {
            self.progress.sequence = self.progress.sequence.max(next);
        }
    }

    /// The scene being run.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Position of the run on its path.
    pub fn path(&self) -> &PathState {
        &self.progress.path
    }

    /// True once the path is done.
    pub fn finished(&self) -> bool {
        self.progress.path.phase >= self.scene.phases.len()
    }

    /// Number of packings due so far.
    pub fn packings(&self) -> u64 {
        self.progress.packings
    }

    /// Sets threads, on which results do not depend, and the flag that stops a computation.
    pub fn set_compute(&mut self, compute: Compute) {
        self.engine.set_compute(&compute);
        self.compute = compute;
    }

    /// Engine that moves the grains.
    pub fn engine(&self) -> &dyn ParticleEngine {
        &*self.engine
    }

    /// Parts of the model that the present phase leaves out, in one line; empty once the path is done.
    pub fn left_out(&self) -> String {
        match self.progress.path.phase(&self.scene) {
            None => String::new(),
            Some(phase) if is_event_driven(phase) => {
                "without the contact law and spins: hard spheres, from collision to collision".into()
            }
            Some(_) => self.engine.left_out(),
        }
    }

    /// The present request; `None` once the path is done.
    pub fn request(&self) -> Option<ServoRequest> {
        let phase = self.progress.path.phase(&self.scene)?;
        let fixed = ServoLaw::Scaled { response_time: 1.0 };
        let law = if let PhaseKind::Servo { law, .. } = phase.kind { law } else { fixed };
        let (p, seen) = (&self.progress, &self.progress.observables);
        let gas = EventDriven::of(&self.scene, phase, p.solid_fraction);
        Some(ServoRequest {
            sequence: p.sequence,
            step: self.engine.steps(),
            time: self.engine.time(),
            phase: p.path.phase as u32 + 1,
            input: ServoInput {
                stress: seen.stress.tensor,
                controls: phase.controls(),
                rate: self.engine.rate(),
                // A limit must be positive, also in a phase that imposes no rate.
                rate_limit: phase.kind.rate_limit().filter(|limit| *limit > 0.0).unwrap_or(1.0),
                law,
                tangent: seen.tangent,
                control_interval: gas.map_or(self.engine.time_step(), |gas| gas.step)
                    * f64::from(phase.control_period),
            },
            asymmetry: seen.stress.asymmetry,
            strain: SymTensor::logarithmic_strain(&p.deformation),
            solid_fraction: p.solid_fraction,
            coordination: 2.0 * f64::from(seen.contacts) / f64::from(self.scene.grains),
            unbalanced: seen.unbalanced,
        })
    }

    /// One exchange with the servo as a function call: answers the present request, and [advances](Self::advance). `None` once the
    /// path is done.
    pub fn exchange(&mut self) -> Result<Option<StepOutcome>, ExperimentError> {
        let Some(request) = self.request() else { return Ok(None) };
        self.advance(&grainlab_servo::control(&request.input)?.rate).map(Some)
    }

    /// Strains at `rate` (Voigt order, 1/s) for one control period. On failure, and if the flag of its compute settings is
    /// set, the run returns to a copy of its state at a request: the present one in an event-driven gas, else one at most a
    /// hundred steps and one control period ago. It goes on from there to the same bytes.
    pub fn advance(&mut self, rate: &[f64; 6]) -> Result<StepOutcome, ExperimentError> {
        let none = StepOutcome { ended: None, packing_due: false, finished: self.finished(), energy: None };
        let Some(phase) = self.progress.path.phase(&self.scene) else { return Ok(none) };
        let period = phase.control_period;
        let before = self.travelled();
        let time = self.engine.time();
        if let Some(gas) = EventDriven::of(&self.scene, phase, self.progress.solid_fraction) {
            // Nothing changes before the whole period is known to be sound.
            let (engine, deformation) = gas.advance(&*self.engine, period, rate, &self.compute)?;
            let observables = engine.observables()?;
            let (progress, event) = self.observed(&*engine, time, &deformation, observables)?;
            self.engine = engine;
            return self.proceed(progress, event, &before);
        }
        // Saved with the rate that its forces were evaluated with.
        self.save_rollback();
        self.engine.set_rate(rate)?;
        self.run_period(period, time, &before).inspect_err(|_| self.roll_back())
    }

    fn run_period(
        &mut self,
        period: u32,
        time: f64,
        before: &Travelled,
    ) -> Result<StepOutcome, ExperimentError> {
        let (deformation, observables) = self.engine.run(period)?;
        let (progress, event) = self.observed(&*self.engine, time, &deformation, observables)?;
        self.proceed(progress, event, before)
    }

    /// The progress after `engine` has deformed since `time`, and the event of the path there.
    fn observed(
        &self,
        engine: &dyn ParticleEngine,
        time: f64,
        deformation: &Mat3,
        observables: Observables,
    ) -> Result<(Progress, Option<PhaseEnded>), ExperimentError> {
        let old = &self.progress;
        let interval = engine.time() - time;
        let mut next = Progress {
            sequence: old.sequence + 1,
            friction: engine.settings().friction,
            deformation: deformation * old.deformation,
            phase_deformation: deformation * old.phase_deformation,
            phase_strain: old.phase_strain
                + interval * engine.rate().iter().fold(0.0f64, |a, r| a.max(r.abs())),
            observables,
            solid_fraction: solid_fraction(&self.scene, &observables),
            ..*old
        };
        let seen = next.observation(engine.time());
        let event = next.path.observe(&self.scene, &seen)?;
        Ok((next, event))
    }

    /// Adopts the progress, and begins the next phase if one ended.
    fn proceed(
        &mut self,
        progress: Progress,
        event: Option<PhaseEnded>,
        before: &Travelled,
    ) -> Result<StepOutcome, ExperimentError> {
        let PathState { phase: index, began, .. } = self.progress.path;
        self.progress = progress;
        let energy = self.engine.energy();
        let travelled = self.travelled_since(began);
        let record = self.scene.phases[index].record;
        let packing_due = record.is_some_and(|r| r.is_due(before, &travelled));
        match event {
            None => {
                self.progress.within_phase = true;
                if packing_due {
                    self.progress.packings += 1;
                    // A failing run does not return beyond a packing that was published.
                    self.rollback = None;
                }
                Ok(StepOutcome { ended: None, packing_due, finished: false, energy })
            }
            Some(PhaseEnded { reference, publish, finished }) => {
                self.begin_phase(index, reference)?;
                let publish = publish || packing_due;
                // A state that is not published here is saved by an interruption alone, as the first of the next phase.
                self.progress.within_phase = !publish;
                self.progress.packings += u64::from(publish);
                let ended = Some(self.scene.phases[index].name.clone());
                Ok(StepOutcome { ended, packing_due: publish, finished, energy })
            }
        }
    }

    /// Counts the present packing as the end of the phase that has just ended, as if it had been due.
    pub fn end_phase_here(&mut self) {
        self.progress.within_phase = false;
    }

    fn travelled(&self) -> Travelled {
        self.travelled_since(self.progress.path.began)
    }

    fn travelled_since(&self, began: f64) -> Travelled {
        let (steps, time) = (self.engine.steps(), self.engine.time() - began);
        Travelled { steps, time, strain: self.progress.phase_strain }
    }

    /// The conditions of the present phase that do not hold, each with its value and its bound, in one line; empty once the
    /// path is done.
    pub fn unmet(&self) -> String {
        self.progress.path.unmet(&self.scene, &self.progress.observation(self.engine.time()))
    }

    /// Share of the present phase that is done, 0 to 1; `None` if its end is not known beforehand.
    pub fn phase_share(&self) -> Option<f64> {
        self.progress.path.phase_share(&self.scene, &self.progress.observation(self.engine.time()))
    }

    fn begin_phase(&mut self, ended: usize, reference: bool) -> Result<(), ExperimentError> {
        // A failing phase does not return beyond its start, where a packing may have been published.
        self.rollback = None;
        (self.progress.phase_deformation, self.progress.phase_strain) = (Mat3::identity(), 0.0);
        if reference {
            self.progress.strain_origin = StrainOrigin::Reference;
            self.progress.deformation = Mat3::identity();
        }
        if let Some(phase) = self.progress.path.phase(&self.scene) {
            let settings = phase_settings(&self.scene, phase);
            if is_event_driven(&self.scene.phases[ended]) && !is_event_driven(phase) {
                let packing = self.engine.packing(self.progress.deformation)?;
                self.engine = self.factory.start(&packing, &settings, &self.engine.rate(), &self.compute)?;
            }
            self.engine.begin_phase(&settings)?;
            self.measure_energy();
        }
        self.progress.observables = self.engine.observables()?;
        self.progress.solid_fraction = solid_fraction(&self.scene, &self.progress.observables);
        Ok(())
    }

    /// Present state of the grains.
    ///
    /// # Errors
    /// An engine that does not answer.
    pub fn packing(&self) -> Result<Packing, ExperimentError> {
        let (p, engine) = (&self.progress, self.engine.program().cloned());
        let path = PathPosition::new(p.path.phase, p.within_phase, p.strain_origin, engine);
        Ok(Packing { friction: p.friction, path: Some(path), ..self.engine.packing(p.deformation)? })
    }

    /// The part of the state that is not in the packing. [`Simulation::resume`] takes both.
    ///
    /// # Errors
    /// An engine that does not answer.
    pub fn run_state(&self) -> Result<Vec<u8>, ExperimentError> {
        let p = &self.progress;
        let own_state = self.engine.own_state()?;
        Ok(RunState {
            version: RunState::CURRENT,
            scene: self.scene.fingerprint,
            sequence: p.sequence,
            packings: p.packings,
            phase: p.path.phase,
            began: p.path.began,
            holding_since: p.path.holding_since,
            time: self.engine.time(),
            rate: self.engine.rate(),
            phase_deformation: p.phase_deformation.into(),
            phase_strain: p.phase_strain,
            strain_origin: p.strain_origin,
            within_phase: p.within_phase,
            engine: self.engine.program().map(|program| SavedEngine::new(program, &own_state)),
        }
        .encode())
    }

    fn save_rollback(&mut self) {
        let step = self.engine.steps();
        if self.rollback.is_none_or(|(saved, _)| step - saved >= ROLLBACK_INTERVAL) {
            self.rollback = self.engine.save().then_some((step, self.progress));
        }
    }

    fn roll_back(&mut self) {
        if let Some((_, saved)) = self.rollback.take()
            && self.engine.restore()
        {
            self.progress = saved;
        }
    }
}
