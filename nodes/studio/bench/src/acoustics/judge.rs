//! Errors of speeds in units of those stated, over many packings.

use super::args::{Args, Method};
use super::measure::stiffness;
use crate::packing::load_all;
use grainlab_acoustics::time_of_flight::{self, ArrivalPick};
use grainlab_acoustics::{MethodSettings, Settings, measure};
use grainlab_console::{Failure, Table, exact, fixed, say};
use grainlab_core::{Packing, WaveSpeed};
use grainlab_node_kit::Exit;
use serde::Serialize;

/// Half the width of a 95 % interval, standard deviations.
const INTERVAL: f64 = 1.96;

const NOTE: &str = "sigmas: the speed less that of the frozen network in the same direction and polarization, with the mass that moves \
with the wave, over the standard deviation stated; 1 and 95 % for errors that are normally distributed";

/// All speeds by one method.
#[derive(Debug, Serialize)]
struct Row {
    method: Method,
    packings: usize,
    /// Packings on which the method failed.
    failed: usize,
    speeds: usize,
    /// Root mean square of the relative errors found.
    found: Option<f64>,
    /// Median of the relative standard deviations stated.
    stated: Option<f64>,
    rms_sigmas: Option<f64>,
    mean_sigmas: Option<f64>,
    median_sigmas: Option<f64>,
    /// Fraction within the 95 % interval.
    covered: Option<f64>,
    worst_sigmas: Option<f64>,
}

/// Error of one speed, relative, and the standard deviation stated.
#[derive(Clone, Copy, Debug)]
struct Deviation {
    found: f64,
    stated: f64,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let packings = load_all(&args.packing)?;
    let mut rows = Vec::new();
    for method in args.methods() {
        let (mut all, mut failed) = (Vec::new(), 0);
        for packing in &packings {
            match deviations(*method, packing, args)? {
                Some(found) => all.extend(found),
                None => failed += 1,
            }
        }
        rows.push(row(*method, packings.len(), failed, &all));
    }
    args.format.print(
        &rows,
        || table(&rows, exact).csv(),
        || format!("{}\n{NOTE}\n", table(&rows, |v| fixed(v, 2)).text()),
    )?;
    Ok(Exit::Done)
}

/// `None` if the method has no speeds; the reason is printed to stderr.
fn deviations(method: Method, packing: &Packing, args: &Args) -> Result<Option<Vec<Deviation>>, Failure> {
    let network = stiffness(packing)?;
    let settings = Settings { method: usual(method), survey: args.survey.into(), ..Settings::default() };
    let measurement = match measure(packing, &settings) {
        Ok(measurement) => measurement,
        Err(reason) => {
            say!("grainlab: {} of step {}: {reason}", method.name(), packing.step);
            return Ok(None);
        }
    };
    let of = |wave: &WaveSpeed| {
        let expected = measurement.effective_density.speed(&network, &wave.direction, &wave.polarization);
        Some(Deviation { found: wave.speed / expected - 1.0, stated: wave.stddev? / wave.speed })
    };
    Ok(Some(measurement.waves.iter().filter_map(|m| of(&m.wave)).collect()))
}

/// The default settings of a method.
fn usual(method: Method) -> MethodSettings {
    let flight = |pick| MethodSettings::TimeOfFlight(time_of_flight::Settings { pick, ..Default::default() });
    match method {
        Method::Dispersion => MethodSettings::Dispersion(Default::default()),
        Method::FirstArrival => flight(ArrivalPick::FirstArrival),
        Method::CrossCorrelation => flight(ArrivalPick::CrossCorrelation),
        Method::Peak => flight(ArrivalPick::Peak),
    }
}

fn row(method: Method, packings: usize, failed: usize, all: &[Deviation]) -> Row {
    let mut sigmas: Vec<f64> = all.iter().map(|d| d.found / d.stated).collect();
    let mean = |of: &dyn Fn(&Deviation) -> f64| {
        (!all.is_empty()).then(|| all.iter().map(of).sum::<f64>() / all.len() as f64)
    };
    let mut stated: Vec<f64> = all.iter().map(|d| d.stated).collect();
    let mean_sigmas = mean(&|d| d.found / d.stated);
    sigmas.iter_mut().for_each(|s| *s = s.abs());
    Row {
        method,
        packings,
        failed,
        speeds: all.len(),
        found: mean(&|d| d.found.powi(2)).map(f64::sqrt),
        stated: median(&mut stated),
        rms_sigmas: mean(&|d| (d.found / d.stated).powi(2)).map(f64::sqrt),
        mean_sigmas,
        covered: mean(&|d| f64::from(u8::from((d.found / d.stated).abs() <= INTERVAL))),
        worst_sigmas: sigmas.iter().copied().reduce(f64::max),
        median_sigmas: median(&mut sigmas),
    }
}

fn median(of: &mut [f64]) -> Option<f64> {
    of.sort_by(f64::total_cmp);
    of.get(of.len() / 2).copied()
}

fn table(rows: &[Row], number: impl Fn(Option<f64>) -> String) -> Table {
    let mut t = Table::new([
        "method",
        "packings",
        "failed",
        "speeds",
        "found",
        "stated",
        "rms_sigmas",
        "mean_sigmas",
        "median_sigmas",
        "covered",
        "worst_sigmas",
    ]);
    let small = |e: Option<f64>| e.map_or_else(|| "-".to_owned(), |e| format!("{e:.1e}"));
    for r in rows {
        t.row([
            r.method.name().to_owned(),
            r.packings.to_string(),
            r.failed.to_string(),
            r.speeds.to_string(),
            small(r.found),
            small(r.stated),
            number(r.rms_sigmas),
            number(r.mean_sigmas),
            number(r.median_sigmas),
            r.covered.map_or_else(|| "-".to_owned(), |c| format!("{c:.3}")),
            number(r.worst_sigmas),
        ]);
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_counts_what_is_within_two_sigma() {
        let all = [(1e-3, 1e-3), (-2e-3, 1e-3), (0.0, 1e-3), (5e-3, 1e-3)]
            .map(|(found, stated)| Deviation { found, stated });
        let row = row(Method::Peak, 2, 1, &all);
        assert_eq!((row.speeds, row.failed, row.covered, row.worst_sigmas), (4, 1, Some(0.5), Some(5.0)));
        assert!(
            (row.mean_sigmas.unwrap() - 1.0).abs() < 1e-12
                && (row.rms_sigmas.unwrap() - 7.5f64.sqrt()).abs() < 1e-12
        );
        assert!(table(&[row], |v| fixed(v, 2)).csv().contains("peak,2,1,4,"));
    }

    #[test]
    fn a_method_without_speeds_has_a_row_without_numbers() {
        let row = row(Method::Peak, 1, 1, &[]);
        assert_eq!((row.covered, row.median_sigmas), (None, None));
        assert!(table(&[row], |v| fixed(v, 2)).csv().contains("peak,1,1,0,-,-,-,-,-,-,-"));
    }
}
