//! Time of a step per grain of a compressed packing, ns: to compare two builds on one machine, or contact laws: `step_speed
//! rough:1e-8,1`.

use grainlab_core::Packing;
use grainlab_core::contact::ContactLaw;
use grainlab_dem::{Engine, gas};
use grainlab_engine::{EngineSettings, TimeStep};
use std::time::Instant;

const GRAINS: usize = 2000;
const RADIUS: f64 = 1e-4;

fn main() -> Result<(), grainlab_core::contact::UnknownLaw> {
    let law: ContactLaw = std::env::args().nth(1).map_or(Ok(ContactLaw::default()), |law| law.parse())?;
    for friction in [0.0, 0.3] {
        let settings = EngineSettings {
            friction,
            damping: 0.2,
            skin: 0.1 * RADIUS,
            time_step: TimeStep::FractionOfStable(0.5),
            ..EngineSettings::default()
        };
        let radii = vec![RADIUS; GRAINS];
        let gas = gas::random_placement(&radii, 0.35, 0.1, 7).unwrap();
        let velocities = gas.velocities;
        let packing = Packing { law, velocities, ..Packing::at_rest(gas.cell, radii, gas.positions) };
        let mut engine = Engine::from_packing(&packing, settings).unwrap();
        engine.set_rate(&[-900.0, -1100.0, -1000.0, 0.0, 0.0, 0.0]).unwrap();
        engine.sort_spatially();
        engine.initialise().unwrap();
        while engine.observables().unwrap().solid_fraction < 0.66 {
            engine.run(100).unwrap();
        }
        engine.set_rate(&[0.0; 6]).unwrap();
        engine.run(2000).unwrap();
        let mut best = f64::INFINITY;
        for _ in 0..40 {
            let start = Instant::now();
            engine.run(200).unwrap();
            best = best.min(start.elapsed().as_secs_f64() / 200.0 / GRAINS as f64);
        }
        let coordination = engine.observables().unwrap().coordination;
        println!(
            "friction {friction}: {:.2} ns per grain and step, coordination {coordination:.2}",
            1e9 * best
        );
    }
    Ok(())
}
