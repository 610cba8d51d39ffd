//! Waves in known media, by a dense eigenvalue solve of the full Christoffel tensor.

use grainlab_core::{Stiffness, TransverseIsotropy, Vec3, WaveSpeed};
use grainlab_emt::christoffel::{self, ChristoffelError, SpeedFit};
use grainlab_emt::{Conditions, Measured, Modulus};
use grainlab_testkit::Random;
use nalgebra::Rotation3;

/// Density of the mass that moves, kg/m³.
pub(crate) const DENSITY: f64 = 1573.0;

/// A wave: angle between direction and axis, degrees, and the mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Wave {
    P(f64),
    Sv(f64),
    Sh(f64),
}

/// A medium with its axis, in a rotated frame.
pub(crate) struct Sample {
    pub(crate) moduli: TransverseIsotropy,
    pub(crate) stiffness: Stiffness,
    pub(crate) frame: Rotation3<f64>,
}

impl Sample {
    pub(crate) fn new(moduli: TransverseIsotropy, frame: Rotation3<f64>) -> Self {
        Self { moduli, stiffness: moduli.stiffness().rotated(frame.matrix()), frame }
    }

    pub(crate) fn axis(&self) -> Vec3 {
        self.frame * Vec3::z()
    }

    /// Direction, and the polarization that follows from the axis without knowledge of the moduli; `azimuth`
    /// in degrees.
    pub(crate) fn nominal(&self, wave: Wave, azimuth: f64) -> (Vec3, Vec3) {
        let (Wave::P(angle) | Wave::Sv(angle) | Wave::Sh(angle)) = wave;
        let (sin, cos) = angle.to_radians().sin_cos();
        let (sin_azimuth, cos_azimuth) = azimuth.to_radians().sin_cos();
        let n = Vec3::new(sin * cos_azimuth, sin * sin_azimuth, cos);
        let across = Vec3::new(-sin_azimuth, cos_azimuth, 0.0);
        let p = match wave {
            Wave::P(_) => n,
            Wave::Sh(_) => across,
            Wave::Sv(_) => across.cross(&n),
        };
        (self.frame * n, self.frame * p)
    }

    /// The speed of a wave, with its exact polarization.
    pub(crate) fn exact(&self, wave: Wave, azimuth: f64) -> WaveSpeed {
        let (direction, nominal) = self.nominal(wave, azimuth);
        let mode = self.mode(wave, direction, nominal);
        WaveSpeed { direction, polarization: mode.1, speed: (mode.0 / DENSITY).sqrt(), stddev: None }
    }

    /// Speeds with the polarization assumed without knowledge of the moduli.
    pub(crate) fn named(&self, wave: Wave, azimuth: f64) -> WaveSpeed {
        WaveSpeed { polarization: self.nominal(wave, azimuth).1, ..self.exact(wave, azimuth) }
    }

    /// ρ v² and polarization; of the two modes in the plane, P is the stiffer.
    fn mode(&self, wave: Wave, direction: Vec3, nominal: Vec3) -> (f64, Vec3) {
        if let Wave::Sh(_) = wave {
            return (nominal.dot(&(self.stiffness.christoffel(&direction) * nominal)), nominal);
        }
        let waves = self.stiffness.plane_waves(&direction);
        let across = direction.cross(&self.axis()).try_normalize(1e-9);
        let in_plane = |p: &Vec3| across.is_none_or(|across| p.dot(&across).abs() < 0.5);
        let k = match wave {
            Wave::P(_) => (0..3).find(|k| in_plane(&waves.polarizations[*k])),
            _ => (0..3).rfind(|k| in_plane(&waves.polarizations[*k])),
        };
        let k = k.expect("two modes move in the plane");
        // Along the axis any transverse polarization is that of a mode.
        let polarization = if across.is_none() { nominal } else { waves.polarizations[k] };
        (waves.moduli[k], polarization)
    }

    pub(crate) fn truth(&self, modulus: Modulus) -> f64 {
        grainlab_emt::Moduli::of_medium(&self.moduli).get(modulus).expect("a medium has all of them")
    }

    pub(crate) fn fit(&self, speeds: &[WaveSpeed]) -> Result<SpeedFit, ChristoffelError> {
        let density = Measured::exact(DENSITY);
        christoffel::moduli_from_speeds(speeds, density, Some(self.axis()), Conditions::at(50e3))
    }
}

/// The medium of a packing, close to the paper's S3.
pub(crate) const PACKING: TransverseIsotropy =
    TransverseIsotropy { c11: 245e6, c12: 111e6, c13: 98e6, c33: 274e6, g13: 72e6, g12: 67e6, residual: 0.0 };

/// Along the edges, face diagonals and body diagonals of a cube.
pub(crate) fn thirteen() -> Vec<Vec3> {
    let steps = || (-1..=1).map(f64::from);
    let all = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])));
    all.filter(|v| *v > [0.0; 3]).map(|v| Vec3::from(v).normalize()).collect()
}

/// P and both S along each direction, with the polarizations of the modes and this relative error.
pub(crate) fn every_mode(
    stiffness: &Stiffness,
    directions: &[Vec3],
    relative: f64,
    random: &mut Random,
) -> Vec<WaveSpeed> {
    let mut speeds = Vec::new();
    for direction in directions {
        let waves = stiffness.plane_waves(direction);
        for (modulus, polarization) in waves.moduli.into_iter().zip(waves.polarizations) {
            let exact = (modulus / DENSITY).sqrt();
            let (speed, stddev) = (exact * (1.0 + relative * random.normal()), Some(relative * exact));
            speeds.push(WaveSpeed { direction: *direction, polarization, speed, stddev });
        }
    }
    speeds
}

/// A stable medium whose P modulus is above its S moduli along and across the axis, and whose C13 + C44 is positive; `anisotropy`
/// in (0, 1].
pub(crate) fn medium(random: &mut Random, anisotropy: f64) -> TransverseIsotropy {
    loop {
        let mut about = |value: f64| value * (anisotropy * random.between(-1.0, 1.0)).exp();
        let (c33, c11, g13, g12) = (about(300e6), about(300e6), about(90e6), about(90e6));
        let c13 = about(190e6) - g13;
        let stable = c11 > g12 && c33 * (c11 - g12) > c13 * c13;
        if stable && c13 + g13 > 0.2 * g13 && c11.min(c33) > 1.1 * g12.max(g13) {
            return TransverseIsotropy::of_constants(c11, c33, c13, g13, g12);
        }
    }
}
