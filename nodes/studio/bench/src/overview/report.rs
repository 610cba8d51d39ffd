//! Rows as JSON, as a text table, as CSV.

use super::row::{Family, Row};
use crate::accuracy::front::front;
use grainlab_console::{Table, exact};
use serde::Serialize;

/// The whole result.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub(super) rows: Vec<Row>,
}

/// In the order of the families, with the front of each.
pub(super) fn report(rows: Vec<Row>) -> Report {
    let mut sorted = Vec::new();
    for family in Family::ALL {
        let mut of: Vec<Row> = rows.iter().filter(|r| r.family == family).cloned().collect();
        let points: Vec<(f64, f64)> = of.iter().map(|r| (r.seconds, r.error)).collect();
        for (row, on_front) in of.iter_mut().zip(front(&points)) {
            row.on_front = on_front;
        }
        sorted.extend(of);
    }
    Report { rows: sorted }
}

/// A block for each family, under what its time and its error are.
pub(super) fn text(report: &Report) -> String {
    let mut t = Table::new(["method", "setting", "time", "error", "front"]);
    for row in &report.rows {
        let bound = if row.upper_bound { "< " } else { "" };
        t.row([
            row.method.clone(),
            if row.setting.is_empty() { "-".to_owned() } else { row.setting.clone() },
            time(row.seconds),
            format!("{bound}{}", error(row.error)),
            if row.on_front { "*" } else { "" }.to_owned(),
        ]);
    }
    let table = t.text();
    let mut lines = table.lines();
    let mut text = format!("{}\n", lines.next().unwrap_or_default());
    for family in Family::ALL {
        let mut of = report.rows.iter().filter(|r| r.family == family).peekable();
        let Some(first) = of.peek() else { continue };
        text += &format!(
            "\n{}\n  time:  {}\n  error: {}\n  against {}\n",
            family.name(),
            first.time_of,
            first.error_of,
            first.reference
        );
        for line in lines.by_ref().take(of.count()) {
            text += &format!("{line}\n");
        }
    }
    text += "\n* no other setting of the family is as fast and as accurate; < not resolved: an upper bound\n";
    text
}

/// Every column.
pub(super) fn csv(report: &Report) -> String {
    let mut t = Table::new([
        "family",
        "method",
        "setting",
        "seconds",
        "repetitions",
        "time_of",
        "error",
        "upper_bound",
        "error_of",
        "reference",
        "on_front",
    ]);
    for r in &report.rows {
        t.row([
            r.family.name().to_owned(),
            r.method.clone(),
            r.setting.clone(),
            exact(Some(r.seconds)),
            r.repetitions.to_string(),
            r.time_of.to_owned(),
            exact(Some(r.error)),
            r.upper_bound.to_string(),
            r.error_of.to_owned(),
            r.reference.to_owned(),
            r.on_front.to_string(),
        ]);
    }
    t.csv()
}

/// Two digits.
fn error(value: f64) -> String {
    if (0.1..1e3).contains(&value) { format!("{value:.1}") } else { format!("{value:.1e}") }
}

/// Two digits and a unit.
pub(super) fn time(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-3 => (1e6 * s, "us"),
        s if s < 1.0 => (1e3 * s, "ms"),
        s => (s, "s"),
    };
    let digits = usize::from(value < 10.0);
    format!("{value:.digits$} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(family: Family, seconds: f64, error: f64) -> Row {
        Row::new(family, ("method", "1e-2"), (seconds, 3), (error, "the truth"))
    }

    #[test]
    fn a_row_is_on_the_front_of_its_own_family_whatever_others_take() {
        let rows = vec![
            row(Family::Waves, 1.0, 1e-3),
            row(Family::Stiffness, 2.0, 1e-2),
            row(Family::Stiffness, 3.0, 1e-1),
            row(Family::Stiffness, 3.0, 1e-4),
        ];
        let on: Vec<_> = report(rows).rows.iter().map(|r| (r.family, r.on_front)).collect();
        let stiffness = |on| (Family::Stiffness, on);
        assert_eq!(on, [stiffness(true), stiffness(false), stiffness(true), (Family::Waves, true)]);
    }

    #[test]
    fn the_table_fits_100_columns_and_says_of_each_error_what_it_is() {
        let rows = Family::ALL.map(|family| row(family, 1.0, 0.1));
        let text = text(&report(rows.into()));
        assert!(text.lines().all(|l| l.chars().count() <= 100), "{text}");
        for family in Family::ALL {
            assert!(text.contains(family.error_of()), "{}", family.name());
        }
    }

    #[test]
    fn times_have_the_unit_that_leaves_few_digits() {
        assert_eq!(
            [1.23e-6, 4.56e-5, 0.0123, 1.66, 131.7].map(time),
            ["1.2 us", "46 us", "12 ms", "1.7 s", "132 s"]
        );
    }
}
