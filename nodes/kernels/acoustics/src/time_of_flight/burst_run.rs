//! One burst through one supercell, by the particle engine.

use super::burst::Burst;
use super::slab::Slab;
use crate::contact_changes::ContactChanges;
use crate::error::AcousticsError;
use crate::instrument::ReceiverSignals;
use crate::supercell::Supercell;
use grainlab_core::Vec3;
use grainlab_dem::{Engine, EngineSettings};

/// Number of comparisons of the contacts.
const LOOKS: usize = 8;

/// Least number of samples per period of the centre frequency.
const SAMPLES_PER_PERIOD: f64 = 64.0;

/// Source, receivers and sampling of one burst.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BurstRun<'a> {
    /// The packing, at rest.
    pub(crate) supercell: &'a Supercell,
    /// For each grain of one copy, whether it carries force.
    pub(crate) present: &'a [bool],
    /// Engine settings, with a fixed time step.
    pub(crate) setting: EngineSettings,
    /// Unit polarization.
    pub(crate) polarization: Vec3,
    /// Signal of the source.
    pub(crate) burst: Burst,
    /// Peak strain of the wave.
    pub(crate) amplitude: f64,
    /// Approximate speed of the wave, m/s: the force of the source is proportional to its square.
    pub(crate) speed: f64,
    /// Thickness of source and receivers, m.
    pub(crate) thickness: f64,
    /// Distances of the receivers from the source along the path, m.
    pub(crate) receivers: &'a [f64],
    /// Duration of the recording, s.
    pub(crate) duration: f64,
    /// Sampling rate of the instrument, Hz.
    pub(crate) rate: f64,
}

/// The signals at the receivers.
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

impl BurstRun<'_> {
    /// Sends the burst and records the receivers.
    pub(crate) fn response(&self) -> Result<BurstResponse, AcousticsError> {
        let source = self.slab(0.0)?;
        let receivers: Vec<Slab> = self.receivers.iter().map(|d| self.slab(*d)).collect::<Result<_, _>>()?;
        let mut engine = Engine::from_packing(&self.supercell.packing, self.setting)?;
        engine.update_time_step();
        engine.initialise()?;
        let step = engine.time_step();
        let mut changes = ContactChanges::since(&engine);

        // A plane source of force per area f sends waves of velocity f/(2ρv) in both directions.
        let acceleration = 2.0 * self.amplitude * self.speed * self.speed / self.thickness;
        let stride =
            (1.0 / (self.rate.max(SAMPLES_PER_PERIOD * self.burst.frequency) * step)).max(1.0) as u32;
        let samples = (self.duration / (f64::from(stride) * step)).ceil().max(1.0) as usize;
        let look = samples.div_ceil(LOOKS);
        let mut channels = vec![Vec::with_capacity(samples); receivers.len()];
        for sample in 0..samples {
            let elapsed = sample as f64 * f64::from(stride) * step;
            if elapsed < self.burst.duration() {
                for k in 0..stride {
                    let time = elapsed + f64::from(k) * step;
                    let by = self.polarization * (acceleration * step * self.burst.at(time));
                    engine.add_velocities(source.kicks(by))?;
                    engine.step()?;
                }
            } else {
                engine.run(stride)?;
            }
            let velocities = engine.velocities();
            for (channel, slab) in channels.iter_mut().zip(&receivers) {
                channel.push(slab.velocity(&velocities, &self.polarization));
            }
            if (sample + 1) % look == 0 {
                changes.look(&engine);
            }
        }
        Ok(BurstResponse {
            signals: ReceiverSignals {
                start: f64::from(stride) * step,
                interval: f64::from(stride) * step,
                channels,
            },
            distances: self
                .receivers
                .iter()
                .zip(&receivers)
                .map(|(d, r)| d + r.offset - source.offset)
                .collect(),
            opened: changes.opened(),
            closed: changes.closed(),
        })
    }

    fn slab(&self, place: f64) -> Result<Slab, AcousticsError> {
        let missing = || AcousticsError::Setting {
            name: "thickness",
            value: self.thickness,
            requirement: "thick enough for grains in every slab",
        };
        Slab::new(self.supercell, self.present, place, self.thickness).ok_or_else(missing)
    }
}
