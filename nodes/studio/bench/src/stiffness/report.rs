//! Rows and the exponents of the CPU time, as JSON, as a text table, as CSV.

use super::args::Method;
use crate::numbers::rounded;
use grainlab_console::{Table, exact, fixed};
use grainlab_page::plot::Figure;
use serde::Serialize;

/// The whole result.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub(super) rows: Vec<Row>,
    pub(super) exponents: Vec<Exponent>,
    pub(super) notes: [&'static str; 3],
}

const NOTES: [&str; 3] = [
    "seconds: CPU time of one thread for all 36 entries, network and factorisation included; median over the repetitions, \
     probes once",
    "error: largest difference of an entry over C11, against the frozen network solved to 1e-13, by cg or, where that \
     fails, directly. Contacts under the probe neither slide nor scale their tangential force: the network is its linear limit, \
     except for terms of the order of the pressure and for the motion while the packing first comes to rest",
    "exponent: of N in the CPU time, least squares over the logarithms; packings prepared at their size and copies of one \
     are never mixed: copies converge more easily",
];

/// One method on one packing.
#[derive(Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) method: Method,
    /// Relative residual of a solve, strain of a probe.
    pub(crate) value: Option<f64>,
    pub(crate) grains: usize,
    /// Whether the packing is a repetition of a smaller one.
    pub(crate) replicated: bool,
    pub(crate) coordination: f64,
    pub(crate) seconds: f64,
    /// Iterations of the solve, or solver steps of the probe.
    pub(crate) iterations: Option<u32>,
    pub(crate) error: Error,
    /// Why there is no result.
    pub(crate) failure: Option<String>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Error {
    /// Largest entry of the difference over C11.
    pub(crate) stiffness: Option<f64>,
    /// The reference of the error.
    pub(crate) against: &'static str,
}

/// seconds ∝ N^exponent.
#[derive(Debug, Serialize)]
pub(super) struct Exponent {
    pub(super) method: Method,
    pub(super) value: Option<f64>,
    pub(super) replicated: bool,
    pub(super) sizes: Vec<usize>,
    pub(super) exponent: f64,
}

pub(super) fn report(rows: Vec<Row>) -> Report {
    Report { exponents: exponents(&rows), rows, notes: NOTES }
}

/// For every method and value with at least two sizes.
fn exponents(rows: &[Row]) -> Vec<Exponent> {
    let key = |r: &Row| (r.method, r.value, r.replicated);
    let done: Vec<&Row> = rows.iter().filter(|r| r.failure.is_none()).collect();
    let mut found: Vec<Exponent> = Vec::new();
    for row in &done {
        let (method, value, replicated) = key(row);
        if found.iter().any(|e| (e.method, e.value, e.replicated) == key(row)) {
            continue;
        }
        let alike: Vec<&&Row> = done.iter().filter(|r| key(r) == key(row)).collect();
        let points: Vec<(f64, f64)> =
            alike.iter().map(|r| ((r.grains as f64).ln(), r.seconds.ln())).collect();
        if let Some(exponent) = slope(&points) {
            let sizes = alike.iter().map(|r| r.grains).collect();
            found.push(Exponent { method, value, replicated, sizes, exponent });
        }
    }
    found
}

/// Least-squares slope; `None` without two different abscissas.
fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let spread: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    let common: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    (spread > 1e-9).then(|| common / spread)
}

/// As text: rows, exponents, notes.
pub(super) fn text(report: &Report, figure: &Figure) -> String {
    let mut text = table(&report.rows, rounded).text();
    for row in &report.rows {
        if let Some(failure) = &row.failure {
            let value = setting(row.value);
            text += &format!("{} grains, {} {value}: {failure}\n", row.grains, row.method.name());
        }
    }
    if !report.exponents.is_empty() {
        let mut t = Table::new(["method", "value", "replicated", "sizes", "exponent of N"]);
        for e in &report.exponents {
            let sizes: Vec<String> = e.sizes.iter().map(usize::to_string).collect();
            let (value, sizes) = (setting(e.value), sizes.join(" "));
            t.row([e.method.name(), &value, yes(e.replicated), &sizes, &fixed(Some(e.exponent), 2)]);
        }
        text += &format!("\n{}", t.text());
    }
    text += &format!("\n{}\n", figure.text("copies of a packing"));
    for note in report.notes {
        text += &format!("{note}\n");
    }
    text
}

/// Only the rows, as CSV.
pub(super) fn csv(report: &Report) -> String {
    table(&report.rows, exact).csv()
}

fn table(rows: &[Row], number: impl Fn(Option<f64>) -> String) -> Table {
    let header =
        ["method", "value", "grains", "replicated", "coordination", "seconds", "iterations", "error"];
    let mut t = Table::new(header);
    for r in rows {
        t.row([
            r.method.name().to_owned(),
            setting(r.value),
            r.grains.to_string(),
            yes(r.replicated).to_owned(),
            number(Some(r.coordination)),
            number(Some(r.seconds)),
            r.iterations.map_or_else(|| "-".to_owned(), |n| n.to_string()),
            r.error.stiffness.map_or_else(|| "-".to_owned(), |e| format!("{e:.1e}")),
        ]);
    }
    t
}

fn setting(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |v| format!("{v:e}"))
}

fn yes(replicated: bool) -> &'static str {
    if replicated { "yes" } else { "no" }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(grains: usize, replicated: bool, seconds: f64) -> Row {
        let error = Error { stiffness: Some(1e-3), against: "truth" };
        Row {
            method: Method::Cg,
            value: Some(1e-8),
            grains,
            replicated,
            coordination: 5.0,
            seconds,
            iterations: None,
            error,
            failure: None,
        }
    }

    #[test]
    fn exponents_are_those_of_a_power_law_and_copies_have_their_own() {
        let law = |n: usize| 3e-6 * (n as f64).powf(1.25);
        let mut rows: Vec<Row> = [500, 2000, 16_000].map(|n| row(n, false, law(n))).into();
        rows.extend([8000, 64_000].map(|n| row(n, true, n as f64)));
        rows.push(Row { failure: Some("too hard".to_owned()), ..row(32_000, false, 1e9) });
        let found = report(rows).exponents;
        assert_eq!(found.len(), 2);
        assert!((found[0].exponent - 1.25).abs() < 1e-12 && !found[0].replicated);
        assert!((found[1].exponent - 1.0).abs() < 1e-12 && found[1].replicated);
        assert_eq!(found[0].sizes, [500, 2000, 16_000]);
    }

    #[test]
    fn one_size_has_no_exponent() {
        assert!(report(vec![row(500, false, 0.1), row(500, false, 0.2)]).exponents.is_empty());
    }
}
