//! Relaxation of grains to rest in a fixed cell.
//!
//! Grains move only by the steps of the engine, so that tangential springs follow every displacement; only
//! the drag is adapted. It follows Nesterov's momentum: t steps after a start a velocity is multiplied by (t
//! − 1)/(t + r − 1), and the schedule restarts when the grains slow down (the speed restart of Su, Boyd &
//! Candès, J. Mach. Learn. Res. 17, 153 (2016), who use r = 3 without restarts). The number of steps is
//! proportional to the ratio of the stiffest to the softest frequency, as for a drag tuned to the softest
//! mode, but that mode need not be known. At z = 5.1 it takes 1.4 to 1.6 times the steps of the best constant
//! drag, which differs between packings, and fewer than half of that drag.

use grainlab_dem::Engine;
use grainlab_engine::{EngineError, EngineSettings};

/// r of the schedule: between 1 and 3, values from 1.25 to 1.5 take the fewest steps; 3 takes half as many
/// again.
const R: f64 = 1.5;

/// The schedule stays at this t if the grains have not slowed down by then: the drag of a mode 1e3 times
/// softer than the stiffest. Spins without translation do not contribute to the speed and are damped only by
/// this drag.
const LONGEST: u32 = 500;

/// Engines relaxed in parallel under one schedule: common errors of their states cancel from differences at
/// every step.
#[derive(Clone, Debug)]
pub struct Relaxation {
    /// The engines, to look at and to strain during the relaxation.
    pub engines: Vec<Engine>,
    /// Steps since the schedule started.
    since: u32,
    /// Sum of the mean square speeds after the last step, m²/s².
    square_speed: f64,
}

impl Relaxation {
    /// Engines with the same fixed time step ([`grainlab_engine::TimeStep::Fixed`]) within the stability bound.
    /// The drags of the engines are replaced.
    pub fn new(engines: Vec<Engine>) -> Self {
        Self { engines, since: 0, square_speed: 0.0 }
    }

    /// One step of every engine.
    pub fn step(&mut self) -> Result<(), EngineError> {
        self.since = (self.since + 1).min(LONGEST);
        let mut square_speed = 0.0;
        for engine in &mut self.engines {
            let drag = R / ((f64::from(self.since) + R - 1.0) * engine.time_step());
            engine.set_settings(EngineSettings { drag, spin_drag: drag, ..*engine.settings() })?;
            engine.step()?;
            square_speed += engine.speed().powi(2);
        }
        let slower = square_speed < self.square_speed;
        self.square_speed = if slower { 0.0 } else { square_speed };
        self.since = if slower { 0 } else { self.since };
        Ok(())
    }
}
