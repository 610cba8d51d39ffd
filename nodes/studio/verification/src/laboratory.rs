//! Wave speeds that laboratories measured, each pressure predicted from the others by the inversion of a series.

use crate::error::VerificationError;
use crate::reference::table;
use crate::row::{Measure, Point, Row};
use grainlab_core::Material;
use grainlab_emt::{Calibration, EmtError, SeriesPrior, SeriesRow, SpeedMode, SpeedSeries, infer_series};

/// The name of the suite.
pub const NAME: &str = "laboratory";

const ZIMMER: &str = include_str!("../data/laboratory_zimmer.csv");
const DOMENICO: &str = include_str!("../data/laboratory_domenico.csv");
const HARDIN: &str = include_str!("../data/laboratory_hardin.csv");

/// Grains of glass beads, and of quartz.
const GLASS: Material = Material { shear_modulus: 29e9, poisson_ratio: 0.22, density: 2500.0 };
const QUARTZ: Material = Material { shear_modulus: 44e9, poisson_ratio: 0.08, density: 2650.0 };

/// Relative error of a speed from a correlation of G.
const OF_CORRELATION: f64 = 0.01;

const NOTE: &str = "Predicted: contact law, k_t/k_n and z are inferred from the other pressures. What is verified is the speeds, not z.";

/// A series of speeds of one sample.
fn series(
    rows: impl Iterator<Item = (f64, SpeedMode, f64, f64)>,
    density: f64,
    material: Material,
) -> SpeedSeries {
    let row = |(pressure, mode, speed, stddev)| SeriesRow {
        pressure,
        density,
        mode,
        angle: None,
        speed: Some(speed),
        stddev,
    };
    SpeedSeries {
        rows: rows.map(row).collect(),
        material,
        shear_modulus_stddev: 0.0,
        density_stddev: 0.0,
        pressure_stddev: 0.0,
        size_variance: 0.01,
        grains: None,
        ln_crossover: None,
    }
}

/// Rows of pressure, mode, speed and its error.
fn of_speeds(
    file: &'static str,
    text: &str,
    density: f64,
    material: Material,
) -> Result<SpeedSeries, VerificationError> {
    let mode = |code: f64| if code == 0.0 { SpeedMode::P } else { SpeedMode::Sv };
    let all = table(file, text)?;
    Ok(series(all.iter().map(|r| (r[0], mode(r[1]), r[2], r[3] / r[2])), density, material))
}

/// The samples, each with its name and source.
pub fn samples() -> Result<Vec<(String, &'static str, SpeedSeries)>, VerificationError> {
    let mut all = vec![
        (
            "dry sand, 0.06 to 12 MPa".to_owned(),
            "Zimmer, Prasad & Mavko, Geophysics 72, E1 (2007), as digitised for doi 10.1785/0220240469; density 1643 kg/m3 and quartz assumed",
            of_speeds("laboratory_zimmer.csv", ZIMMER, 1643.0, QUARTZ)?,
        ),
        (
            "glass beads, 2 to 34 MPa".to_owned(),
            "Domenico, Geophysics 42, 1339 (1977), as digitised for doi 10.1785/0220240469; density 1542 kg/m3 and glass assumed",
            of_speeds("laboratory_domenico.csv", DOMENICO, 1542.0, GLASS)?,
        ),
    ];
    let moduli = table("laboratory_hardin.csv", HARDIN)?;
    for void_ratio in [0.55, 0.6, 0.65] {
        let density = QUARTZ.density / (1.0 + void_ratio);
        let speed = |r: &Vec<f64>| (r[1], SpeedMode::Sv, (r[2] / density).sqrt(), OF_CORRELATION);
        let rows = moduli.iter().filter(|r| r[0] == void_ratio).map(speed);
        all.push((
            format!("Ottawa sand, void ratio {void_ratio}"),
            "Hardin & Richart (1963), the correlation of round sand; quartz assumed",
            series(rows, density, QUARTZ),
        ));
    }
    Ok(all)
}

/// The rows: the speeds of each mode of each sample.
pub fn rows() -> Result<Vec<Row>, VerificationError> {
    let fault = |e: EmtError| VerificationError::Data { file: "laboratory", why: e.to_string() };
    let network = Calibration::builtin("grainlab").and_then(|c| c.network.as_ref());
    let no_network =
        || VerificationError::Data { file: "grainlab.toml", why: "it has no network".to_owned() };
    let network = network.ok_or_else(no_network)?;
    let mut rows = Vec::new();
    for (name, source, series) in samples()? {
        let found = infer_series(&series, network, SeriesPrior::builtin()).map_err(fault)?;
        for (mode, word) in [(SpeedMode::P, "P"), (SpeedMode::Sv, "S")] {
            let of_mode = series.rows.iter().zip(&found.rows).filter(|(row, _)| row.mode == mode);
            let points: Vec<Point> = of_mode
                .map(|(row, to)| Point::new(row.pressure, row.speed.unwrap_or(f64::NAN), to.predicted))
                .collect();
            if !points.is_empty() {
                let name = format!("{word} of {name}, each pressure left out");
                rows.push(Row::new(NAME, name, source, "m/s", Measure::OfSum, 0.02, points).with_note(NOTE));
            }
        }
    }
    Ok(rows)
}
