//! A packing with known properties, and a result of its measurement.

use grainlab_acoustics::Channel;
use grainlab_acoustics::{AcousticsError, EffectiveDensity, Measurement, Trace};
use grainlab_core::{Cell, Contact, Mat3, Material, MeasuredWave, Vec3, WaveMethod, WaveSpeed};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::msg;

pub(crate) const DIAMETER: f64 = 2e-4;
pub(crate) const OVERLAP: f64 = 2e-8;

/// One grain per cell touching its own images: a simple cubic lattice, or grains apart if `overlap` is not
/// positive.
pub(crate) fn lattice(overlap: f64) -> grainlab_core::Packing {
    let contact = |axis: usize| {
        let (mut image, mut normal) = ([0; 3], Vec3::zeros());
        (image[axis], normal[axis]) = (1, 1.0);
        let normal_force = Material::GLASS.normal_force(DIAMETER / 4.0, overlap);
        Contact {
            i: 0,
            j: 0,
            image,
            overlap,
            normal,
            normal_force,
            tangential_force: Vec3::zeros(),
            rolling_force: Vec3::zeros(),
        }
    };
    grainlab_core::Packing {
        step: 12,
        time: 0.5,
        cell: Cell::cube(DIAMETER - overlap).unwrap(),
        deformation: Mat3::identity(),
        ids: vec![0],
        radii: vec![DIAMETER / 2.0],
        positions: vec![Vec3::zeros()],
        velocities: vec![Vec3::zeros()],
        spins: vec![Vec3::zeros()],
        contacts: if overlap > 0.0 { [2, 1, 0].map(contact).to_vec() } else { Vec::new() },
        material: Material::GLASS,
        law: Default::default(),
        friction: 0.3,
        time_step: 1e-8,
    }
    .validated()
    .unwrap()
}

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
        warnings: vec![grainlab_acoustics::Warning::LeftOut(AcousticsError::NoLatticePlane {
            direction: [0.0, 0.6, 0.8],
        })],
    }
}
