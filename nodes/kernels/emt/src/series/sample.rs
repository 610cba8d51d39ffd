//! The wave speeds of one sample over pressure.

use crate::error::EmtError;
use grainlab_core::Material;
use nalgebra::DMatrix;

/// Mode of a wave: polarized along its direction, in the plane of direction and axis, or across it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedMode {
    /// Longitudinal, along the direction.
    P,
    /// Transverse, in the plane of direction and axis.
    Sv,
    /// Transverse, across that plane.
    Sh,
    /// No wave: ρ v² is the bulk modulus.
    Bulk,
}

/// One speed, or one that is to be predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesRow {
    /// Confining pressure, Pa.
    pub pressure: f64,
    /// Density of the mass that moves with the wave, kg/m³.
    pub density: f64,
    /// Mode of the wave.
    pub mode: SpeedMode,
    /// Angle between direction and axis, rad; `None`: not known, the sample counts as isotropic.
    pub angle: Option<f64>,
    /// Speed, m/s; `None` is predicted.
    pub speed: Option<f64>,
    /// Standard deviation of the speed over it.
    pub stddev: f64,
}

/// The speeds of one sample under isotropic stress, and what is known of its grains.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedSeries {
    /// Speeds in any order; equal pressures have one structure.
    pub rows: Vec<SeriesRow>,
    /// Material of the grains; its density is not used.
    pub material: Material,
    /// Standard deviation of the shear modulus of the grains over it.
    pub shear_modulus_stddev: f64,
    /// Standard deviation of all densities, alike, over them.
    pub density_stddev: f64,
    /// Standard deviation of all pressures, alike, over them.
    pub pressure_stddev: f64,
    /// Variance of the radii over the square of their mean, and its standard deviation.
    pub size_variance: [f64; 2],
    /// Axial stress less the lateral one over the pressure, and its standard deviation.
    pub stress_ratio: [f64; 2],
    /// Number of grains; `None` is a large sample.
    pub grains: Option<u32>,
    /// ln of the crossover pressure (Pa) of rough grains and its standard deviation, see
    /// [`ContactKind::crossover`](super::gain::ContactKind::crossover); `None`: not known.
    pub ln_crossover: Option<[f64; 2]>,
    /// Covariance of ln of the measured speeds, in their order, instead of their standard deviations.
    pub covariance: Option<DMatrix<f64>>,
}

/// Pressures closer than this relative difference are one.
const SAME_PRESSURE: f64 = 1e-3;

/// Numbers of speeds of a series: one alone has nothing to agree with, and the time rises with the cube of it.
const SPEEDS: std::ops::RangeInclusive<usize> = 2..=64;

impl SpeedSeries {
    /// Speeds of a large sample of grains of one size that is known exactly but for these speeds.
    pub fn of(rows: Vec<SeriesRow>, material: Material) -> Self {
        Self {
            rows,
            material,
            shear_modulus_stddev: 0.0,
            density_stddev: 0.0,
            pressure_stddev: 0.0,
            size_variance: [0.0; 2],
            stress_ratio: [0.0; 2],
            grains: None,
            ln_crossover: None,
            covariance: None,
        }
    }

    /// The different pressures, in order, Pa.
    pub fn pressures(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self.rows.iter().map(|r| r.pressure).collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|b, a| *b <= *a * (1.0 + SAME_PRESSURE));
        all
    }

    /// Place of a row's pressure among [`SpeedSeries::pressures`].
    pub(super) fn place(pressures: &[f64], row: &SeriesRow) -> usize {
        pressures.partition_point(|p| p * (1.0 + SAME_PRESSURE) < row.pressure).min(pressures.len() - 1)
    }

    /// True if ε is determined: one mode was measured in two directions, or two S modes that an isotropic sample does not tell apart.
    pub fn has_directions(&self) -> bool {
        let measured = self.rows.iter().filter(|r| r.speed.is_some());
        Self::differ(&measured.filter_map(|r| Some((r.mode, r.angle?))).collect::<Vec<_>>())
    }

    /// True if one of these waves measures the anisotropy: a mode in two directions, or both S modes across the axis.
    fn differ(waves: &[(SpeedMode, f64)]) -> bool {
        let is_along = |angle: f64| angle.sin().abs() < 1e-3;
        waves.iter().enumerate().any(|(n, (mode, angle))| {
            waves[..n].iter().any(|(other, other_angle)| match (mode == other, *mode, *other) {
                (true, ..) => (angle.sin().abs() - other_angle.sin().abs()).abs() > 1e-3,
                (_, SpeedMode::P | SpeedMode::Bulk, _) | (_, _, SpeedMode::P | SpeedMode::Bulk) => false,
                // Along the axis the two S modes are one, and that across the plane is one with it across the axis.
                _ => !(is_along(*angle) && is_along(*other_angle)),
            })
        })
    }

    /// The first fault, if any.
    ///
    /// # Errors
    /// A number that is not finite or has the wrong sign, or no speed.
    pub(super) fn check(&self) -> Result<(), EmtError> {
        let positive = |quantity: &'static str, value: f64| match value {
            v if !v.is_finite() => Err(EmtError::NotFinite { quantity, value }),
            v if v <= 0.0 => Err(EmtError::NoState { quantity, value, range: "the positive numbers" }),
            _ => Ok(()),
        };
        for row in &self.rows {
            positive("pressure", row.pressure)?;
            positive("density", row.density)?;
            positive("standard deviation of a speed over it", row.stddev)?;
            row.speed.map_or(Ok(()), |speed| positive("speed", speed))?;
            if row.angle.is_some_and(|angle| !angle.is_finite()) {
                return Err(EmtError::NotFinite { quantity: "angle", value: f64::NAN });
            }
        }
        let measured = self.rows.iter().filter(|r| r.speed.is_some()).count();
        if !SPEEDS.contains(&measured) {
            return Err(EmtError::SeriesLength { measured, least: *SPEEDS.start(), most: *SPEEDS.end() });
        }
        positive("shear modulus of the grains", self.material.shear_modulus)?;
        for (quantity, value) in [
            ("stddev of the shear modulus of the grains", self.shear_modulus_stddev),
            ("stddev of the density", self.density_stddev),
            ("stddev of pressure", self.pressure_stddev),
            ("variance of the sizes", self.size_variance[0]),
            ("stddev of the variance of the sizes", self.size_variance[1]),
            ("stddev of the stress ratio", self.stress_ratio[1]),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(EmtError::NegativeStddev { quantity, value });
            }
        }
        let nu = self.material.poisson_ratio;
        if !(0.0..=0.5).contains(&nu) {
            let quantity = "the Poisson ratio of the grains";
            return Err(EmtError::NoState { quantity, value: nu, range: "[0, 1/2]" });
        }
        Ok(())
    }
}
