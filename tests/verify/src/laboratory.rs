//! Wave speeds that laboratories measured, each pressure predicted from the others by the inversion of a series.

use crate::error::VerificationError;
use crate::row::{Measure, Point, Row};
use grainlab_core::Material;
use grainlab_emt::{Calibration, EmtError, SeriesPrior, SeriesRow, SpeedMode, SpeedSeries, infer_series};

/// The name of the suite.
pub const NAME: &str = "laboratory";

/// A file of speeds, the grains, and the sources of its samples by the beginnings of their names.
struct Measured {
    file: &'static str,
    text: &'static str,
    grains: Material,
    sources: &'static [(&'static str, &'static str)],
}

const FILES: [Measured; 2] = [
    Measured {
        file: "laboratory_quartz.csv",
        text: include_str!("../data/laboratory_quartz.csv"),
        grains: Material { shear_modulus: 44e9, poisson_ratio: 0.08, density: 2650.0 },
        sources: &[
            ("dry", "Zimmer, Prasad & Mavko, Geophysics 72, E1 (2007), digitised for doi 10.1785/0220240469"),
            ("ottawa", "Hardin & Richart (1963), the correlation of round sand"),
        ],
    },
    Measured {
        file: "laboratory_glass.csv",
        text: include_str!("../data/laboratory_glass.csv"),
        grains: Material { shear_modulus: 29e9, poisson_ratio: 0.22, density: 2500.0 },
        sources: &[("beads", "Domenico, Geophysics 42, 1339 (1977), digitised for doi 10.1785/0220240469")],
    },
];

const NOTE: &str = "Predicted: contact law, k_t/k_n and z are inferred from the other pressures. The speeds are verified, and z is not.";

const TOLERANCE: &str = "the mean stated error of the speeds (1 %, assumed for the digitised data)";

/// Samples whose speeds contradict each other by more than their stated errors, by name, with the reason.
const CONTRADICTORY: [(&str, &str); 1] = [(
    "beads",
    " These speeds scatter about twice as much as the 1 % assumed for them, most at the lowest pressures: at 2.758 MPa K/G is \
     0.70, which no packing has.",
)];

/// Mean difference over the stated error, up to which the difference of a contradictory sample is a known one.
const KNOWN: f64 = 3.0;

/// A sample with its name and source.
pub type LaboratorySample = (String, &'static str, SpeedSeries);

/// The samples of all files.
///
/// # Errors
/// A line that has no sample, pressure, density, mode, speed and standard deviation.
pub fn samples() -> Result<Vec<LaboratorySample>, VerificationError> {
    let mut all: Vec<LaboratorySample> = Vec::new();
    for Measured { file, text, grains, sources } in FILES {
        for line in text.lines().filter(|l| !l.starts_with('#')).skip(1) {
            let fault = || VerificationError::Data { file, why: format!("{line:?} has no speed") };
            let cells: Vec<&str> = line.split(',').collect();
            let [sample, pressure, density, mode, speed, sigma] = cells[..] else { return Err(fault()) };
            let number = |text: &str| text.parse::<f64>().map_err(|_| fault());
            let value = number(speed)?;
            let row = SeriesRow {
                pressure: number(pressure)?,
                density: number(density)?,
                mode: if mode == "p" { SpeedMode::P } else { SpeedMode::Sv },
                angle: None,
                speed: Some(value),
                stddev: number(sigma)? / value,
                common_stddev: 0.0,
            };
            match all.iter_mut().find(|(name, ..)| name == sample) {
                Some((_, _, series)) => series.rows.push(row),
                None => {
                    let source =
                        sources.iter().find(|(start, _)| sample.starts_with(start)).ok_or_else(fault)?.1;
                    all.push((sample.to_owned(), source, series(row, grains)));
                }
            }
        }
    }
    Ok(all)
}

fn series(row: SeriesRow, material: Material) -> SpeedSeries {
    SpeedSeries { size_variance: [0.01, 0.0], ..SpeedSeries::of(vec![row], material) }
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
            if points.is_empty() {
                continue;
            }
            let tolerance = stated_error(&series, mode);
            let reason = CONTRADICTORY.iter().find(|(sample, _)| *sample == name).map(|(_, reason)| *reason);
            let title = format!("{word} of {name}, each pressure left out");
            let row = Row::new(NAME, title, source, "m/s", Measure::OfSum, tolerance, points);
            let row = row.with_tolerance_from(TOLERANCE);
            rows.push(match reason {
                Some(reason) => row.with_known_difference(KNOWN * tolerance, format!("{NOTE}{reason}")),
                None => row.with_note(NOTE),
            });
        }
    }
    Ok(rows)
}

/// Returns the sum of the stated errors of the speeds of a mode over the sum of the speeds.
fn stated_error(series: &SpeedSeries, mode: SpeedMode) -> f64 {
    let of_mode = || series.rows.iter().filter(|row| row.mode == mode);
    let speeds: f64 = of_mode().filter_map(|row| row.speed).sum();
    of_mode().filter_map(|row| Some(row.speed? * row.stddev)).sum::<f64>() / speeds
}
