//! 1/Q of waves in the contact network is that of waves among the moving grains of the engine.

use crate::attenuation::{along, found};
use crate::sample;
use grainlab_acoustics::dispersion::Scattering;
use grainlab_acoustics::supercell;
use grainlab_core::contact::TangentialLaw;
use grainlab_core::{Packing, Vec3};
use grainlab_dem::{Engine, EngineSettings, TimeStep};
use std::f64::consts::TAU;

/// Coherent velocity in the engine after a plane wave with `waves` periods in `copies` of `packing` along e3, over its
/// first value, with the time between samples, s. The motion of the packing without the wave is subtracted.
fn in_the_engine(
    packing: &Packing,
    copies: u32,
    waves: u32,
    strain: f64,
    damping: f64,
    [interval, duration]: [f64; 2],
) -> (Vec<f64>, f64) {
    let repeated = supercell(packing, [0, 0, 1], copies).unwrap();
    let q = repeated.wavenumber(waves);
    let carries = grainlab_core::non_rattlers(&repeated.packing);
    let shape: Vec<f64> =
        repeated.along.iter().zip(&carries).map(|(x, c)| if *c { (q * x).cos() } else { 0.0 }).collect();
    let square: f64 = shape.iter().map(|s| s * s).sum();
    let speed = strain * 500.0;
    let run = |amplitude: f64| {
        let settings = EngineSettings {
            friction: f64::INFINITY,
            damping,
            tangential: TangentialLaw::Incremental,
            time_step: TimeStep::FractionOfStable(0.5),
            skin: 0.02 * 2.0 * packing.radii[0],
            ..EngineSettings::default()
        };
        let still = Packing { friction: f64::INFINITY, ..repeated.packing.clone() };
        let mut engine = Engine::from_packing(&still, settings).unwrap();
        engine.update_time_step();
        engine.initialise().unwrap();
        let first: Vec<Vec3> = shape.iter().map(|s| repeated.normal * (amplitude * s)).collect();
        engine.set_velocities(&first).unwrap();
        engine.set_spins(&vec![Vec3::zeros(); first.len()]).unwrap();
        let stride = (interval / engine.time_step()).max(1.0) as u32;
        let interval = f64::from(stride) * engine.time_step();
        let mut amplitudes = Vec::new();
        for _ in 0..=(duration / interval) as usize {
            let along =
                engine.velocities().iter().zip(&shape).map(|(v, s)| v.dot(&repeated.normal) * s).sum::<f64>();
            amplitudes.push(along / square);
            engine.run(stride).unwrap();
        }
        (amplitudes, interval)
    };
    let ((with, interval), (without, _)) = (run(speed), run(0.0));
    (with.iter().zip(&without).map(|(a, b)| (a - b) / speed).collect(), interval)
}

/// Heights and times of the maxima of |a|.
fn maxima(a: &[f64], interval: f64) -> Vec<[f64; 2]> {
    (1..a.len() - 1)
        .filter(|k| a[*k].abs() >= a[k - 1].abs() && a[*k].abs() > a[k + 1].abs())
        .map(|k| {
            let (left, top, right) = (a[k - 1].abs(), a[k].abs(), a[k + 1].abs());
            let shift = 0.5 * (left - right) / (left - 2.0 * top + right);
            [top - 0.25 * (left - right) * shift, (k as f64 + shift) * interval]
        })
        .collect()
}

#[test]
fn a_wave_in_the_engine_with_dashpots_decays_as_its_damped_mode() {
    let packing = sample::anisotropic();
    let copies = 6;
    let repeated = supercell(&packing, [0, 0, 1], copies).unwrap();
    let ray = along(repeated.normal, &[repeated.normal]);
    let wavelength = repeated.path / (2.0 * packing.radii[0]);
    for damping in [0.15, 0.3] {
        let contact = found(&packing, ray.clone(), &[wavelength], damping)[0].points[0].contact.unwrap();
        let period = TAU / contact.omega;
        let sampling = [period / 60.0, 3.2 * period];
        // Over the wave without dashpots, which also loses what does not belong to its mode.
        let (damped, interval) = in_the_engine(&packing, copies, 1, 1e-7, damping, sampling);
        let (free, free_interval) = in_the_engine(&packing, copies, 1, 1e-7, 0.0, sampling);
        let (damped, free) = (maxima(&damped, interval), maxima(&free, free_interval));
        let (first, last) = (1, damped.len().min(free.len()) - 1);
        let fall = |k: usize| (damped[k][0] / free[k][0]).ln();
        let rate = -(fall(last) - fall(first)) / (damped[last][1] - damped[first][1]);
        let loss = 2.0 * rate / contact.omega;
        assert!((loss / contact.loss - 1.0).abs() < 0.01, "{loss:e} {contact:?}");
    }
}

fn scattering(packing: &Packing, direction: Vec3, wavelength: f64) -> Scattering {
    found(packing, along(direction, &[direction]), &[wavelength], 0.0)[0].points[0].scattering.unwrap()
}

/// γ and ω of samples of a damped tone: a(t + Δ) = 2 e^(−γΔ) cos ωΔ a(t) − e^(−2γΔ) a(t − Δ) by least squares.
fn tone(a: &[f64], apart: usize, interval: f64) -> [f64; 2] {
    let [mut xx, mut xy, mut yy, mut xz, mut yz] = [0.0; 5];
    for k in apart..a.len() - apart {
        let (x, y, z) = (a[k], a[k - apart], a[k + apart]);
        (xx, xy, yy, xz, yz) = (xx + x * x, xy + x * y, yy + y * y, xz + x * z, yz + y * z);
    }
    let determinant = xx * yy - xy * xy;
    let (now, before) = ((xz * yy - yz * xy) / determinant, (yz * xx - xz * xy) / determinant);
    let step = interval * apart as f64;
    let left = (-before).sqrt();
    [-left.ln() / step, (0.5 * now / left).acos() / step]
}

#[test]
fn a_short_wave_in_the_engine_loses_coherence_as_in_the_frozen_network_at_any_small_amplitude() {
    let packing = sample::anisotropic();
    // Four periods in three copies: neither this wave nor its opposite has the period of the packing.
    let repeated = supercell(&packing, [0, 0, 1], 3).unwrap();
    let wavelength = repeated.path / 4.0 / (2.0 * packing.radii[0]);
    let frozen = scattering(&packing, repeated.normal, wavelength);
    assert!(frozen.is_resolved() && frozen.loss > 0.2, "{frozen:?}");
    let period = TAU / frozen.omega;
    let sampling = [period / 40.0, 2.5 * period];
    let (weak, interval) = in_the_engine(&packing, 3, 4, 1e-9, 0.0, sampling);
    let (strong, _) = in_the_engine(&packing, 3, 4, 1e-7, 0.0, sampling);
    let apart = weak.iter().zip(&strong).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-3, "{apart:e}");
    let [decay, omega] = tone(&weak[10..], 8, interval);
    assert!((omega / frozen.omega - 1.0).abs() < 0.02, "{omega:e} {frozen:?}");
    assert!(
        (2.0 * decay / omega - frozen.loss).abs() < 2.0 * frozen.stddev,
        "{decay:e} {omega:e} {frozen:?}"
    );
}

#[test]
fn scattering_grows_steeply_with_frequency_and_is_not_claimed_for_long_waves() {
    let packing = sample::anisotropic();
    let [long, short] = [20.0, 10.0].map(|wavelength| scattering(&packing, Vec3::z(), wavelength));
    assert!(!long.is_resolved() && short.is_resolved(), "{long:?} {short:?}");
    // Rayleigh's law or steeper.
    assert!(short.loss > 8.0 * long.loss.max(0.0), "{long:?} {short:?}");
    let none = &found(&packing, along(Vec3::z(), &[Vec3::z()]), &[160.0], 0.0)[0].points[0];
    assert!(none.scattering.is_none() && none.contact.is_some());
}
