//! The wave speeds of one sample over pressure.

use crate::error::EmtError;
use crate::normal::chi_square_above;
use grainlab_core::Material;
use nalgebra::{Cholesky, DMatrix, DVector};

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

impl SpeedMode {
    fn is_shear(self) -> bool {
        matches!(self, Self::Sv | Self::Sh)
    }

    /// True for waves whose ρ v² is G13: SV along and across the axis, and SH along it.
    fn is_axial_shear(self, angle: f64) -> bool {
        match self {
            Self::Sv => same(2.0 * angle, 0.0),
            Self::Sh => same(angle, 0.0),
            Self::P | Self::Bulk => false,
        }
    }
}

/// True for angles to the axis of one wave.
fn same(a: f64, b: f64) -> bool {
    (a.sin().abs() - b.sin().abs()).abs() < 1e-3
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
    /// Standard deviation of the speed over it, by errors of its own.
    pub stddev: f64,
    /// Standard deviation of the speed over it, by errors that all rows of this mode and direction share.
    pub common_stddev: f64,
}

impl SeriesRow {
    /// Returns the covariance of errors that are common to the rows of one mode and direction: paths and transducers. Other modes of
    /// the direction share the path, which has half of the covariance.
    pub(super) fn common(rows: &[Self], stddev: impl Fn(&Self) -> f64) -> DMatrix<f64> {
        let share = |a: &Self, b: &Self| match () {
            () if a.angle != b.angle => 0.0,
            () if a.mode != b.mode => 0.5,
            () => 1.0,
        };
        DMatrix::from_fn(rows.len(), rows.len(), |j, k| {
            share(&rows[j], &rows[k]) * stddev(&rows[j]) * stddev(&rows[k])
        })
    }
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
        let differs = |(mode, angle): &(SpeedMode, f64), (other, of): &(SpeedMode, f64)| match (mode, other) {
            _ if mode.is_axial_shear(*angle) && other.is_axial_shear(*of) => false,
            (SpeedMode::Sv, SpeedMode::Sv) => !same(2.0 * angle, 2.0 * of),
            _ if mode == other => !same(*angle, *of),
            _ => mode.is_shear() && other.is_shear(),
        };
        waves.iter().enumerate().any(|(n, wave)| waves[..n].iter().any(|other| differs(wave, other)))
    }

    /// Waves of different modes or directions that are one modulus, G13, but whose speeds differ beyond their errors in every state: ln
    /// of the second over the first, its mean over two states or more.
    pub fn unequal_twins(&self) -> Option<f64> {
        let pressures = self.pressures();
        let is_of = |row: &SeriesRow| row.angle.is_some_and(|angle| row.mode.is_axial_shear(angle));
        let all: Vec<&SeriesRow> = self.rows.iter().filter(|row| row.speed.is_some() && is_of(row)).collect();
        let first = all.first().map(|row| (row.mode, row.angle))?;
        // Mean of ln of the speeds of a kind at a pressure, and its variance.
        let mean = |k: usize, is_first: bool| {
            let of = all.iter().filter(|row| {
                Self::place(&pressures, row) == k && ((row.mode, row.angle) == first) == is_first
            });
            let speeds: Vec<(f64, f64)> =
                of.filter_map(|r| Some((r.speed?.ln(), r.stddev.powi(2)))).collect();
            let n = speeds.len() as f64;
            let sum = speeds.iter().fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
            (n > 0.0).then(|| (sum.0 / n, sum.1 / (n * n)))
        };
        let common = all.iter().map(|row| 2.0 * row.common_stddev.powi(2)).fold(0.0, f64::max);
        let differences: Vec<(f64, f64)> = (0..pressures.len())
            .filter_map(|k| {
                let ((a, va), (b, vb)) = (mean(k, true)?, mean(k, false)?);
                Some((b - a, va + vb))
            })
            .collect();
        let n = differences.len() as f64;
        let mean = differences.iter().map(|(d, _)| d).sum::<f64>() / n;
        let own = differences.iter().map(|(_, v)| v).sum::<f64>() / (n * n);
        let is_each = differences.iter().all(|(d, v)| d * mean > 0.0 && d * d > v + common);
        (differences.len() > 1 && is_each && mean.abs() > 3.0 * (own + common).sqrt()).then_some(mean)
    }

    /// Probability of speeds that differ more by their stated errors, of waves of different modes or directions that are one modulus,
    /// G13, in one state; `None` without such waves.
    pub(super) fn p_twins(&self) -> Option<f64> {
        let pressures = self.pressures();
        let is_of = |row: &&SeriesRow| row.angle.is_some_and(|angle| row.mode.is_axial_shear(angle));
        let rows: Vec<SeriesRow> =
            self.rows.iter().filter(|row| row.speed.is_some()).filter(is_of).copied().collect();
        let is_same = |a: &SeriesRow, b: &SeriesRow| {
            a.mode == b.mode && a.angle.zip(b.angle).is_some_and(|(a, b)| same(a, b))
        };
        let state = |row: &SeriesRow| Self::place(&pressures, row);
        let own = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.stddev.powi(2)));
        let common = SeriesRow::common(&rows, |row| row.common_stddev);
        let weight = Cholesky::new(DMatrix::from_diagonal(&own) + common)?.inverse();
        let data = DVector::from_iterator(
            rows.len(),
            rows.iter().map(|row| row.speed.map_or(f64::NAN, f64::ln) + 0.5 * row.density.ln()),
        );
        // χ² about one speed for all rows that are alike, and the number of these speeds.
        let about = |is_alike: &dyn Fn(&SeriesRow, &SeriesRow) -> bool| {
            let first = |n: usize| (0..=n).find(|m| is_alike(&rows[*m], &rows[n])).unwrap_or(n);
            let means: Vec<usize> = (0..rows.len()).filter(|n| first(*n) == *n).collect();
            let design =
                DMatrix::from_fn(rows.len(), means.len(), |n, m| f64::from(u8::from(first(n) == means[m])));
            let information = Cholesky::new(design.transpose() * &weight * &design)?;
            let pull = design.transpose() * &weight * &data;
            Some((data.dot(&(&weight * &data)) - pull.dot(&information.solve(&pull)), means.len()))
        };
        let (of_states, states) = about(&|a, b| state(a) == state(b))?;
        let (of_waves, waves) = about(&|a, b| state(a) == state(b) && is_same(a, b))?;
        (waves > states).then(|| chi_square_above(of_states - of_waves, waves - states))
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
            if !(row.common_stddev >= 0.0 && row.common_stddev.is_finite()) {
                let quantity = "common standard deviation of a speed over it";
                return Err(EmtError::NegativeStddev { quantity, value: row.common_stddev });
            }
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
