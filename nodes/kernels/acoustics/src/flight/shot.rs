//! One burst through one packing, by the particle engine.

use crate::error::AcousticsError;
use crate::flight::burst::Burst;
use crate::flight::slab::Slab;
use crate::instrument::Heard;
use crate::repeat::Repeated;
use grainlab_core::{Contact, Mat3, Vec3};
use grainlab_dem::{Engine, EngineSettings};
use std::collections::BTreeSet;

/// Looks at the contacts on the way.
const LOOKS: usize = 8;

/// Fewest moments a period of the centre frequency at which the receivers are heard.
const MOMENTS_PER_PERIOD: f64 = 64.0;

/// What is sent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shot<'a> {
    /// The packing, at rest.
    pub(crate) repeated: &'a Repeated,
    /// Which grains of one copy carry force.
    pub(crate) present: &'a [bool],
    /// Setting of the engine, its time step fixed.
    pub(crate) setting: EngineSettings,
    /// Unit particle motion.
    pub(crate) motion: Vec3,
    /// What the source does.
    pub(crate) burst: Burst,
    /// Peak strain that is wanted.
    pub(crate) amplitude: f64,
    /// Speed of the wave as far as it is known, m/s: the source's force is in proportion to its square.
    pub(crate) speed: f64,
    /// Thickness of source and receivers, m.
    pub(crate) thickness: f64,
    /// Places of the receivers along the path, from the source, m.
    pub(crate) receivers: &'a [f64],
    /// For how long the receivers listen, s.
    pub(crate) duration: f64,
    /// Samples a second that the instrument will take, Hz.
    pub(crate) rate: f64,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Answer {
    /// Particle velocities, m/s.
    pub(crate) heard: Heard,
    /// Distances from the middle of the source to that of each receiver, m.
    pub(crate) distances: Vec<f64>,
    /// Contacts that were gone at some look.
    pub(crate) opened: u32,
    /// Contacts that were new at some look.
    pub(crate) closed: u32,
}

impl Shot<'_> {
    /// Sends the burst and listens.
    pub(crate) fn sent(&self) -> Result<Answer, AcousticsError> {
        let source = self.slab(0.0)?;
        let receivers: Vec<Slab> = self.receivers.iter().map(|d| self.slab(*d)).collect::<Result<_, _>>()?;
        let mut engine = Engine::from_packing(&self.repeated.packing, self.setting);
        engine.update_time_step();
        engine.initialise()?;
        let step = engine.time_step();
        let mut changes = Changes::since(&engine);

        // A plane source of force per area f sends waves of velocity f/(2ρv) both ways.
        let acceleration = 2.0 * self.amplitude * self.speed * self.speed / self.thickness;
        let stride =
            (1.0 / (self.rate.max(MOMENTS_PER_PERIOD * self.burst.frequency) * step)).max(1.0) as u32;
        let moments = (self.duration / (f64::from(stride) * step)).ceil().max(1.0) as usize;
        let look = moments.div_ceil(LOOKS);
        let mut channels = vec![Vec::with_capacity(moments); receivers.len()];
        for moment in 0..moments {
            let elapsed = moment as f64 * f64::from(stride) * step;
            if elapsed < self.burst.duration() {
                for k in 0..stride {
                    let time = elapsed + f64::from(k) * step;
                    let by = self.motion * (acceleration * step * self.burst.at(time));
                    engine.add_velocities(source.kicks(by));
                    engine.step()?;
                }
            } else {
                engine.run(stride)?;
            }
            let velocities = engine.velocities();
            for (channel, slab) in channels.iter_mut().zip(&receivers) {
                channel.push(slab.velocity(&velocities, &self.motion));
            }
            if (moment + 1) % look == 0 {
                changes.look(&engine);
            }
        }
        Ok(Answer {
            heard: Heard { start: f64::from(stride) * step, interval: f64::from(stride) * step, channels },
            distances: self
                .receivers
                .iter()
                .zip(&receivers)
                .map(|(d, r)| d + r.offset - source.offset)
                .collect(),
            opened: changes.opened.len() as u32,
            closed: changes.closed.len() as u32,
        })
    }

    fn slab(&self, place: f64) -> Result<Slab, AcousticsError> {
        let missing = || AcousticsError::Setting {
            name: "thickness",
            value: self.thickness,
            requirement: "thick enough for grains in every slab",
        };
        Slab::new(self.repeated, self.present, place, self.thickness).ok_or_else(missing)
    }
}

type Key = (u32, u32, [i8; 3]);

/// Contacts that come and go.
#[derive(Clone, Debug, Default)]
struct Changes {
    quiet: BTreeSet<Key>,
    opened: BTreeSet<Key>,
    closed: BTreeSet<Key>,
}

impl Changes {
    fn since(engine: &Engine) -> Self {
        Self { quiet: keys(engine), ..Self::default() }
    }

    fn look(&mut self, engine: &Engine) {
        let now = keys(engine);
        self.opened.extend(self.quiet.difference(&now));
        self.closed.extend(now.difference(&self.quiet));
    }
}

fn keys(engine: &Engine) -> BTreeSet<Key> {
    let key = |c: &Contact| (c.i, c.j, c.image);
    engine.packing(Mat3::identity()).contacts.iter().map(key).collect()
}
