//! The timed loop.

use super::super::packing::replicated;
use crate::cpu_time::process_seconds;
use clap::ValueEnum;
use grainlab_console::Failure;
use grainlab_core::contact::TangentialLaw;
use grainlab_core::{ComponentControl, Mat3, Packing, ServoLaw, SymTensor};
use grainlab_dem::{Compute, Engine, EngineSettings, Simd, TimeStep, roofline};
use grainlab_node_kit::Exit;
use serde::Serialize;
use std::time::Instant;

/// Contact damping, share of critical: a coefficient of restitution of about 0.3.
const DAMPING: f64 = 0.3;
/// Of a packing that states none, as in the runs of the other programs, s.
const TIME_STEP: f64 = 3e-8;
/// Relative change of the number of contacts from which the packing counts as another one.
const CHANGED: f64 = 0.02;
/// Verlet skin over the largest diameter: a packing at rest does not use it up.
const SKIN: f64 = 0.01;
/// Strain rate limit of the compression without friction, 1/s, and its maximum number of steps.
const PRESS_RATE: f64 = 100.0;
const PRESS_STEPS: u32 = 1_000_000;
/// Steps between two returns of the engine without a servo: the control period of the scenes.
const PERIOD: u32 = 20;

/// The parts of the contact law that are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Features {
    /// No spins, no tangential springs.
    Frictionless,
    /// Tangential springs with the Coulomb limit.
    Coulomb,
    /// Tangential springs without it.
    Stuck,
}

impl Features {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Frictionless => "frictionless",
            Self::Coulomb => "coulomb",
            Self::Stuck => "stuck",
        }
    }

    /// Those that a packing of this friction has.
    pub(crate) fn of(friction: f64) -> Self {
        match friction {
            0.0 => Self::Frictionless,
            f64::INFINITY => Self::Stuck,
            _ => Self::Coulomb,
        }
    }

    fn friction(self, packing: &Packing) -> f64 {
        match self {
            Self::Frictionless => 0.0,
            Self::Coulomb => packing.friction,
            Self::Stuck => f64::INFINITY,
        }
    }
}

/// One case.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    /// Copies of the packing along each axis.
    pub(crate) copies: u32,
    pub(crate) grains: u64,
    pub(crate) threads: u32,
    pub(crate) features: Features,
    pub(crate) simd: Simd,
    pub(crate) servo: bool,
    pub(crate) steps: u32,
}

/// Results of one loop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Loop {
    pub(crate) wall_seconds: f64,
    /// Sum over all threads.
    pub(crate) cpu_seconds: f64,
    /// Mean of the values before and after.
    pub(crate) contacts: f64,
    /// Mean stress at the end, Pa.
    pub(crate) pressure: f64,
    /// Resident memory that the engine added.
    pub(crate) bytes: Option<f64>,
}

/// The packings to step. A frictional packing would collapse without friction, so that each has its own.
pub(crate) struct Packings {
    given: Packing,
    /// The given one compressed to the same pressure without friction, if needed.
    frictionless: Option<Packing>,
    /// Pressure of both, Pa: the servo's target.
    pressure: f64,
}

impl Packings {
    /// Compresses the packing again if `features` need it.
    pub(crate) fn new(given: Packing, features: &[Features]) -> Result<Self, Failure> {
        let pressure = grainlab_core::stress::stress(&given).tensor.mean();
        if pressure <= 0.0 {
            let message = format!("the packing carries no pressure ({pressure} Pa); press it first");
            return Err(Failure::new(Exit::PhysicsInvalid, message));
        }
        let own = Features::of(given.friction);
        if own != Features::Coulomb && features.contains(&Features::Coulomb) {
            let (friction, own) = (given.friction, own.name());
            return Err(Failure::usage(format!(
                "--features coulomb: the packing has friction {friction}, which it keeps; its own features are {own}"
            )));
        }
        let wanted = own != Features::Frictionless && features.contains(&Features::Frictionless);
        let frictionless = if wanted { Some(pressed_without_friction(&given, pressure)?) } else { None };
        Ok(Self { given, frictionless, pressure })
    }

    fn of(&self, features: Features) -> &Packing {
        let frictionless = self.frictionless.as_ref().filter(|_| features == Features::Frictionless);
        frictionless.unwrap_or(&self.given)
    }
}

fn setting(features: Features, packing: &Packing) -> EngineSettings {
    let diameter = 2.0 * packing.radii.iter().copied().fold(0.0, f64::max);
    EngineSettings {
        friction: features.friction(packing),
        damping: DAMPING,
        drag: 0.0,
        spin_drag: 0.0,
        tangential: TangentialLaw::Rescaled,
        time_step: TimeStep::Fixed(if packing.time_step > 0.0 { packing.time_step } else { TIME_STEP }),
        skin: SKIN * diameter,
        thermostat_speed: None,
    }
}

/// Floating-point operations of the contact law per contact.
pub(crate) fn operations_per_contact(packing: &Packing, case: &Case) -> f64 {
    roofline::operations_per_contact(packing.law, &setting(case.features, packing))
}

fn invalid(error: grainlab_dem::DemError) -> Failure {
    Failure::new(Exit::PhysicsInvalid, error)
}

fn pressed_without_friction(packing: &Packing, pressure: f64) -> Result<Packing, Failure> {
    let mut engine =
        Engine::from_packing(packing, setting(Features::Frictionless, packing)).map_err(invalid)?;
    engine.initialise().map_err(invalid)?;
    while engine.steps() - packing.step < u64::from(PRESS_STEPS) {
        engine.run(PERIOD).map_err(invalid)?;
        let seen = engine.observables().map_err(invalid)?;
        let stress = seen.stress.tensor;
        if (stress.mean() / pressure - 1.0).abs() < 0.01 && seen.unbalanced < 0.05 {
            return Ok(engine.packing(Mat3::identity()));
        }
        let interval = f64::from(PERIOD) * engine.time_step();
        let rate = answered(stress, pressure, engine.rate(), PRESS_RATE, seen.tangent, interval)?;
        engine.set_rate(&rate).map_err(invalid)?;
    }
    let message = format!(
        "without friction the packing did not come to rest at {pressure:e} Pa in {PRESS_STEPS} steps"
    );
    Err(Failure::new(Exit::PhysicsInvalid, message))
}

/// The strain rate that leads to an isotropic pressure.
fn answered(
    stress: SymTensor,
    pressure: f64,
    rate: [f64; 6],
    rate_limit: f64,
    tangent: [f64; 6],
    control_interval: f64,
) -> Result<[f64; 6], Failure> {
    let target = |c| ComponentControl::Stress(if c < 3 { pressure } else { 0.0 });
    let request = grainlab_servo::ServoInput {
        stress,
        controls: std::array::from_fn(target),
        rate,
        rate_limit,
        law: ServoLaw::Scaled { response_time: 2e-6 },
        tangent: Some(tangent),
        control_interval,
    };
    grainlab_servo::control(&request).map(|a| a.rate).map_err(Failure::failed)
}

/// Builds an engine, warms it up for a tenth of the steps, and times it.
pub(crate) fn run(packings: &Packings, case: &Case) -> Result<Loop, Failure> {
    let packing = packings.of(case.features);
    let compute = Compute::new(case.simd, case.threads as usize).map_err(Failure::usage)?;
    let copies = replicated(packing, case.copies)
        .ok_or_else(|| Failure::failed("the cell of the copies is invalid"))?;
    let before = super::machine::resident_bytes();
    let mut engine = Engine::from_packing(&copies, setting(case.features, packing)).map_err(invalid)?;
    drop(copies);
    engine.set_compute(compute.clone());
    engine.sort_spatially();
    engine.initialise().map_err(invalid)?;
    let at_first = f64::from(engine.observables().map_err(invalid)?.contacts);
    advance(&mut engine, &compute, case, packings.pressure, case.steps.div_ceil(10))?;
    let bytes = before.zip(super::machine::resident_bytes()).map(|(b, a)| (a - b).max(0.0));

    let contacts = f64::from(engine.observables().map_err(invalid)?.contacts);
    let (wall, cpu) = (Instant::now(), process_seconds()?);
    advance(&mut engine, &compute, case, packings.pressure, case.steps)?;
    let (wall_seconds, cpu_seconds) = (wall.elapsed().as_secs_f64(), process_seconds()? - cpu);
    let seen = engine.observables().map_err(invalid)?;
    let at_last = f64::from(seen.contacts);
    if (at_last / at_first - 1.0).abs() > CHANGED {
        let [first, last] = [at_first, at_last].map(|contacts| 2.0 * contacts / case.grains as f64);
        let message = format!(
            "the packing is not the one given: its coordination number went from {first:.3} to {last:.3} in {} steps, which \
             is more than {:.0} %, so that no rate is stated; relax it first, or take fewer --steps",
            case.steps + case.steps.div_ceil(10),
            100.0 * CHANGED
        );
        return Err(Failure::new(Exit::PhysicsInvalid, message));
    }
    let contacts = 0.5 * (contacts + at_last);
    Ok(Loop { wall_seconds, cpu_seconds, contacts, pressure: seen.stress.tensor.mean(), bytes })
}

fn advance(
    engine: &mut Engine,
    compute: &Compute,
    case: &Case,
    pressure: f64,
    steps: u32,
) -> Result<(), Failure> {
    if !case.servo {
        return compute.install(|| {
            for begin in (0..steps).step_by(PERIOD as usize) {
                engine.run(PERIOD.min(steps - begin)).map_err(invalid)?;
            }
            Ok(())
        });
    }
    // The stiffness hardly changes during the loop: the law uses that at its start.
    let tangent = engine.observables().map_err(invalid)?.tangent;
    compute.install(|| {
        for _ in 0..steps {
            let mut stress = SymTensor::isotropic(0.0);
            engine.run_with_stress(1, |s| stress = s).map_err(invalid)?;
            let rate = answered(stress, pressure, engine.rate(), 1.0, tangent, engine.time_step())?;
            engine.set_rate(&rate).map_err(invalid)?;
        }
        Ok(())
    })
}
