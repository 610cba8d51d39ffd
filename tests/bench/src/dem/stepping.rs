//! The timed loop.

use super::super::packing::replicated;
use crate::cpu_time::process_seconds;
use clap::ValueEnum;
use grainlab_console::Failure;
use grainlab_core::{ComponentControl, Packing, ServoLaw, SymTensor};
use grainlab_dem::{Engine, Simd};
use grainlab_engine::{Compute, EngineSettings, TimeStep};
use grainlab_node_kit::Exit;
use serde::Serialize;
use std::time::Instant;

/// Contact damping, share of critical: a coefficient of restitution of about 0.3.
const DAMPING: f64 = 0.3;
/// Time step of a packing that states none, as in the runs of the other programs, s.
const TIME_STEP: f64 = 3e-8;
/// Relative change of the number of contacts from which the packing counts as another one.
const CHANGED: f64 = 0.02;
/// Verlet skin over the largest diameter: a packing at rest does not use it up.
const SKIN: f64 = 0.01;
/// Steps between two returns of the engine without a servo: the control period of the scenes.
const PERIOD: u32 = 20;

/// The parts of the contact law that are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Features {
    /// No spins, no tangential springs: a packing without friction.
    Frictionless,
    /// Tangential springs with the Coulomb limit.
    Coulomb,
    /// Tangential springs without it.
    Stuck,
}

impl Features {
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map(|v| v.get_name().to_owned()).unwrap_or_default()
    }

    /// Those that a packing of this friction has.
    pub(crate) fn of(friction: f64) -> Self {
        match friction {
            0.0 => Self::Frictionless,
            f64::INFINITY => Self::Stuck,
            _ => Self::Coulomb,
        }
    }

    /// True if a packing of this friction can be stepped with them: other grains would collapse.
    pub(crate) fn fits(self, friction: f64) -> bool {
        self == Self::Stuck || self == Self::of(friction)
    }

    fn friction(self, packing: &Packing) -> f64 {
        match self {
            Self::Frictionless => 0.0,
            Self::Coulomb => packing.friction,
            Self::Stuck => f64::INFINITY,
        }
    }
}

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

/// Pressure of the packing, Pa: the servo's target.
pub(crate) fn pressure(packing: &Packing) -> Result<f64, Failure> {
    let pressure = grainlab_core::stress::stress(packing).tensor.mean();
    if pressure <= 0.0 {
        let message = format!("the packing carries no pressure ({pressure} Pa); press it first");
        return Err(Failure::new(Exit::PhysicsInvalid, message));
    }
    Ok(pressure)
}

fn setting(features: Features, packing: &Packing) -> EngineSettings {
    let diameter = 2.0 * packing.radii.iter().copied().fold(0.0, f64::max);
    EngineSettings {
        friction: features.friction(packing),
        damping: DAMPING,
        time_step: TimeStep::Fixed(if packing.time_step > 0.0 { packing.time_step } else { TIME_STEP }),
        skin: SKIN * diameter,
        ..EngineSettings::default()
    }
}

fn invalid(error: grainlab_engine::EngineError) -> Failure {
    Failure::new(Exit::PhysicsInvalid, error)
}

/// The strain rate that leads to an isotropic pressure.
fn answered(
    stress: SymTensor,
    pressure: f64,
    rate: [f64; 6],
    tangent: [f64; 6],
    control_interval: f64,
) -> Result<[f64; 6], Failure> {
    let target = |c| ComponentControl::Stress(if c < 3 { pressure } else { 0.0 });
    let request = grainlab_servo::ServoInput {
        stress,
        controls: std::array::from_fn(target),
        rate,
        rate_limit: 1.0,
        law: ServoLaw::Scaled { response_time: 2e-6 },
        tangent: Some(tangent),
        control_interval,
    };
    grainlab_servo::control(&request).map(|a| a.rate).map_err(Failure::failed)
}

/// Builds an engine, warms it up for a tenth of the steps, and times it.
pub(crate) fn run(packing: &Packing, pressure: f64, case: &Case) -> Result<Loop, Failure> {
    let simd = case.simd.if_available().map_err(Failure::usage)?;
    let compute = Compute::new(case.threads as usize).map_err(Failure::usage)?;
    let copies = replicated(packing, case.copies)?;
    let before = resident_bytes();
    let mut engine = Engine::from_packing(&copies, setting(case.features, packing)).map_err(invalid)?;
    drop(copies);
    engine.set_simd(simd);
    engine.set_compute(compute.clone());
    engine.sort_spatially();
    engine.initialise().map_err(invalid)?;
    let at_first = f64::from(engine.observables().map_err(invalid)?.contacts);
    advance(&mut engine, &compute, case, pressure, case.steps.div_ceil(10))?;
    let bytes = before.zip(resident_bytes()).map(|(b, a)| (a - b).max(0.0));

    let contacts = f64::from(engine.observables().map_err(invalid)?.contacts);
    let (wall, cpu) = (Instant::now(), process_seconds()?);
    advance(&mut engine, &compute, case, pressure, case.steps)?;
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
            let rate = answered(stress, pressure, engine.rate(), tangent, engine.time_step())?;
            engine.set_rate(&rate).map_err(invalid)?;
        }
        Ok(())
    })
}

/// Memory of this process in use, bytes; `None` where the system does not report it.
fn resident_bytes() -> Option<f64> {
    #[cfg(target_env = "gnu")]
    // SAFETY: no pointers are involved; only free memory is returned to the system.
    unsafe {
        libc::malloc_trim(0);
    }
    // Counted page by page; statm omits memory that a core has not reported yet.
    let rollup = std::fs::read_to_string("/proc/self/smaps_rollup").ok()?;
    let line = rollup.lines().find(|l| l.starts_with("Rss:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024.0 * kilobytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_that_is_touched_shows() {
        let Some(before) = resident_bytes() else { return };
        let block = std::hint::black_box(vec![1u8; 64 << 20]);
        let after = resident_bytes().unwrap();
        assert!(after - before > (32 << 20) as f64, "{before} {after} {}", block.len());
    }
}
