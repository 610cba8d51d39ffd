//! Relaxing grains to rest in a cell that stands still.
//!
//! Nothing moves a grain but the engine's own steps, so tangential springs see every displacement; only the drag is
//! steered. It follows Nesterov's momentum: t steps after a start a velocity keeps (t − 1)/(t + r − 1) of itself, and the
//! schedule starts over when the grains slow down (the speed restart of Su, Boyd & Candès, J. Mach. Learn. Res. 17, 153
//! (2016), who take r = 3 without restarts). As with a drag tuned to the softest mode, the number of steps grows with
//! stiffest over softest frequency, but nobody has to know that mode: at z = 5.1 it takes 1.4 to 1.6 times the
//! steps of the best constant drag, which is another one for every packing, and fewer than half that drag.

use grainlab_dem::{DemError, Engine, EngineSettings};

/// r of the schedule: of 1 to 3 the values from 1.25 to 1.5 take the fewest steps, 3 half as many again.
const R: f64 = 1.5;

/// The schedule stays at this t if the grains have not slowed down by then: the drag of a mode 1e3 times softer than the
/// stiffest. Spins without translation, which the speed does not show, are braked by it alone.
const LONGEST: u32 = 500;

/// Engines relaxed side by side under one schedule: what their states have in common cancels from differences at every
/// step, not only at the end.
#[derive(Clone, Debug)]
pub struct Relaxation {
    engines: Vec<Engine>,
    /// Steps since the schedule started.
    since: u32,
    /// Sum of the mean square speeds after the last step, m²/s².
    square_speed: f64,
}

impl Relaxation {
    /// Engines that share one time step, held fixed ([`grainlab_dem::TimeStep::Fixed`]) within the stability bound. Their drags
    /// are taken over.
    pub fn new(engines: Vec<Engine>) -> Self {
        Self { engines, since: 0, square_speed: 0.0 }
    }

    /// The engines.
    pub fn engines(&self) -> &[Engine] {
        &self.engines
    }

    /// The engines, to strain them on the way.
    pub fn engines_mut(&mut self) -> &mut [Engine] {
        &mut self.engines
    }

    /// One step of every engine.
    pub fn step(&mut self) -> Result<(), DemError> {
        self.since = (self.since + 1).min(LONGEST);
        let mut square_speed = 0.0;
        for engine in &mut self.engines {
            let drag = R / ((f64::from(self.since) + R - 1.0) * engine.time_step());
            engine.set_settings(EngineSettings { drag, spin_drag: drag, ..*engine.settings() });
            engine.step()?;
            square_speed += engine.speed().powi(2);
        }
        let slower = square_speed < self.square_speed;
        self.square_speed = if slower { 0.0 } else { square_speed };
        self.since = if slower { 0 } else { self.since };
        Ok(())
    }
}
