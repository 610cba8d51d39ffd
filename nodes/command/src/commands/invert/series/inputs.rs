//! The speeds of one sample from the rows of a table and the flags, with units checked.

use super::super::args::Args;
use super::super::speed_table::SpeedLine;
use super::super::speeds::NO_DENSITY;
use grainlab_core::Material;
use grainlab_emt::{ContactKind, SeriesRow, SpeedMode, SpeedSeries, UNKNOWN_SIZE_SPREAD};
use std::f64::consts::PI;

const DEFAULT_ERROR: f64 = 0.01;

/// Solid fraction that is not given, and standard deviation of a roughness that has none.
const PHI: f64 = 0.62;
const ROUGHNESS_ERROR: f64 = 0.3;

/// Pressures over E* that a sample has.
const PRESSURES: [f64; 2] = [1e-8, 1e-2];

/// Densities of samples and grains, kg/m³.
const DENSITIES: [f64; 2] = [200.0, 10_000.0];

/// Shear moduli of grains, Pa.
const SHEAR_MODULI: [f64; 2] = [1e5, 1e12];

impl Args {
    /// The speeds of one sample, and what was assumed of it; or the first fault, with its line and column.
    pub(in super::super) fn series(&self, lines: &[SpeedLine]) -> Result<(SpeedSeries, Vec<String>), String> {
        const GRAINS: &str = "--grain-shear-modulus PA and --poisson NU: the material of the grains is needed (glass: 29e9 and 0.2, quartz: 44e9 and 0.08)";
        let shear_modulus = self.grain_shear_modulus.ok_or(GRAINS)?;
        let poisson_ratio = self.poisson.ok_or(GRAINS)?;
        if !(SHEAR_MODULI[0]..SHEAR_MODULI[1]).contains(&shear_modulus) {
            return Err(format!(
                "--grain-shear-modulus {shear_modulus} must be from 1e5 to 1e12: Pa is expected (glass: 29e9, quartz: 44e9)"
            ));
        }
        if let Some([first, second]) = repeated(lines) {
            return Err(format!(
                "duplicate rows: lines {first} and {second} are the same; keep one of them, and of speeds that were measured again their mean"
            ));
        }
        let mut assumed = Vec::new();
        if let Some(spread) = self.size_spread.filter(|s| !(0.0..=0.5).contains(s)) {
            return Err(format!("--size-spread {spread} must be from 0 to 0.5"));
        }
        let mut rows = Vec::new();
        let (mut without_error, mut dispersed) = (0, 0);
        let material = Material { shear_modulus, poisson_ratio, density: 2500.0 };
        for line in lines {
            let fault = |text: String| format!("line {}: {text}", line.line);
            let pressure = line.pressure_pa.or(self.pressure);
            let pressure = pressure
                .ok_or_else(|| fault("column pressure_pa is empty: give it, or --pressure".to_owned()))?;
            let share = pressure / material.effective_young();
            if !(PRESSURES[0]..PRESSURES[1]).contains(&share) {
                return Err(fault(format!(
                    "column pressure_pa: {pressure} Pa is {share:.1e} of the grains' E*, from {:e} to {:e} in samples; Pa is expected",
                    PRESSURES[0], PRESSURES[1]
                )));
            }
            let density = line.density().or(self.density).ok_or_else(|| fault(NO_DENSITY.to_owned()))?;
            for (column, value) in [("grain_density", line.grain_density), ("density", Some(density))] {
                if let Some(value) = value.filter(|v| !(DENSITIES[0]..DENSITIES[1]).contains(v)) {
                    return Err(fault(format!(
                        "column {column}: {value} must be from 200 to 10000; kg/m3 is expected"
                    )));
                }
            }
            let stddev = match (line.speed, line.speed_sigma) {
                (Some(speed), Some(sigma)) => sigma / speed,
                (speed, _) => {
                    without_error += usize::from(speed.is_some());
                    self.error.unwrap_or(DEFAULT_ERROR)
                }
            };
            let mut common_stddev = line.speed.map_or(0.0, |v| line.speed_shared_sigma.unwrap_or(0.0) / v);
            if let Some(speed) = line.speed {
                // Waves in a packing are slower than in its grains, with P modulus K + 4/3 G, at the sample's density over φ.
                let nu = poisson_ratio.min(0.45);
                let stiff = shear_modulus * (2.0 - 2.0 * nu) / (1.0 - 2.0 * nu);
                let fastest = (stiff / density).sqrt();
                if speed > fastest || speed < 1.0 {
                    return Err(fault(format!(
                        "column speed: {speed} m/s is not between 1 and {fastest:.0} m/s, the speed in the grains; m/s is expected"
                    )));
                }
                if let Some((frequency, diameter)) = line.frequency.zip(line.diameter) {
                    let per_wave = frequency * diameter / speed;
                    if per_wave > 0.5 {
                        return Err(fault(format!(
                            "the wavelength, {:.3e} m, is below two diameters; Hz and m are expected",
                            speed / frequency
                        )));
                    }
                    if per_wave > 1.0 / 15.0 {
                        // Dispersion of a chain of grains, (π D/λ)²/6.
                        common_stddev = common_stddev.hypot((PI * per_wave).powi(2) / 6.0);
                        dispersed += 1;
                    }
                }
            }
            if line.diameter.is_none() && (line.frequency.is_some() || line.roughness.is_some()) {
                return Err(fault("frequency and roughness need the column diameter".to_owned()));
            }
            if let Some(diameter) = line.diameter.filter(|d| !(1e-6..0.2).contains(d)) {
                return Err(fault(format!(
                    "column diameter: {diameter} must be from 1e-6 to 0.2; m is expected"
                )));
            }
            if line.roughness != lines[0].roughness || line.diameter != lines[0].diameter {
                return Err(fault(
                    "roughness and diameter must be the same in all rows of a sample".to_owned(),
                ));
            }
            let (mode, angle) = line.wave;
            rows.push(SeriesRow { pressure, density, mode, angle, speed: line.speed, stddev, common_stddev });
        }
        if without_error > 0 {
            let error = 100.0 * self.error.unwrap_or(DEFAULT_ERROR);
            assumed.push(format!("{without_error} speeds without speed_sigma have an error of {error} %"));
        }
        if dispersed > 0 {
            assumed.push(format!(
                "{dispersed} speeds with a wavelength below 15 diameters have a larger error, for dispersion"
            ));
        }
        let (spread, spread_error) = self.size_spread.map_or_else(
            || {
                assumed.push("the spread of the sizes is not known: any from 0 to 0.3".to_owned());
                (UNKNOWN_SIZE_SPREAD.value, UNKNOWN_SIZE_SPREAD.variance_stddev())
            },
            |known| (known, 0.0),
        );
        if lines.iter().any(|l| l.phi.is_some_and(|phi| phi < 0.5)) {
            assumed.push(
                "phi below 0.5 was taken as the solid fraction, which is 1 less the porosity".to_owned(),
            );
        }
        if let Some(line) = swapped(lines) {
            return Err(format!(
                "line {line}: this S wave is too fast for the P wave of the same pressure: the bulk modulus would be negative; are p and s exchanged?"
            ));
        }
        let relative = |of: fn(&SpeedLine, &SeriesRow) -> (Option<f64>, f64), flag: f64| {
            let all = lines.iter().zip(&rows).map(|(line, row)| of(line, row));
            all.map(|(sigma, value)| sigma.unwrap_or(flag) / value).sum::<f64>() / rows.len() as f64
        };
        let density_stddev = relative(|line, row| (line.density_sigma, row.density), self.density_sigma);
        let pressure_stddev =
            relative(|line, row| (line.pressure_sigma_pa, row.pressure), self.pressure_sigma);
        let first = |of: fn(&SpeedLine) -> Option<f64>| lines.iter().find_map(of);
        let rough = lines.iter().find_map(|l| Some((l, l.roughness?, l.diameter?)));
        if let Some((line, roughness, diameter)) = rough
            && roughness > 0.1 * diameter
        {
            return Err(format!(
                "line {}: column roughness: {roughness} m is more than a tenth of the diameter",
                line.line
            ));
        }
        let ln_crossover =
            rough.filter(|(_, roughness, _)| *roughness > 0.0).map(|(line, roughness, diameter)| {
                let crossover =
                    ContactKind::crossover(roughness / diameter, &material, first(|l| l.phi).unwrap_or(PHI));
                let error = line.roughness_sigma.map_or(ROUGHNESS_ERROR, |sigma| sigma / roughness);
                [crossover.ln(), 1.5 * error]
            });
        let series = SpeedSeries {
            shear_modulus_stddev: self.grain_shear_modulus_sigma / shear_modulus,
            density_stddev,
            pressure_stddev,
            size_variance: [spread * spread, spread_error],
            grains: self.grains,
            ln_crossover,
            ..SpeedSeries::of(rows, material)
        };
        for (name, error) in [
            ("pressure", series.pressure_stddev),
            ("density", series.density_stddev),
            ("grain shear modulus", series.shear_modulus_stddev),
        ] {
            if error > 0.5 {
                return Err(format!(
                    "the standard deviation of the {name} is {:.0} % of it: at most 50 % is expected",
                    100.0 * error
                ));
            }
        }
        Ok((series, assumed))
    }
}

/// Numbers of two lines with the same cells, one of them a speed.
fn repeated(lines: &[SpeedLine]) -> Option<[u64; 2]> {
    let again = |(n, of): (usize, &SpeedLine)| {
        let mut of = of.clone();
        let line = of.line;
        let mut later = lines[n + 1..].iter().filter(|l| l.speed.is_some());
        let is_same = |later: &&SpeedLine| {
            of.line = later.line;
            of == **later
        };
        later.find(is_same).map(|l| [line, l.line])
    };
    lines.iter().enumerate().find_map(again)
}

/// The line of an S wave with 4/3 vₛ² above v_p², without directions at one pressure.
fn swapped(lines: &[SpeedLine]) -> Option<u64> {
    let of = |mode: SpeedMode| lines.iter().filter(move |l| l.wave == (mode, None));
    of(SpeedMode::Sv).find_map(|s| {
        let same = of(SpeedMode::P).filter(|p| p.pressure_pa == s.pressure_pa);
        let is_slower = |p: &SpeedLine| Some(p.speed? * p.speed? < 4.0 / 3.0 * s.speed? * s.speed?);
        same.filter_map(is_slower).any(|slower| slower).then_some(s.line)
    })
}
