//! A scene run along its loading path, one request and one answer at a time.

use crate::checkpoint::Checkpoint;
use crate::compute::Compute;
use crate::engine::{Engine, Setting, TimeStep};
use crate::error::DemError;
use crate::event_driven::{HardSpheres, mean_free_time};
use crate::gas;
use crate::observe::Snapshot;
use crate::run_state::RunState;
use grainlab_core::{ComponentControl, Mat3, Packing, ServoLaw, SymTensor};
use grainlab_scene::{
    Condition, GasMethod, Measure, Observation, PathEvent, PathState, Phase, PhaseKind, Scene,
};

/// Solver steps between two copies of the state that a failing run is taken back to.
const KEEP_INTERVAL: u64 = 100;

/// A run: owns scene, path, engine and clock, and moves only when it is answered.
#[derive(Clone, Debug)]
pub struct Simulation {
    scene: Scene,
    engine: Engine,
    path: PathState,
    sequence: u64,
    packings: u64,
    /// Friction under which the present forces arose; at the end of a phase the engine is already set to the next.
    friction: f64,
    /// Deformation gradient since the reference state; the identity before there is one.
    deformation: Mat3,
    phase_deformation: Mat3,
    has_reference: bool,
    seen: Snapshot,
    kept: Option<Kept>,
}

/// What a failing run is taken back to.
#[derive(Clone, Debug)]
struct Kept {
    engine: Checkpoint,
    path: PathState,
    sequence: u64,
    friction: f64,
    deformation: Mat3,
    phase_deformation: Mat3,
    seen: Snapshot,
}

/// What the run asks: everything a servo needs to answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Counts requests from 0.
    pub sequence: u64,
    /// Solver steps done.
    pub step: u64,
    /// Simulated time, s.
    pub time: f64,
    /// Index of the phase under way.
    pub phase: u32,
    /// What the contacts say.
    pub snapshot: Snapshot,
    /// What is imposed on each component.
    pub controls: [ComponentControl; 6],
    /// Strain rate in force, Voigt order, 1/s.
    pub rate: [f64; 6],
    /// Largest magnitude of a component that the phase allows, 1/s.
    pub rate_limit: f64,
    /// Control law of the phase.
    pub law: ServoLaw,
    /// Simulated time until the next request, s.
    pub control_interval: f64,
    /// Logarithmic strain since the reference state.
    pub strain: SymTensor,
}

impl Request {
    /// What a servo is asked.
    pub fn question(&self) -> grainlab_servo::ServoInput {
        grainlab_servo::ServoInput {
            stress: self.snapshot.stress.tensor,
            controls: self.controls,
            rate: self.rate,
            rate_limit: self.rate_limit,
            law: self.law,
            tangent: self.snapshot.tangent,
            control_interval: self.control_interval,
        }
    }
}

/// An event-driven phase under way.
#[derive(Clone, Copy, Debug)]
struct EventDriven {
    /// Solver step, s.
    step: f64,
    /// Root mean square speed that the grains are kept from exceeding, m/s.
    speed: f64,
}

/// What an answer led to.
#[derive(Clone, Debug, PartialEq)]
pub struct Advanced {
    /// Name of the phase that ended, if one did.
    pub ended: Option<String>,
    /// The packing is due for publication.
    pub packing_due: bool,
    /// The path is done.
    pub finished: bool,
}

impl Simulation {
    /// The beginning of a scene: grains placed at random and agitated.
    pub fn new(scene: Scene) -> Result<Self, DemError> {
        let (fraction, speed) = match scene.phases.first().map(|p| &p.kind) {
            Some(PhaseKind::Gas { initial_solid_fraction, speed, .. }) => (*initial_solid_fraction, *speed),
            _ => return Err(DemError::Resume("the path does not begin with a gas phase".into())),
        };
        let gas = gas::place(scene.grains, scene.diameter, fraction, speed, scene.seed)?;
        let radii = vec![0.5 * scene.diameter; scene.grains as usize];
        let setting = setting(&scene, &scene.phases[0]);
        let mut engine = Engine::new(gas.cell, scene.material, radii, &gas.positions, setting);
        engine.set_velocities(&gas.velocities);
        engine.prepare()?;
        let seen = engine.snapshot()?;
        Ok(Self {
            friction: engine.setting().friction,
            scene,
            engine,
            path: PathState::START,
            sequence: 0,
            packings: 0,
            deformation: Mat3::identity(),
            phase_deformation: Mat3::identity(),
            has_reference: false,
            seen,
            kept: None,
        })
    }

    /// Goes on from a packing and the run state it was published with.
    pub fn resume(scene: Scene, packing: &Packing, run_state: &[u8]) -> Result<Self, DemError> {
        let saved = RunState::decode(run_state)?;
        if saved.scene != fingerprint(&scene) {
            return Err(DemError::Resume("the packing belongs to another scene or seed".into()));
        }
        let phase = scene.phases.get(saved.path.phase).or(scene.phases.last());
        let phase = phase.ok_or(DemError::Resume("the scene has no phases".into()))?;
        let mut engine = Engine::from_packing(packing, setting(&scene, phase));
        engine.state.time = saved.time;
        engine.set_rate(&saved.rate)?;
        engine.prepare()?;
        let seen = engine.snapshot()?;
        Ok(Self {
            friction: packing.friction,
            engine,
            path: saved.path,
            sequence: saved.sequence,
            packings: saved.packings,
            deformation: packing.deformation,
            phase_deformation: saved.phase_deformation,
            has_reference: saved.has_reference,
            seen,
            kept: None,
            scene,
        })
    }

    /// The scene being run.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Where the run stands.
    pub fn path(&self) -> &PathState {
        &self.path
    }

    /// Whether the path is done.
    pub fn finished(&self) -> bool {
        self.path.phase >= self.scene.phases.len()
    }

    /// Packings that were due so far.
    pub fn packings(&self) -> u64 {
        self.packings
    }

    /// Instruction set and threads from now on; results do not depend on them.
    pub fn set_compute(&mut self, compute: Compute) {
        self.engine.set_compute(compute);
    }

    /// The engine, read only.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// The present request; `None` once the path is done.
    pub fn request(&self) -> Option<Request> {
        let phase = self.path.phase(&self.scene)?;
        let fixed = ServoLaw::Scaled { response_time: 1.0 };
        let (law, rate_limit) = match phase.kind {
            PhaseKind::Servo { law, rate_limit, .. } => (law, rate_limit),
            PhaseKind::Gas { rate, .. } => (fixed, rate.abs()),
            PhaseKind::Strain { rate } => (fixed, rate.iter().fold(0.0f64, |a, r| a.max(r.abs()))),
            PhaseKind::Relax => (fixed, 0.0),
        };
        Some(Request {
            sequence: self.sequence,
            step: self.engine.steps(),
            time: self.engine.time(),
            phase: self.path.phase as u32,
            snapshot: self.seen,
            controls: phase.controls(),
            rate: self.engine.rate(),
            // A limit must be positive; a phase that imposes nothing allows anything.
            rate_limit: if rate_limit > 0.0 { rate_limit } else { 1.0 },
            law,
            control_interval: self.event_driven(phase).map_or(self.engine.time_step(), |gas| gas.step)
                * f64::from(phase.control_period),
            strain: logarithmic_strain(&self.deformation),
        })
    }

    /// Obeys one answer: strains at `rate` (Voigt order, 1/s) for one control period. On failure the run is back at the
    /// last state kept, at most a hundred steps and one control period ago.
    pub fn answer(&mut self, rate: &[f64; 6]) -> Result<Advanced, DemError> {
        let none = Advanced { ended: None, packing_due: false, finished: self.finished() };
        let Some(phase) = self.path.phase(&self.scene) else { return Ok(none) };
        let period = phase.control_period;
        // Kept as it was asked: with the rate that its forces arose under.
        self.keep();
        self.engine.set_rate(rate)?;
        self.friction = self.engine.setting().friction;
        let compute = self.engine.compute().clone();
        match compute.within(|| self.advance(period)) {
            Ok(advanced) => Ok(advanced),
            Err(e) => {
                self.go_back();
                Err(e)
            }
        }
    }

    fn advance(&mut self, period: u32) -> Result<Advanced, DemError> {
        let gas = self.path.phase(&self.scene).and_then(|phase| self.event_driven(phase));
        let stretch = match gas {
            Some(gas) => self.collide(gas, period)?,
            None => self.engine.run(period)?,
        };
        self.deform(&stretch);
        self.engine.settle();
        self.seen = self.engine.snapshot()?;
        self.sequence += 1;
        let seen = Observation {
            time: self.engine.time(),
            stress: self.seen.stress.tensor,
            strain: logarithmic_strain(&self.phase_deformation),
            solid_fraction: self.seen.solid_fraction,
            unbalanced: self.seen.unbalanced,
            speed: self.engine.speed(),
        };
        let before = self.path.phase;
        match self.path.observe(&self.scene, &seen)? {
            PathEvent::Stay => Ok(Advanced { ended: None, packing_due: false, finished: false }),
            PathEvent::PhaseEnded { reference, publish, finished } => {
                self.begin_phase(reference)?;
                self.packings += u64::from(publish);
                let ended = Some(self.scene.phases[before].name.clone());
                Ok(Advanced { ended, packing_due: publish, finished })
            }
        }
    }

    fn deform(&mut self, stretch: &Mat3) {
        self.phase_deformation = stretch * self.phase_deformation;
        if self.has_reference {
            self.deformation = stretch * self.deformation;
        }
    }

    /// What an event-driven phase does next; `None` in any other phase.
    ///
    /// Its solver step is a mean free time at the present solid fraction and at the speed of the phase, but no longer
    /// than leads, in one control period, to the solid fraction that the phase waits for.
    fn event_driven(&self, phase: &Phase) -> Option<EventDriven> {
        let PhaseKind::Gas { method: GasMethod::EventDriven, speed, rate, .. } = phase.kind else {
            return None;
        };
        let present = self.seen.solid_fraction;
        let mut step = mean_free_time(present, self.scene.diameter, speed);
        for condition in &phase.until.all {
            if let Condition::AtLeast(Measure::SolidFraction, wanted) = condition
                && *wanted > present
            {
                // A hair beyond, so that rounding does not leave the condition unmet.
                let strain = (wanted / present).ln() / 3.0 + 1e-9;
                step = step.min(strain / -rate / f64::from(phase.control_period));
            }
        }
        Some(EventDriven { step, speed })
    }

    /// One control period of an event-driven phase.
    fn collide(&mut self, gas: EventDriven, period: u32) -> Result<Mat3, DemError> {
        let rate = self.engine.rate();
        if rate != [rate[0], rate[0], rate[0], 0.0, 0.0, 0.0] {
            let what = format!("a strain rate of {rate:?} 1/s is not isotropic");
            return Err(DemError::HardSpheres(what));
        }
        let old = self.engine.packing(Mat3::identity());
        let interval = gas.step * f64::from(period);
        let mut spheres =
            HardSpheres::new(old.cell, old.radii.clone(), old.positions.clone(), old.velocities.clone())?;
        let (stretch, _) = spheres.advance(rate[0], interval)?;
        spheres.limit_speed(gas.speed);
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
        let compute = self.engine.compute().clone();
        self.engine = Engine::from_packing(&packing, *self.engine.setting());
        self.engine.set_compute(compute);
        self.engine.set_rate(&rate)?;
        self.engine.prepare()?;
        Ok(stretch)
    }

    /// Takes up the setting of the phase now under way. Forces and stress are evaluated anew with it, as a resumed run
    /// would, so that both go on alike.
    fn begin_phase(&mut self, reference: bool) -> Result<(), DemError> {
        // A failing phase is not taken back beyond its beginning, where a packing may have been published.
        self.kept = None;
        self.phase_deformation = Mat3::identity();
        if reference {
            self.has_reference = true;
            self.deformation = Mat3::identity();
        }
        if let Some(phase) = self.path.phase(&self.scene) {
            self.engine.set(setting(&self.scene, phase));
            // Grains have moved; here a resumed run, which does not pass here, cannot differ.
            self.engine.sort();
            self.engine.prepare()?;
            self.engine.renew_time_step();
        }
        self.seen = self.engine.snapshot()?;
        Ok(())
    }

    /// The mechanical state.
    pub fn packing(&self) -> Packing {
        Packing { friction: self.friction, ..self.engine.packing(self.deformation) }
    }

    /// The rest of the state, to go with the packing: [`Simulation::resume`] takes both.
    pub fn run_state(&self) -> Vec<u8> {
        RunState {
            sequence: self.sequence,
            packings: self.packings,
            path: self.path,
            time: self.engine.time(),
            rate: self.engine.rate(),
            phase_deformation: self.phase_deformation,
            has_reference: self.has_reference,
            scene: fingerprint(&self.scene),
        }
        .encode()
    }

    fn keep(&mut self) {
        let due = |k: &Kept| self.engine.steps() - k.engine.step() >= KEEP_INTERVAL;
        if self.kept.as_ref().is_none_or(due) {
            self.kept = Some(Kept {
                engine: self.engine.checkpoint(),
                path: self.path,
                sequence: self.sequence,
                friction: self.friction,
                deformation: self.deformation,
                phase_deformation: self.phase_deformation,
                seen: self.seen,
            });
        }
    }

    fn go_back(&mut self) {
        if let Some(kept) = self.kept.take() {
            self.engine.restore(kept.engine);
            (self.path, self.sequence, self.friction) = (kept.path, kept.sequence, kept.friction);
            (self.deformation, self.phase_deformation) = (kept.deformation, kept.phase_deformation);
            self.seen = kept.seen;
            // The state was prepared when it was kept; should it fail now, it still is what is saved.
            let _ = self.engine.prepare();
        }
    }
}

fn setting(scene: &Scene, phase: &Phase) -> Setting {
    Setting {
        friction: phase.friction,
        damping: phase.damping,
        drag: phase.drag,
        spin_drag: phase.spin_drag,
        tangential: scene.numerics.tangential,
        time_step: TimeStep::Safety(scene.numerics.time_step_safety),
        skin: scene.numerics.skin * scene.diameter,
        speed_cap: match phase.kind {
            PhaseKind::Gas { speed, .. } => Some(speed),
            _ => None,
        },
    }
}

/// FNV-1a of everything the scene says, seed included: a state resumes only into the scene it came from.
fn fingerprint(scene: &Scene) -> u64 {
    let text = format!("{scene:?}");
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// ln V of F = V R, positive in extension.
fn logarithmic_strain(f: &Mat3) -> SymTensor {
    let left = (f * f.transpose()).symmetric_eigen();
    let logs = left.eigenvalues.map(|v| 0.5 * v.ln());
    let q = left.eigenvectors;
    SymTensor::symmetric_part(&(q * Mat3::from_diagonal(&logs) * q.transpose()))
}
