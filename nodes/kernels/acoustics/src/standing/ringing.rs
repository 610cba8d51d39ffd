//! How a repeated packing rings after a start with the velocities of plane waves.
//!
//! A wave with m periods in `copies` copies has its own Bloch class: while contacts answer in proportion, waves of different
//! m know nothing of each other, nor of what all copies do alike. So all start at once, and the packing's own residual motion is
//! in none of them.

use crate::error::AcousticsError;
use crate::repeat::Repeated;
use grainlab_core::{Contact, Mat3, Vec3};
use grainlab_dem::{Engine, EngineSettings};
use std::collections::BTreeSet;

/// What is struck.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strike<'a> {
    /// The packing, at rest.
    pub(crate) repeated: &'a Repeated,
    /// Mass of each grain of one copy, kg; 0 if it carries no force.
    pub(crate) mass: &'a [f64],
    /// Setting of the engine, its time step fixed.
    pub(crate) setting: EngineSettings,
    /// Unit particle motion.
    pub(crate) motion: Vec3,
    /// Two perpendicular motions, unit or zero, that a wave of another kind would have.
    pub(crate) aside: [Vec3; 2],
    /// Velocity amplitude of each wave, m/s.
    pub(crate) velocity: f64,
    /// The waves are those with 1, 2 … periods in the path, up to this.
    pub(crate) waves: u32,
    /// Solver steps between samples.
    pub(crate) stride: u32,
}

/// A packing that rings.
pub(crate) struct Ringing<'a> {
    strike: Strike<'a>,
    engine: Engine,
    /// Weight of each grain in each wave's amplitude.
    weights: Vec<Vec<f64>>,
    /// Amplitude of each wave over time, m/s.
    pub(crate) channels: Vec<Vec<f64>>,
    /// Sum of the squares of the longest wave's amplitude along the motions aside, m²/s².
    aside: f64,
    quiet: BTreeSet<Key>,
    /// Contacts that were gone at some look, and that were new.
    opened: BTreeSet<Key>,
    closed: BTreeSet<Key>,
}

type Key = (u32, u32, [i8; 3]);

impl<'a> Ringing<'a> {
    /// Strikes it.
    pub(crate) fn new(strike: Strike<'a>) -> Result<Self, AcousticsError> {
        let Strike { repeated, mass, .. } = strike;
        let mut shapes = Vec::new();
        let mut weights = Vec::new();
        for wave in 1..=strike.waves {
            let q = repeated.wavenumber(wave);
            let carried = repeated.along.iter().zip(mass.iter().cycle());
            let shape: Vec<f64> = carried.map(|(x, m)| if *m > 0.0 { (q * x).cos() } else { 0.0 }).collect();
            let heavy: Vec<f64> = shape.iter().zip(mass.iter().cycle()).map(|(s, m)| s * m).collect();
            let sum: f64 = heavy.iter().zip(&shape).map(|(h, s)| h * s).sum();
            weights.push(heavy.iter().map(|h| h / sum).collect());
            shapes.push(shape);
        }
        let velocity = |g: usize| shapes.iter().map(|s| s[g]).sum::<f64>() * strike.velocity;
        let velocities: Vec<Vec3> = (0..repeated.along.len()).map(|g| strike.motion * velocity(g)).collect();
        let mut engine = Engine::from_packing(&repeated.packing, strike.setting);
        engine.update_time_step();
        engine.initialise()?;
        let quiet = keys(&engine);
        engine.set_velocities(&velocities);
        let mut ringing = Self {
            strike,
            engine,
            weights,
            channels: vec![Vec::new(); strike.waves as usize],
            aside: 0.0,
            quiet,
            opened: BTreeSet::new(),
            closed: BTreeSet::new(),
        };
        ringing.hear();
        Ok(ringing)
    }

    /// Time between samples, s.
    pub(crate) fn interval(&self) -> f64 {
        f64::from(self.strike.stride) * self.engine.time_step()
    }

    /// Time of the first sample, s: velocities are half a step behind.
    pub(crate) fn start(&self) -> f64 {
        -0.5 * self.engine.time_step()
    }

    /// Wave number of the wave with `waves` periods in the path, rad/m.
    pub(crate) fn wavenumber(&self, waves: u32) -> f64 {
        self.strike.repeated.wavenumber(waves)
    }

    /// Samples so far.
    pub(crate) fn samples(&self) -> usize {
        self.channels.first().map_or(0, Vec::len)
    }

    /// Goes on until there are `samples`.
    pub(crate) fn listen(&mut self, samples: usize, looks: usize) -> Result<(), AcousticsError> {
        let more = samples.saturating_sub(self.samples());
        let between = more.div_ceil(looks.max(1)).max(1);
        for k in 1..=more {
            self.engine.run(self.strike.stride)?;
            self.hear();
            if k % between == 0 || k == more {
                self.look();
            }
        }
        Ok(())
    }

    /// Contacts that were gone at some look, and contacts that were new.
    pub(crate) fn changes(&self) -> (u32, u32) {
        (self.opened.len() as u32, self.closed.len() as u32)
    }

    /// sin² of the angle between the motion sent and that of the mode it is meant for: with one mode of each kind the longest
    /// wave's motion aside is sin θ cos θ (cos ω₁t − cos ω₂t). By about so much of itself ρv² of the mode is not that of the
    /// motion.
    pub(crate) fn aside(&self) -> f64 {
        self.aside / self.samples().max(1) as f64 / self.strike.velocity.powi(2)
    }

    fn hear(&mut self) {
        let Strike { motion, aside, .. } = self.strike;
        let velocities = self.engine.velocities();
        let mean: Vec3 = velocities.iter().zip(&self.weights[0]).map(|(v, w)| v * *w).sum();
        self.aside += aside.map(|a| a.dot(&mean).powi(2)).iter().sum::<f64>();
        let along: Vec<f64> = velocities.iter().map(|v| v.dot(&motion)).collect();
        for (channel, weights) in self.channels.iter_mut().zip(&self.weights) {
            channel.push(along.iter().zip(weights).map(|(v, w)| v * w).sum());
        }
    }

    fn look(&mut self) {
        let now = keys(&self.engine);
        self.opened.extend(self.quiet.difference(&now));
        self.closed.extend(now.difference(&self.quiet));
    }
}

fn keys(engine: &Engine) -> BTreeSet<Key> {
    let key = |c: &Contact| (c.i, c.j, c.image);
    engine.packing(Mat3::identity()).contacts.iter().map(key).collect()
}
