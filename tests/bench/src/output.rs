//! Rows of time against error as a text table, CSV, JSON and a figure.

use crate::plot;
use crate::row::{Row, families, mark_fronts};
use grainlab_console::{Failure, Format, Table, exact, json, say, three_digits, write_whole};
use grainlab_node_kit::Exit;
use grainlab_page::plot::Theme;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Largest number of details in a text table; more are only in CSV and JSON.
const SHOWN: usize = 9;

/// Options of every bench that compares time with error.
#[derive(Debug, clap::Args)]
pub(crate) struct Output {
    /// Folder for every row as CSV, JSON and SVG, named after the bench
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Output {
    /// Creates the folder: before long computations, not after.
    pub(crate) fn ready(&self) -> Result<(), Failure> {
        let Some(folder) = &self.out else { return Ok(()) };
        std::fs::create_dir_all(folder).map_err(Failure::at(folder))
    }

    /// Writes and prints the rows of a bench.
    pub(crate) fn finish(&self, bench: &str, mut rows: Vec<Row>) -> Result<Exit, Failure> {
        mark_fronts(&mut rows);
        let report = Report { exponents: exponents(&rows), rows };
        if let Some(folder) = &self.out {
            write(&folder.join(bench), "json", &json(&report)?)?;
            write(&folder.join(bench), "csv", &csv(&report.rows))?;
            write(&folder.join(bench), "svg", &plot::figure(&report.rows).svg(Theme::System))?;
        }
        self.format.print(&report, || csv(&report.rows), || text(&report))?;
        Ok(Exit::Done)
    }
}

fn write(path: &Path, extension: &str, text: &str) -> Result<(), Failure> {
    let path = path.with_extension(extension);
    write_whole(&path, text)?;
    say!("grainlab: {} written", path.display());
    Ok(())
}

#[derive(Debug, Serialize)]
struct Report {
    rows: Vec<Row>,
    exponents: Vec<Exponent>,
}

/// seconds ∝ N^exponent.
#[derive(Debug, Serialize)]
struct Exponent {
    method: String,
    setting: String,
    sizes: Vec<usize>,
    exponent: f64,
}

/// For every method and setting with at least two sizes.
fn exponents(rows: &[Row]) -> Vec<Exponent> {
    let mut found: Vec<Exponent> = Vec::new();
    for row in rows {
        let alike = rows.iter().filter(|r| (&r.method, &r.setting) == (&row.method, &row.setting));
        let points: Vec<(usize, f64)> =
            alike.filter(|r| r.error.is_some()).filter_map(|r| Some((r.grains?, r.seconds))).collect();
        let (method, setting) = (row.method.clone(), row.setting.clone());
        let new = found.iter().all(|e| (&e.method, &e.setting) != (&method, &setting));
        if let Some(exponent) = slope(&points).filter(|_| new) {
            let sizes = points.iter().map(|p| p.0).collect();
            found.push(Exponent { method, setting, sizes, exponent });
        }
    }
    found
}

/// Least-squares slope of the logarithms; `None` without two different sizes.
fn slope(points: &[(usize, f64)]) -> Option<f64> {
    let points: Vec<(f64, f64)> = points.iter().map(|p| ((p.0 as f64).ln(), p.1.ln())).collect();
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let spread: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    let common: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    (spread > 1e-9).then(|| common / spread)
}

/// A block for each family, under what its time and its error are.
fn text(report: &Report) -> String {
    let mut text = String::new();
    for family in families(&report.rows) {
        let of: Vec<&Row> = report.rows.iter().filter(|r| r.family == family).collect();
        let Some(first) = of.first() else { continue };
        text += &format!(
            "{}\n  time:  {}\n  error: {}\n  against {}\n{}\n",
            family.name(),
            first.time_of,
            first.error_of,
            first.reference,
            block(&of).without_empty_columns().text()
        );
    }
    for row in &report.rows {
        if let Some(failure) = &row.failure {
            text += &format!("{} {}: {failure}\n", row.method, row.setting);
        }
    }
    for e in &report.exponents {
        let sizes: Vec<String> = e.sizes.iter().map(usize::to_string).collect();
        let (method, setting, sizes) = (&e.method, &e.setting, sizes.join(", "));
        text += &format!("{method} {setting}: time as N^{:.2} at {sizes} grains\n", e.exponent);
    }
    text + "* no other row of the family is as fast and as accurate; < not resolved: an upper bound\n"
}

fn names(rows: &[&Row]) -> BTreeSet<&'static str> {
    rows.iter().flat_map(|r| r.details.keys().copied()).collect()
}

fn block(rows: &[&Row]) -> Table {
    let names = Some(names(rows)).filter(|names| names.len() <= SHOWN).unwrap_or_default();
    let head = ["method", "setting", "grains", "runs", "time", "error", "front"];
    let mut t = Table::new(head.into_iter().chain(names.iter().copied()));
    for row in rows {
        let bound = if row.upper_bound { "< " } else { "" };
        let cells = [
            row.method.clone(),
            if row.setting.is_empty() { "-".to_owned() } else { row.setting.clone() },
            row.grains.map_or_else(|| "-".to_owned(), |n| n.to_string()),
            row.repetitions.to_string(),
            plot::time(row.seconds),
            row.error.map_or_else(|| "-".to_owned(), |e| format!("{bound}{}", short(e))),
            if row.on_front { "*" } else { "" }.to_owned(),
        ];
        let detail = |name| row.details.get(name).map_or_else(|| "-".to_owned(), |v| short(*v));
        t.row(cells.into_iter().chain(names.iter().map(detail)));
    }
    t
}

/// Rows with every column.
fn csv(rows: &[Row]) -> String {
    let names = names(&rows.iter().collect::<Vec<_>>());
    let head = ["family", "method", "setting", "grains", "seconds", "repetitions", "time_of", "error"];
    let tail = ["upper_bound", "error_of", "reference", "on_front", "failure"];
    let mut t = Table::new(head.into_iter().chain(tail).chain(names.iter().copied()));
    for r in rows {
        let cells = [
            r.family.name().to_owned(),
            r.method.clone(),
            r.setting.clone(),
            r.grains.map(|n| n.to_string()).unwrap_or_default(),
            exact(Some(r.seconds)),
            r.repetitions.to_string(),
            r.time_of.to_owned(),
            exact(r.error),
            r.upper_bound.to_string(),
            r.error_of.to_owned(),
            r.reference.to_owned(),
            r.on_front.to_string(),
            r.failure.clone().unwrap_or_default(),
        ];
        t.row(cells.into_iter().chain(names.iter().map(|name| exact(r.details.get(name).copied()))));
    }
    t.csv()
}

/// Counts in full, other numbers with three digits.
fn short(value: f64) -> String {
    if value == value.trunc() { value.to_string() } else { three_digits(Some(value), 0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::Family;

    fn row(family: Family, grains: usize, seconds: f64) -> Row {
        let row = Row::new(family, ("cg", "1e-8"), (seconds, 3), (Some(1e-3), "the truth"));
        Row { grains: Some(grains), ..row }
    }

    fn whole(rows: Vec<Row>) -> Report {
        Report { exponents: exponents(&rows), rows }
    }

    #[test]
    fn exponents_are_those_of_a_power_law_and_copies_have_their_own() {
        let law = |n: usize| 3e-6 * (n as f64).powf(1.25);
        let mut rows: Vec<Row> = [500, 2000, 16_000].map(|n| row(Family::Stiffness, n, law(n))).into();
        let copies = |n: usize| Row { method: "cg, copies".into(), ..row(Family::Stiffness, n, n as f64) };
        rows.extend([8000, 64_000].map(copies));
        rows.push(Row { error: None, ..row(Family::Stiffness, 32_000, 1e9) });
        let found = exponents(&rows);
        assert_eq!(found.len(), 2);
        assert!((found[0].exponent - 1.25).abs() < 1e-12 && (found[1].exponent - 1.0).abs() < 1e-12);
        assert_eq!(found[0].sizes, [500, 2000, 16_000]);
        assert!(exponents(&[row(Family::Stiffness, 500, 0.1), row(Family::Stiffness, 500, 0.2)]).is_empty());
    }

    #[test]
    fn the_table_fits_100_columns_and_says_of_each_error_what_it_is() {
        use Family::*;
        let all = [InversionEps, InversionZ, Stiffness, EngineEnergy, EnginePacking, Waves];
        let text = text(&whole(all.map(|family| row(family, 500, 1.0)).into()));
        assert!(text.lines().all(|l| l.chars().count() <= 100), "{text}");
        for family in all {
            assert!(text.contains(family.words()[2]), "{}", family.name());
        }
    }

    #[test]
    fn a_failed_method_has_a_row_without_numbers_and_a_reason() {
        let failed = Row { error: None, failure: Some("no arrival".into()), ..row(Family::Waves, 500, 0.5) };
        assert!(text(&whole(vec![failed.clone()])).contains("cg 1e-8: no arrival"));
        assert!(csv(&[failed]).contains("waves,cg,1e-8,500,0.5,3,"));
    }

    #[test]
    fn counts_are_printed_in_full_and_small_errors_as_powers() {
        assert_eq!([45.0, 5.109, 0.44, 6.6e-9].map(short), ["45", "5.11", "0.440", "6.60e-9"]);
    }
}
