//! An instrument of your own: sends wave speeds, and prints what the inversion infers from them. It takes part in the graph as every
//! other node.
//!
//! `cargo run --release -p grainlab_node_kit --example node`, with `grainlab run emt_inversion` in another terminal. `grainlab new node
//! NAME --rust` writes it as a crate.

use grainlab_msgs::geometry_msgs::Vector3;
use grainlab_msgs::msg::{Microstructure, WaveSpeed, WaveSpeeds};
use grainlab_msgs::{Exit, topics, wall_stamp};
use grainlab_node_kit::{
    Bus, Demand, Health, Next, Node, NodeError, NodeSpec, Publisher, RosArgs, Scope, Subscription, run_node,
};
use std::process::ExitCode;
use std::time::Duration;

/// Glass beads under 50 kPa, axis vertical: direction, polarization, and speed in m/s, with an error of 0.3 %.
fn measured() -> WaveSpeeds {
    let vector = |x, z| Vector3 { x, y: 0.0, z };
    let (up, across, aside) = (vector(0.0, 1.0), vector(1.0, 0.0), Vector3 { x: 0.0, y: 1.0, z: 0.0 });
    let slanted = vector(0.6, 0.8);
    let heard = [
        (up, up, 437.2),
        (across, across, 425.0),
        (up, across, 269.1),
        (across, up, 270.3),
        (across, aside, 264.9),
        (slanted, slanted, 433.0),
    ];
    let speeds = heard.map(|(direction, polarization, speed)| WaveSpeed {
        method: WaveSpeed::METHOD_CROSS_CORRELATION,
        direction,
        polarization,
        speed,
        speed_stddev: 3e-3 * speed,
        frequency: 10e3,
        strain_amplitude: 1e-7,
    });
    WaveSpeeds {
        name: "glass beads 1".into(),
        density: 1498.0,
        density_stddev: 5.0,
        pressure: 50e3,
        pressure_stddev: 500.0,
        solid_fraction: 0.634,
        axis: up,
        grain_shear_modulus: 29e9,
        grain_shear_modulus_stddev: 5e8,
        grain_poisson_ratio: 0.2,
        speeds: speeds.into(),
        ..WaveSpeeds::default()
    }
}

struct Instrument {
    speeds: Publisher<WaveSpeeds>,
    answers: Subscription<Microstructure>,
    sent: Option<WaveSpeeds>,
}

impl Node for Instrument {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        if self.sent.is_none() {
            let mut sent = measured();
            sent.header.stamp = wall_stamp(bus.wall_nanos());
            // Both topics are latched: an inversion that starts later answers, too.
            self.speeds.publish(bus, &sent)?;
            self.sent = Some(sent);
        }
        while let Some((answer, _)) = self.answers.take_valid(bus)? {
            let is_mine =
                |sent: &WaveSpeeds| sent.name == answer.name && sent.header.stamp == answer.header.stamp;
            if self.sent.as_ref().is_some_and(is_mine) {
                for e in &answer.estimates {
                    println!(
                        "{}: k {:.4?}, z {:.4?}, eps {:.4?} {}",
                        e.model,
                        e.k,
                        e.z,
                        e.eps,
                        e.warnings.join("; ")
                    );
                }
                return Ok(Next::Finished(Exit::Done));
            }
        }
        Ok(Next::Wait(Duration::from_secs(1)))
    }

    fn health(&self) -> Health {
        Health::ok(format!("{} measurements sent", usize::from(self.sent.is_some())))
    }
}

fn main() -> ExitCode {
    let spec = NodeSpec {
        name: "my_node",
        summary: "sends wave speeds, and prints what is inferred from them",
        scope: Scope::Everyone,
        parameters: Vec::new(),
    };
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let args = match RosArgs::parse(&arguments) {
        Ok((args, _)) => args,
        Err(wrong) => {
            eprintln!("{wrong}");
            return ExitCode::from(2);
        }
    };
    let exit = run_node(&spec, &args, |bus, _| {
        let speeds = Publisher::advertise(bus, &topics::WAVE_SPEEDS)?;
        let answers = Subscription::subscribe(bus, &topics::MICROSTRUCTURE, Demand::reliable(16))?;
        Ok(Box::new(Instrument { speeds, answers, sent: None }))
    });
    exit.into()
}
