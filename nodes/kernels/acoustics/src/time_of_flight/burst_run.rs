//! One burst through one supercell, by the particle engine.

use super::burst::Burst;
use super::path_plan::PathPlan;
use super::slab::Slab;
use super::wave_path::WavePath;
use crate::error::AcousticsError;
use crate::instrument::ReceiverSignals;
use crate::sample::Sample;
use crate::supercell::supercell;
use grainlab_core::{Contact, Mat3};
use grainlab_dem::Engine;
use std::collections::BTreeSet;

/// Number of comparisons of the contacts.
const LOOKS: usize = 8;

/// Least number of samples per period of the centre frequency.
const SAMPLES_PER_PERIOD: f64 = 64.0;

/// Thickness of source and receivers along the ray, mean diameters.
const THICKNESS: f64 = 2.0;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BurstResponse {
    /// Particle velocities, m/s.
    pub(crate) signals: ReceiverSignals,
    /// Distances from the middle of the source to that of each receiver, m.
    pub(crate) distances: Vec<f64>,
    /// Number of contacts that were missing in at least one comparison.
    pub(crate) opened: u32,
    /// Number of contacts that were new in at least one comparison.
    pub(crate) closed: u32,
}

/// Sends `burst` along `path` with the peak strain `amplitude`, and records the receivers for an instrument of the sampling rate `rate`, Hz.
/// `speed`: approximate speed of the wave, m/s; the force of the source is proportional to its square.
pub(crate) fn send(
    path: &WavePath,
    sample: &Sample,
    plan: &PathPlan,
    burst: &Burst,
    amplitude: f64,
    speed: f64,
    rate: f64,
) -> Result<BurstResponse, AcousticsError> {
    let supercell = supercell(&sample.packing, path.indices, plan.copies)?;
    let thickness = THICKNESS * sample.diameter;
    let slab = |place: &f64| {
        let requirement = "thick enough for grains in every slab";
        let missing = AcousticsError::Setting { name: "thickness", value: thickness, requirement };
        Slab::new(&supercell, &sample.present, *place, thickness).ok_or(missing)
    };
    let source = slab(&0.0)?;
    let receivers: Vec<Slab> = plan.receivers.iter().map(slab).collect::<Result<_, _>>()?;
    let mut engine = Engine::from_packing(&supercell.packing, sample.setting)?;
    engine.update_time_step();
    engine.initialise()?;
    let step = engine.time_step();
    let start = contacts(&engine);
    let (mut opened, mut closed) = (BTreeSet::new(), BTreeSet::new());

    // A plane source of force per area f sends waves of velocity f/(2ρv) in both directions.
    let acceleration = 2.0 * amplitude * speed * speed / thickness;
    let stride = (1.0 / (rate.max(SAMPLES_PER_PERIOD * burst.frequency) * step)).max(1.0) as u32;
    let samples = (plan.duration / (f64::from(stride) * step)).ceil().max(1.0) as usize;
    let look = samples.div_ceil(LOOKS);
    let mut channels = vec![Vec::with_capacity(samples); receivers.len()];
    for sample in 0..samples {
        let elapsed = sample as f64 * f64::from(stride) * step;
        if elapsed < burst.duration() {
            for k in 0..stride {
                let time = elapsed + f64::from(k) * step;
                let by = path.polarization * (acceleration * step * burst.at(time));
                engine.add_velocities(source.kicks(by))?;
                engine.step()?;
            }
        } else {
            engine.run(stride)?;
        }
        let velocities = engine.velocities();
        for (channel, slab) in channels.iter_mut().zip(&receivers) {
            channel.push(slab.velocity(&velocities, &path.polarization));
        }
        if (sample + 1) % look == 0 {
            let now = contacts(&engine);
            opened.extend(start.difference(&now).copied());
            closed.extend(now.difference(&start).copied());
        }
    }
    let interval = f64::from(stride) * step;
    let distances =
        plan.receivers.iter().zip(&receivers).map(|(d, r)| d + r.offset - source.offset).collect();
    let signals = ReceiverSignals { start: interval, interval, channels };
    Ok(BurstResponse { signals, distances, opened: opened.len() as u32, closed: closed.len() as u32 })
}

fn contacts(engine: &Engine) -> BTreeSet<(u32, u32, [i8; 3])> {
    let key = |c: &Contact| (c.i, c.j, c.image);
    engine.packing(Mat3::identity()).contacts.iter().map(key).collect()
}
