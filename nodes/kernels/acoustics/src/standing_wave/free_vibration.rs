//! Free vibration of a supercell that starts with the velocities of plane waves.
//!
//! A wave with m periods in `copies` copies has its own Bloch wave vector. While contacts respond linearly,
//! waves of different m are independent of each other and of motions that are the same in all copies. All
//! waves are therefore excited at once, and the residual motion of the packing is in none of them.

use crate::contact_changes::ContactChanges;
use crate::error::AcousticsError;
use crate::supercell::Supercell;
use grainlab_core::Vec3;
use grainlab_dem::{Engine, EngineSettings};

/// Initial velocities and sampling.
#[derive(Clone, Copy, Debug)]
pub(super) struct Excitation<'a> {
    /// The packing, at rest.
    pub(super) supercell: &'a Supercell,
    /// Mass of each grain of one copy, kg; 0 for rattlers.
    pub(super) mass: &'a [f64],
    /// Engine settings, with a fixed time step.
    pub(super) setting: EngineSettings,
    /// Unit polarization.
    pub(super) polarization: Vec3,
    /// Two perpendicular polarizations of waves of another kind, unit vectors or zero.
    pub(super) transverse: [Vec3; 2],
    /// Velocity amplitude of each wave, m/s.
    pub(super) velocity: f64,
    /// Number of waves: those with 1, 2 … periods in the path.
    pub(super) waves: u32,
    /// Solver steps between samples.
    pub(super) stride: u32,
}

/// A vibrating supercell.
pub(super) struct FreeVibration<'a> {
    excitation: Excitation<'a>,
    engine: Engine,
    /// Weight of each grain in each wave's amplitude.
    weights: Vec<Vec<f64>>,
    /// Amplitude of each wave over time, m/s.
    pub(super) channels: Vec<Vec<f64>>,
    /// Sum of the squares of the longest wave's amplitude along the transverse polarizations, m²/s².
    transverse: f64,
    /// Contacts that opened or closed.
    pub(super) changes: ContactChanges,
}

impl<'a> FreeVibration<'a> {
    /// Sets the initial velocities and takes the first sample.
    pub(super) fn new(excitation: Excitation<'a>) -> Result<Self, AcousticsError> {
        let Excitation { supercell, mass, .. } = excitation;
        let mut shapes = Vec::new();
        let mut weights = Vec::new();
        for wave in 1..=excitation.waves {
            let q = supercell.wavenumber(wave);
            let carried = supercell.along.iter().zip(mass.iter().cycle());
            let shape: Vec<f64> = carried.map(|(x, m)| if *m > 0.0 { (q * x).cos() } else { 0.0 }).collect();
            let heavy: Vec<f64> = shape.iter().zip(mass.iter().cycle()).map(|(s, m)| s * m).collect();
            let sum: f64 = heavy.iter().zip(&shape).map(|(h, s)| h * s).sum();
            weights.push(heavy.iter().map(|h| h / sum).collect());
            shapes.push(shape);
        }
        let velocity = |g: usize| shapes.iter().map(|s| s[g]).sum::<f64>() * excitation.velocity;
        let velocities: Vec<Vec3> =
            (0..supercell.along.len()).map(|g| excitation.polarization * velocity(g)).collect();
        let mut engine = Engine::from_packing(&supercell.packing, excitation.setting)?;
        engine.update_time_step();
        engine.initialise()?;
        let changes = ContactChanges::since(&engine);
        engine.set_velocities(&velocities)?;
        let channels = vec![Vec::new(); excitation.waves as usize];
        let mut vibration = Self { excitation, engine, weights, channels, transverse: 0.0, changes };
        vibration.sample();
        Ok(vibration)
    }

    /// Time between samples, s.
    pub(super) fn interval(&self) -> f64 {
        f64::from(self.excitation.stride) * self.engine.time_step()
    }

    /// Time of the first sample, s: velocities are half a step behind.
    pub(super) fn start(&self) -> f64 {
        -0.5 * self.engine.time_step()
    }

    /// Wave number of the wave with `waves` periods in the path, rad/m.
    pub(super) fn wavenumber(&self, waves: u32) -> f64 {
        self.excitation.supercell.wavenumber(waves)
    }

    /// Number of samples so far.
    pub(super) fn samples(&self) -> usize {
        self.channels.first().map_or(0, Vec::len)
    }

    /// Runs until there are `samples`, and compares the contacts `looks` times.
    pub(super) fn run_until(&mut self, samples: usize, looks: usize) -> Result<(), AcousticsError> {
        let more = samples.saturating_sub(self.samples());
        let between = more.div_ceil(looks.max(1)).max(1);
        for k in 1..=more {
            self.engine.run(self.excitation.stride)?;
            self.sample();
            if k % between == 0 || k == more {
                self.changes.look(&self.engine);
            }
        }
        Ok(())
    }

    /// sin² of the angle between the polarization sent and that of its mode. With one mode of each kind the transverse
    /// motion of the longest wave is sin θ cos θ (cos ω₁t − cos ω₂t). The relative difference of ρv² of the mode and of
    /// the polarization sent is of this size.
    pub(super) fn misalignment(&self) -> f64 {
        self.transverse / self.samples().max(1) as f64 / self.excitation.velocity.powi(2)
    }

    fn sample(&mut self) {
        let Excitation { polarization, transverse, .. } = self.excitation;
        let velocities = self.engine.velocities();
        let mean: Vec3 = velocities.iter().zip(&self.weights[0]).map(|(v, w)| v * *w).sum();
        self.transverse += transverse.map(|a| a.dot(&mean).powi(2)).iter().sum::<f64>();
        let along: Vec<f64> = velocities.iter().map(|v| v.dot(&polarization)).collect();
        for (channel, weights) in self.channels.iter_mut().zip(&self.weights) {
            channel.push(along.iter().zip(weights).map(|(v, w)| v * w).sum());
        }
    }
}
