//! Records of bursts in packings, and the speeds of long waves by dispersion: `tests/golden/waves/traces.csv.gz`, whose README has the command.

use grainlab_acoustics::time_of_flight::{Settings as TimeOfFlight, curves};
use grainlab_acoustics::{Instrument, Ray, Settings, Survey, measure};
use grainlab_core::Vec3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("packing,mode,speed,diameter,frequency,sample_rate,start,distance,samples");
    for folder in std::env::args().skip(1) {
        let name = std::path::absolute(&folder)?.join("p");
        let packing = grainlab_testkit::golden::packing(&name.to_string_lossy());
        let waves = measure(&packing, &Settings { survey: Survey::Minimal, ..Settings::default() })?.waves;
        let diameter = 2.0 * packing.radii.iter().sum::<f64>() / packing.radii.len() as f64;
        for (indices, normal) in [([0, 0, 1], Vec3::z()), ([1, 0, 0], Vec3::x())] {
            let direction = Ray::normal(&packing.cell, indices).ok_or("the cell has no such plane")?;
            for motion in [Vec3::z(), Vec3::x()] {
                let of = |a: &Vec3, b: &Vec3| a.dot(b).abs() > 0.99;
                let found = waves
                    .iter()
                    .map(|w| &w.wave)
                    .find(|w| of(&w.direction, &normal) && of(&w.polarization, &motion));
                let Some(speed) = found.map(|w| w.speed) else { continue };
                let across = (motion - direction * motion.dot(&direction)).normalize();
                let (mode, polarization) = if motion == normal { ("p", direction) } else { ("s", across) };
                let ray = Ray { direction, indices: Some(indices), polarizations: vec![polarization] };
                let frequencies = [18.0, 40.0].map(|diameters| speed / (diameters * diameter)).to_vec();
                let settings =
                    TimeOfFlight { frequencies: Some(frequencies), cycles: 2.0, ..TimeOfFlight::default() };
                let (_, traces, _) = curves(&packing, &[ray], &settings, &Instrument::default())?;
                for trace in traces {
                    for channel in &trace.channels {
                        let largest = channel.samples.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
                        let samples: Vec<String> =
                            channel.samples.iter().map(|s| format!("{:.0}", 1e4 * s / largest)).collect();
                        let (f, rate, start) = (trace.frequency, trace.sample_rate, trace.start);
                        let numbers = format!("{speed},{diameter},{f},{rate},{start},{}", channel.distance);
                        println!("{folder},{mode},{numbers},{}", samples.join(" "));
                    }
                }
            }
        }
    }
    Ok(())
}
