//! A packing with known properties, and a result of its measurement.

use grainlab_acoustics::Channel;
use grainlab_acoustics::{EffectiveDensity, Measurement, Trace};
use grainlab_core::notes::Note;
use grainlab_core::{Mat3, MeasuredWave, Vec3, WaveMethod, WaveSpeed};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::msg;
use grainlab_testkit::packings::lattice;

pub(crate) fn message(overlap: f64) -> msg::Packing {
    packing_message(&lattice(overlap), "lattice", vec![1, 2, 3])
}

/// Two waves along z, a trace of one of them, and a warning.
pub(crate) fn measurement() -> Measurement {
    let wave = |polarization, speed| MeasuredWave {
        wave: WaveSpeed { direction: Vec3::z(), polarization, speed, stddev: Some(0.003 * speed) },
        method: WaveMethod::CrossCorrelation,
        frequency: Some(2e4),
        strain_amplitude: 1e-8,
    };
    let channel = |distance: f64| Channel { distance, samples: vec![0.0, 1e-6, 0.0, -1e-6] };
    Measurement {
        modes: Vec::new(),
        smooth: false,
        waves: vec![wave(Vec3::z(), 500.0), wave(Vec3::x(), 300.0)],
        effective_density: EffectiveDensity { density: Mat3::identity() * 1500.0 },
        density: 1500.0,
        density_stddev: 5.0,
        axis: Some(Vec3::z()),
        curves: Vec::new(),
        traces: vec![Trace {
            direction: Vec3::z(),
            polarization: Vec3::x(),
            method: WaveMethod::CrossCorrelation,
            frequency: 2e4,
            sample_rate: 8e5,
            start: 0.0,
            channels: vec![channel(4e-3), channel(8e-3)],
        }],
        notes: vec![Note::left_out("no lattice plane")],
    }
}
