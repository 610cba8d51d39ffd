//! Rows as JSON, as a text table, as CSV.

use super::args::Method;
use crate::numbers::rounded;
use grainlab_console::{Table, exact};
use grainlab_page::plot::Figure;
use serde::Serialize;

/// The whole result.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub(super) rows: Vec<Row>,
    pub(super) notes: [&'static str; 3],
}

const NOTES: [&str; 3] = [
    "value: error allowed to the square of a frequency (dispersion); seconds: CPU time of all threads for all speeds, the preparation of the packing included",
    "rms, largest, stated: of rho v^2, relative to p Gamma p of the frozen network; stated is the standard deviation \
     of the result, including the density, and sigmas the largest error over its own. It is zero for an exact measurement of a frozen \
     network, from which moving grains differ slightly",
    "moduli: largest relative error of C33, C11, C44, C66 and C13 by Christoffel, against the transversely isotropic projection \
     of the stiffness: three rays alone do not give its average over azimuths",
];

/// One method on one packing.
#[derive(Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) method: Method,
    /// The varied value.
    pub(crate) value: Option<f64>,
    pub(crate) grains: usize,
    pub(crate) speeds: usize,
    pub(crate) seconds: f64,
    pub(crate) wall_seconds: f64,
    pub(crate) error: Error,
    /// Why there is no result, or the warnings of the measurement.
    pub(crate) failure: Option<String>,
}

/// Relative errors of ρ v².
#[derive(Debug, Default, Serialize)]
pub(crate) struct Error {
    pub(crate) rms: Option<f64>,
    pub(crate) largest: Option<f64>,
    pub(crate) stated: Option<f64>,
    pub(crate) worst_sigmas: Option<f64>,
    pub(crate) moduli: Option<f64>,
}

pub(super) fn report(rows: Vec<Row>) -> Report {
    Report { rows, notes: NOTES }
}

/// As a text table.
pub(super) fn text(report: &Report, figure: &Figure) -> String {
    let mut text = table(&report.rows, rounded).text();
    for row in &report.rows {
        if let Some(failure) = &row.failure {
            text += &format!("{} {}: {failure}\n", row.method.name(), setting(row.value));
        }
    }
    text += &format!("\n{}\n", figure.text("the error that the method states"));
    report.notes.iter().for_each(|note| text += &format!("{note}\n"));
    text
}

/// Only the rows, as CSV.
pub(super) fn csv(report: &Report) -> String {
    table(&report.rows, exact).csv()
}

fn table(rows: &[Row], number: impl Fn(Option<f64>) -> String) -> Table {
    let header = [
        "method",
        "value",
        "grains",
        "speeds",
        "seconds",
        "wall_seconds",
        "rms",
        "largest",
        "stated",
        "sigmas",
        "moduli",
    ];
    let mut t = Table::new(header);
    let small = |e: Option<f64>| e.map_or_else(|| "-".to_owned(), |e| format!("{e:.1e}"));
    for r in rows {
        let e = &r.error;
        t.row([
            r.method.name().to_owned(),
            setting(r.value),
            r.grains.to_string(),
            r.speeds.to_string(),
            number(Some(r.seconds)),
            number(Some(r.wall_seconds)),
            small(e.rms),
            small(e.largest),
            small(e.stated),
            e.worst_sigmas.map_or_else(|| "-".to_owned(), |s| format!("{s:.1}")),
            small(e.moduli),
        ]);
    }
    t
}

fn setting(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |v| if v < 1.0 { format!("{v:e}") } else { format!("{v}") })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_method_has_a_row_without_numbers_and_a_reason() {
        let row = Row {
            method: Method::Peak,
            value: None,
            grains: 500,
            speeds: 0,
            seconds: 0.5,
            wall_seconds: 0.5,
            error: Error::default(),
            failure: Some("no arrival".to_owned()),
        };
        let report = report(vec![row]);
        assert!(text(&report, &crate::acoustics::plot::figure(&report)).contains("peak -: no arrival"));
        assert_eq!(csv(&report).lines().nth(1), Some("peak,-,500,0,0.5,0.5,-,-,-,-,-"));
    }
}
