//! Logarithms of the speeds of a sample, and their slopes by the unknowns.

use super::corrections::ContactCorrections;
use super::gain::ContactKind;
use super::prior::{PreparationPrior, SeriesPrior};
use super::sample::{SeriesRow, SpeedMode, SpeedSeries};
use crate::calibration::{NetworkState, RESPONSE_STDDEV, RelaxationCalibration, Scatter};
use crate::invariants::{INVARIANTS, Invariants};
use nalgebra::{DMatrix, DVector, RowSVector, SMatrix, SVector};
use std::f64::consts::LN_10;

/// Ends of z of the unknown u: z = low + (high − low)/(1 + e^−u). The laws were learned up to 6.41.
const Z: [f64; 2] = [4.05, 7.0];

/// Ends of the mean of the prior of u, as shares of the range of z.
const INSIDE: [f64; 2] = [0.04, 0.92];

/// Share of the scatter of packings that is a trend per decade of pressure; the rest is the same at every pressure. Scatter of its own at
/// each pressure would measure z falsely. The tests of `grainlab_calibration` fit it.
pub const SCATTER_TREND: f64 = 0.4;

/// Variance of the moduli of packings whose contacts are not those of the calibration, over that of packings whose contacts are. The tests
/// of `grainlab_calibration` fit it to rough contacts.
pub const OTHER_CONTACTS: f64 = 1.65;

/// Exponent of the pressure in the rise of z.
const RISE: f64 = 0.3;

/// Least modulus of a wave, over the shear modulus.
const LEAST_MODULUS: f64 = 0.02;

/// Least k_t/k_n of an iteration.
const LEAST_RATIO: f64 = 0.05;

/// Invariants and ε weighted by stiffness.
pub(super) const SCATTERED: usize = INVARIANTS + 1;
const EPS_STIFFNESS: usize = INVARIANTS;
pub(super) type Scatter6 = SMatrix<f64, SCATTERED, SCATTERED>;

type Slopes = RowSVector<f64, INVARIANTS>;

/// The model of the speeds of one sample. The unknowns θ: u at each pressure (for a split prior those of the bulk modulus first),
/// k_t/k_n, ln p_r, and ε at each pressure if any direction is known.
pub(super) struct Forward<'a> {
    network: &'a RelaxationCalibration,
    pub(super) prior: &'a SeriesPrior,
    /// Different pressures, Pa.
    pub(super) pressures: Vec<f64>,
    /// Rows, those with a speed first, and the place of the pressure of each.
    pub(super) rows: Vec<SeriesRow>,
    pub(super) place: Vec<usize>,
    /// Place of each row in the series as given.
    pub(super) given: Vec<usize>,
    /// Number of rows with a speed.
    pub(super) measured: usize,
    /// True if ε is an unknown.
    pub(super) has_eps: bool,
    /// k_t/k_n of Mindlin's contacts.
    pub(super) mindlin: f64,
    /// Variance of the level of the moduli, as logarithms.
    pub(super) level: f64,
    ln_pressure: Vec<f64>,
    /// log10 of the pressure over the geometric middle.
    pub(super) decades: Vec<f64>,
    ln_young: f64,
    size_variance: [f64; 2],
    stress_ratio: [f64; 2],
    /// Covariance of ln of the speeds of all rows by the stated errors of their own, and this if those were common to similar rows.
    errors: [DMatrix<f64>; 2],
    /// Covariance by the stated common errors.
    common: DMatrix<f64>,
    /// Levels of the scatter of samples of this size in the middle state, before their dependence on z.
    packings: [Scatter; 2],
}

/// The model about one θ.
pub(super) struct Linearised {
    /// ln of the speeds of all rows.
    pub(super) ln_speed: DVector<f64>,
    /// Slopes by θ.
    pub(super) by_unknowns: DMatrix<f64>,
    /// Slopes by the invariants, and the scatter of ε weighted by stiffness in a last column of zeros.
    pub(super) by_invariants: Vec<Slopes>,
    mean_z: f64,
}

impl<'a> Forward<'a> {
    pub(super) fn new(
        series: &SpeedSeries,
        network: &'a RelaxationCalibration,
        prior: &'a SeriesPrior,
    ) -> Self {
        let pressures = series.pressures();
        let mut given: Vec<usize> = (0..series.rows.len()).collect();
        given.sort_by_key(|n| series.rows[*n].speed.is_none());
        let rows: Vec<SeriesRow> = given.iter().map(|n| series.rows[*n]).collect();
        let young = series.material.effective_young();
        let ln_pressure: Vec<f64> =
            pressures.iter().map(|p| NetworkState::of(*p, &series.material, 0.0, 0.0).ln_pressure).collect();
        let middle = ln_pressure.iter().sum::<f64>() / ln_pressure.len() as f64;
        let state = NetworkState {
            ln_pressure: middle,
            stiffness_ratio: 0.0,
            size_variance: series.size_variance[0],
            stress_ratio: series.stress_ratio[0],
        };
        let by_state = RelaxationCalibration::growth(&network.scatter_by_state, &state);
        // An error of the density or of all pressures changes both moduli alike.
        let scale = [
            prior.level,
            2.0 / 3.0 * series.shear_modulus_stddev,
            series.density_stddev,
            0.5 * series.pressure_stddev,
        ];
        let mut errors = DMatrix::from_diagonal(&DVector::from_fn(rows.len(), |j, _| rows[j].stddev.powi(2)));
        let mut shared = SeriesRow::common(&rows, |row| row.stddev);
        let common = SeriesRow::common(&rows, |row| row.common_stddev);
        if let Some(stated) = &series.covariance {
            errors.view_mut((0, 0), stated.shape()).copy_from(stated);
            shared.copy_from(&errors);
        }
        Self {
            network,
            prior,
            place: rows.iter().map(|row| SpeedSeries::place(&pressures, row)).collect(),
            measured: rows.iter().filter(|r| r.speed.is_some()).count(),
            has_eps: rows.iter().any(|r| r.angle.is_some()),
            mindlin: prior.known_ratio.unwrap_or_else(|| series.material.stiffness_ratio()),
            level: scale.iter().map(|s| s * s).sum(),
            decades: ln_pressure.iter().map(|p| (p - middle) / LN_10).collect(),
            ln_young: young.ln(),
            size_variance: series.size_variance,
            stress_ratio: series.stress_ratio,
            errors: [errors, shared],
            common,
            packings: network.scatter_of(Some(series.grains.unwrap_or(u32::MAX)), &by_state),
            pressures,
            rows,
            given,
            ln_pressure,
        }
    }

    /// Number of pressures.
    pub(super) fn count(&self) -> usize {
        self.pressures.len()
    }

    fn parts(&self) -> usize {
        if self.prior.is_split { 2 } else { 1 }
    }

    /// Place of k_t/k_n among the unknowns; ln p_r follows, then ε.
    pub(super) fn ratio(&self) -> usize {
        self.parts() * self.count()
    }

    /// Lowest k_t/k_n of a draw.
    pub(super) fn lowest_ratio(&self) -> f64 {
        if self.prior.known_ratio().is_some() {
            0.0
        } else {
            self.prior.lowest_stiffness_ratio.min(self.mindlin)
        }
    }

    fn eps(&self) -> usize {
        self.ratio() + 2
    }

    pub(super) fn unknowns(&self) -> usize {
        self.eps() + if self.has_eps { self.count() } else { 0 }
    }

    /// z of u, and its slope.
    pub(super) fn z_of(u: f64) -> [f64; 2] {
        let share = 1.0 / (1.0 + (-u).exp());
        [Z[0] + (Z[1] - Z[0]) * share, (Z[1] - Z[0]) * share * (1.0 - share)]
    }

    /// z of the shear modulus at each pressure.
    pub(super) fn z(&self, unknowns: &DVector<f64>) -> Vec<f64> {
        let first = (self.parts() - 1) * self.count();
        (first..first + self.count()).map(|k| Self::z_of(unknowns[k])[0]).collect()
    }

    /// z of the bulk modulus less that of the shear modulus, at each pressure.
    pub(super) fn bulk_less_shear(&self, unknowns: &DVector<f64>) -> Vec<f64> {
        (0..self.count()).zip(self.z(unknowns)).map(|(k, z)| Self::z_of(unknowns[k])[0] - z).collect()
    }

    /// ε at each pressure; empty if it is no unknown.
    pub(super) fn eps_of(&self, unknowns: &DVector<f64>) -> Vec<f64> {
        (self.eps()..self.unknowns()).map(|k| unknowns[k]).collect()
    }

    /// ln of the measured speeds.
    pub(super) fn data(&self) -> DVector<f64> {
        DVector::from_fn(self.measured, |j, _| self.rows[j].speed.map_or(f64::NAN, f64::ln))
    }

    /// Mean and covariance of the unknowns for a preparation, with zeros for k_t/k_n and ln p_r.
    pub(super) fn of_preparation(&self, of: &PreparationPrior) -> (DVector<f64>, DMatrix<f64>) {
        let (n, prior) = (self.count(), self.prior);
        let x: Vec<f64> = self.ln_pressure.iter().map(|p| p / LN_10).collect();
        let rise = |x: f64| 10f64.powf(RISE * x) - 1.0;
        let middle = x.iter().sum::<f64>() / n as f64;
        let (start, slope, origin) = match prior.other_slope {
            Some(slope) => (of.z[0] + of.slope[0] * middle, slope, middle),
            None => (of.z[0], of.slope, 0.0),
        };
        let mut mean = DVector::zeros(self.unknowns());
        let mut covariance = DMatrix::zeros(self.unknowns(), self.unknowns());
        let mut by_z = Vec::new();
        for k in 0..n {
            let z = start + slope[0] * (x[k] - origin) + of.rise[0] * rise(x[k]);
            let share = ((z - Z[0]) / (Z[1] - Z[0])).clamp(INSIDE[0], INSIDE[1]);
            by_z.push(1.0 / (share * (1.0 - share) * (Z[1] - Z[0])));
            (0..self.parts()).for_each(|part| mean[part * n + k] = (share / (1.0 - share)).ln());
        }
        for j in 0..n {
            for k in 0..n {
                let (a, b) = (x[j] - origin, x[k] - origin);
                let own = if j == k { prior.z_own * prior.z_own } else { 0.0 };
                let square = of.z[1].powi(2)
                    + slope[1].powi(2) * a * b
                    + of.rise[1].powi(2) * rise(x[j]) * rise(x[k])
                    + own;
                // z of the two moduli are independent a priori.
                (0..self.parts())
                    .for_each(|p| covariance[(p * n + j, p * n + k)] = square * by_z[j] * by_z[k]);
                if self.has_eps {
                    let own = if j == k { prior.eps_own * prior.eps_own } else { 0.0 };
                    covariance[(self.eps() + j, self.eps() + k)] = prior.eps[1].powi(2) + own;
                }
            }
        }
        (self.eps()..self.unknowns()).for_each(|k| mean[k] = prior.eps[0]);
        (mean, covariance)
    }

    /// The state of the network at a pressure, with the slope of κ by k_t/k_n.
    fn state(&self, k: usize, ratio: f64) -> (NetworkState, f64) {
        let drift = (self.prior.drift * self.decades[k]).exp();
        let at = ratio.max(LEAST_RATIO) * drift;
        let (used, slope) = if at < self.mindlin { (at, drift) } else { (self.mindlin, 0.0) };
        let state = NetworkState {
            ln_pressure: self.ln_pressure[k],
            stiffness_ratio: used - crate::calibration::REFERENCE_STIFFNESS_RATIO,
            size_variance: self.size_variance[0],
            stress_ratio: self.stress_ratio[0],
        };
        (state, slope)
    }

    /// ε of the Hertz contacts that are stiffest in the same directions, over ε: contacts of one stiffness have their ε weighted by
    /// it. Rough contacts were not found to differ.
    fn eps_factor(&self, kind: ContactKind, z: f64, state: &NetworkState) -> f64 {
        if kind == ContactKind::Linear { 1.0 / self.network.eps_stiffness.by_eps(z, state) } else { 1.0 }
    }

    /// ε weighted by contact stiffness at each pressure by its law; empty if ε is no unknown.
    pub(super) fn eps_stiffness(&self, kind: ContactKind, unknowns: &DVector<f64>) -> Vec<f64> {
        let ratio = unknowns[self.ratio()];
        let of = |(k, (z, eps)): (usize, (f64, f64))| {
            let state = self.state(k, ratio).0;
            self.network.eps_stiffness.value(z, eps * self.eps_factor(kind, z, &state), &state)
        };
        self.z(unknowns).into_iter().zip(self.eps_of(unknowns)).enumerate().map(of).collect()
    }

    /// The model about θ, for a contact law and the place of a preparation.
    pub(super) fn about(&self, kind: ContactKind, preparation: usize, unknowns: &DVector<f64>) -> Linearised {
        let (n, network) = (self.count(), self.network);
        let (ratio, cross) = (unknowns[self.ratio()], unknowns[self.ratio() + 1]);
        let middle = self.pressures.iter().map(|p| p.ln()).sum::<f64>() / n as f64;
        let level = if kind.is_free() { kind.gain(middle - cross, 5.0) } else { [0.0; 2] };
        let mut at = Vec::with_capacity(n);
        for k in 0..n {
            let (state, by_ratio) = self.state(k, ratio);
            let scalar = |which: usize, u: f64| {
                let law = [&network.theta, &network.shear][which];
                let [z, by_u] = Self::z_of(u);
                let [gain, slope] = kind.gain(self.pressures[k].ln() - cross, z);
                let exponent = 1.0 / 3.0 + slope;
                let corrections = &ContactCorrections::LEARNED;
                let [spread, spread_by_z] = corrections.of_spread(which, exponent, z);
                let [low, low_by_kappa, low_by_z] = corrections.of_low_ratio(which, state.stiffness_ratio, z);
                let value =
                    law.value(z, &state) + 2.0 / 3.0 * self.ln_young + self.pressures[k].ln() / 3.0 + gain
                        - level[0]
                        + spread
                        + low
                        + self.prior.preparation[preparation].moduli[which];
                let by_z = law.slope(z, &state) - slope / z + spread_by_z + low_by_z;
                let by_kappa = law.by_stiffness_ratio(z) + low_by_kappa;
                [value, by_z * by_u, by_kappa * by_ratio, level[1] - slope]
            };
            let theta = scalar(0, unknowns[k]);
            let shear = scalar(1, unknowns[(self.parts() - 1) * n + k]);
            let z = Self::z_of(unknowns[(self.parts() - 1) * n + k])[0];
            let laws = [&network.dilatation, &network.voigt, &network.harmonic];
            let factor = if self.has_eps { self.eps_factor(kind, z, &state) } else { 0.0 };
            let by_eps = laws.map(|law| law.by_eps(z, &state) * factor);
            let of_stress = laws.map(|law| law.value(z, 0.0, &state));
            at.push((theta, shear, by_eps, of_stress));
        }
        let mut found = Linearised {
            ln_speed: DVector::zeros(self.rows.len()),
            by_unknowns: DMatrix::zeros(self.rows.len(), self.unknowns()),
            by_invariants: Vec::with_capacity(self.rows.len()),
            mean_z: self.z(unknowns).iter().sum::<f64>() / n as f64,
        };
        for (j, (row, k)) in self.rows.iter().zip(&self.place).enumerate() {
            let ([ln_theta, k_u, k_ratio, k_cross], [ln_shear, g_u, g_ratio, g_cross], by_eps, of_stress) =
                at[*k];
            let eps = if self.has_eps { unknowns[self.eps() + k] } else { 0.0 };
            let [dilatation, voigt, harmonic] = std::array::from_fn(|i| by_eps[i] * eps + of_stress[i]);
            let (ln_modulus, slopes) =
                modulus(row, &Invariants { ln_theta, ln_shear, dilatation, voigt, harmonic });
            found.ln_speed[j] = 0.5 * (ln_modulus - row.density.ln());
            let mut by = found.by_unknowns.row_mut(j);
            by[*k] += slopes[0] * k_u;
            by[(self.parts() - 1) * n + k] += slopes[1] * g_u;
            by[self.ratio()] = slopes[0] * k_ratio + slopes[1] * g_ratio;
            by[self.ratio() + 1] = slopes[0] * k_cross + slopes[1] * g_cross;
            if self.has_eps {
                by[self.eps() + k] = (0..3).map(|i| slopes[2 + i] * by_eps[i]).sum();
            }
            found.by_invariants.push(slopes);
        }
        found
    }

    /// Covariance of what the laws leave of the invariants and of ε weighted by stiffness: what is alike at all pressures, and
    /// what is a trend per decade.
    pub(super) fn scatter(&self, at: &Linearised) -> [Scatter6; 2] {
        let all = RelaxationCalibration::at_z(at.mean_z, &self.packings);
        let mut packings: Scatter6 = all.fixed_view::<SCATTERED, SCATTERED>(0, 0).into_owned();
        let mut of_moduli = packings.fixed_view_mut::<2, 2>(0, 0);
        of_moduli *= OTHER_CONTACTS;
        let mut parts = [packings * (1.0 - SCATTER_TREND), packings * SCATTER_TREND];
        let alike = [self.level, self.prior.trend * self.prior.trend];
        for (part, variance) in parts.iter_mut().zip(alike) {
            part.fixed_view_mut::<2, 2>(0, 0).add_scalar_mut(variance);
        }
        let network = self.network;
        let (state, _) = self.state(self.count() / 2, self.mindlin);
        let mut by_sizes = SVector::<f64, SCATTERED>::zeros();
        (by_sizes[0], by_sizes[1]) = (network.theta.by_size_variance(), network.shear.by_size_variance());
        let laws = [&network.dilatation, &network.voigt, &network.harmonic, &network.eps_stiffness];
        let of_stress = laws.map(|law| law.by_stress_ratio(at.mean_z, &state));
        let by_stress = SVector::from([0.0, 0.0, of_stress[0], of_stress[1], of_stress[2], of_stress[3]]);
        let [ratio, stddev] = self.stress_ratio;
        let of_stress = stddev.hypot(RESPONSE_STDDEV * ratio);
        for (by, stddev) in [(by_sizes, self.size_variance[1]), (by_stress, of_stress)] {
            parts[0] += by * by.transpose() * (stddev * stddev);
        }
        parts
    }

    /// Covariance of the first rows that θ does not explain, with this factor of the stated errors. Below 1 it is the scatter of the
    /// speeds, and what it leaves of the errors is common to similar rows: the speeds do not show that.
    pub(super) fn unexplained(&self, at: &Linearised, rows: usize, noise: f64) -> DMatrix<f64> {
        let parts = self.scatter(at).map(|p| p.fixed_view::<INVARIANTS, INVARIANTS>(0, 0).into_owned());
        let sides: Vec<[Slopes; 2]> =
            at.by_invariants[..rows].iter().map(|a| parts.each_ref().map(|p| a * p)).collect();
        let x = |j: usize| self.decades[self.place[j]];
        let mut found = DMatrix::zeros(rows, rows);
        for j in 0..rows {
            for k in 0..=j {
                let b = &at.by_invariants[k];
                let value = sides[j][0].dot(b) + x(j) * x(k) * sides[j][1].dot(b);
                (found[(j, k)], found[(k, j)]) = (value, value);
            }
        }
        let [own, shared] = self.errors.each_ref().map(|of| of.view((0, 0), (rows, rows)));
        found
            + own * noise.powi(2)
            + shared * (1.0 - noise.powi(2)).max(0.0)
            + self.common.view((0, 0), (rows, rows))
    }

    /// Covariance of what the law leaves of ε weighted by stiffness at a pressure with the rows.
    pub(super) fn with_eps_stiffness(&self, at: &Linearised, k: usize, rows: usize) -> (DVector<f64>, f64) {
        let [alike, trend] = self.scatter(at);
        let of = |part: &Scatter6, a: &Slopes| {
            (0..INVARIANTS).map(|i| part[(EPS_STIFFNESS, i)] * a[i]).sum::<f64>()
        };
        let x = self.decades[k];
        let with = DVector::from_fn(rows, |j, _| {
            let a = &at.by_invariants[j];
            of(&alike, a) + x * self.decades[self.place[j]] * of(&trend, a)
        });
        let at = (EPS_STIFFNESS, EPS_STIFFNESS);
        (with, alike[at] + x * x * trend[at])
    }

    /// Slopes of the rows by the level of the moduli.
    pub(super) fn by_level(at: &Linearised, rows: usize) -> DVector<f64> {
        DVector::from_fn(rows, |j, _| at.by_invariants[j][0] + at.by_invariants[j][1])
    }
}

/// ln of the modulus ρ v² of a wave, and half its slopes by the invariants: those of ln v.
fn modulus(row: &SeriesRow, invariants: &Invariants) -> (f64, Slopes) {
    let shear = invariants.ln_shear.exp();
    if row.mode == SpeedMode::Bulk {
        return (invariants.ln_theta, Slopes::from([0.5, 0.0, 0.0, 0.0, 0.0]));
    }
    let Some(angle) = row.angle else {
        let bulk = invariants.ln_theta.exp();
        let [k, g] = if row.mode == SpeedMode::P { [1.0, 4.0 / 3.0] } else { [0.0, 1.0] };
        let all = k * bulk + g * shear;
        return (all.ln(), Slopes::from([k * bulk, g * shear, 0.0, 0.0, 0.0]) * (0.5 / all));
    };
    let (s, c) = angle.sin_cos();
    let [g12, g13, _, c11, c33, c13] = invariants.moduli();
    let (value, by) = if row.mode == SpeedMode::Sh {
        (g12 * s * s + g13 * c * c, [s * s, c * c, 0.0, 0.0, 0.0, 0.0])
    } else {
        // Christoffel's equation in the plane of direction and axis.
        let (across, along, mixed) =
            (c11 * s * s + g13 * c * c, c33 * c * c + g13 * s * s, (c13 + g13) * s * c);
        let half = 0.5 * (across - along);
        let root = half.hypot(mixed).max(f64::MIN_POSITIVE);
        let sign = if row.mode == SpeedMode::P { 1.0 } else { -1.0 };
        let (p, q, pq) =
            (0.5 * (1.0 + sign * half / root), 0.5 * (1.0 - sign * half / root), sign * 0.5 * mixed / root);
        let cross = 2.0 * pq * s * c;
        let by = [0.0, p * c * c + q * s * s + cross, 0.0, p * s * s, q * c * c, cross];
        (0.5 * (across + along) + sign * root, by)
    };
    let value = value.max(LEAST_MODULUS * shear);
    (value.ln(), RowSVector::from(by) * invariants.slopes() * (0.5 / value))
}
