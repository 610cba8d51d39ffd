//! The comparisons as a table.

use grainlab_console::{Table, count, exact};
use grainlab_verification::{Measure, Row, Verdict};
use serde::Serialize;

/// A comparison with what follows from it.
#[derive(Serialize)]
pub(super) struct Judged<'a> {
    #[serde(flatten)]
    row: &'a Row,
    difference: Option<f64>,
    unexplained_difference: Option<f64>,
    verdict: Verdict,
}

impl<'a> Judged<'a> {
    /// The judgement of a row.
    pub(super) fn new(row: &'a Row) -> Self {
        let (difference, unexplained_difference) = (row.difference(), row.unexplained());
        Self { row, difference, unexplained_difference, verdict: row.verdict() }
    }
}

/// The table, the notes of all that does not pass, and a summary.
pub(super) fn text(rows: &[Row]) -> String {
    let mut table = Table::new([
        "comparison",
        "source",
        "points",
        "theirs",
        "ours",
        "difference",
        "tolerance",
        "verdict",
    ]);
    let mut notes: Vec<&str> = Vec::new();
    for row in rows {
        let verdict = row.verdict();
        let mut word = verdict.word().to_owned();
        if verdict != Verdict::Passed && !row.note.is_empty() {
            let known = notes.iter().position(|n| *n == row.note);
            let number = known.unwrap_or_else(|| {
                notes.push(&row.note);
                notes.len() - 1
            });
            word += &format!(" [{}]", number + 1);
        }
        let worst = row.worst();
        table.row([
            format!("{}: {}", row.suite, row.name),
            short(&row.source).to_owned(),
            row.points.len().to_string(),
            worst.map_or_else(dash, |p| with_unit(p.theirs, row.unit)),
            worst.map_or_else(dash, |p| with_unit(p.ours, row.unit)),
            row.difference().map_or_else(dash, |d| amount(d, row)),
            row.difference().map_or_else(dash, |_| amount(row.tolerance, row)),
            word,
        ]);
    }
    let mut text = table.text();
    for (n, note) in notes.iter().enumerate() {
        text += &format!("[{}] {note}\n", n + 1);
    }
    text + &summary(rows)
}

/// How many comparisons there are of each verdict.
fn summary(rows: &[Row]) -> String {
    let of = |verdict| rows.iter().filter(|r| r.verdict() == verdict).count();
    format!(
        "{}: {} passed, {} explained, {} not comparable, {} failed\n",
        count(rows.len(), "comparison"),
        of(Verdict::Passed),
        of(Verdict::Explained),
        of(Verdict::NotComparable),
        of(Verdict::Failed)
    )
}

/// One line a comparison, with the point of the largest difference.
pub(super) fn csv(rows: &[Row]) -> String {
    let mut table = Table::new([
        "suite",
        "comparison",
        "source",
        "points",
        "at",
        "theirs",
        "ours",
        "explained",
        "unit",
        "measure",
        "difference",
        "unexplained_difference",
        "tolerance",
        "verdict",
        "note",
    ]);
    for row in rows {
        let worst = row.worst();
        table.row([
            row.suite.to_owned(),
            row.name.clone(),
            row.source.clone(),
            row.points.len().to_string(),
            exact(worst.map(|p| p.at)),
            exact(worst.map(|p| p.theirs)),
            exact(worst.map(|p| p.ours)),
            exact(worst.and_then(|p| p.explained)),
            row.unit.to_owned(),
            format!("{:?}", row.measure),
            exact(row.difference()),
            exact(row.unexplained()),
            exact(Some(row.tolerance)),
            row.verdict().word().to_owned(),
            row.note.clone(),
        ]);
    }
    table.csv()
}

fn dash() -> String {
    "-".to_owned()
}

/// The name of a source: what is before the details.
fn short(source: &str) -> &str {
    source.split([',', '(', ':']).next().unwrap_or(source).trim_end()
}

fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e5).contains(&size) {
        // Six significant digits.
        let digits = if value == 0.0 { 0 } else { (5 - size.log10().floor() as i32).max(0) as usize };
        format!("{value:.digits$}")
    } else {
        format!("{value:.5e}")
    }
}

fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() { number(value) } else { format!("{} {unit}", number(value)) }
}

/// A difference: in the unit of the row, or a pure number.
fn amount(value: f64, row: &Row) -> String {
    let text = if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") };
    if row.measure == Measure::Absolute && !row.unit.is_empty() {
        format!("{text} {}", row.unit)
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_verification::Point;

    #[test]
    fn the_table_shows_the_worst_point_and_numbers_the_notes_of_what_does_not_pass() {
        let row = |name: &str, points| {
            Row::new("suite", name, "Somebody (2011), table 1", "N", Measure::Relative, 0.01, points)
        };
        let rows = [
            row("same", vec![Point::new(0.0, 2.0, 2.0), Point::new(1.0, 1.0, 1.001)]),
            row("other law", vec![Point::explained(0.0, 1.0, 1.5, 1.5)]).with_note("Another law."),
            Row::not_comparable("suite", "walls", "Somebody", "There are none."),
        ];
        let text = text(&rows);
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[1].starts_with("suite: same") && lines[1].ends_with("passed"), "{text}");
        assert!(lines[1].contains("Somebody ") && !lines[1].contains("table 1"), "{text}");
        assert!(lines[1].contains("1.00100 N") && lines[1].contains("1.0e-3  "), "{text}");
        assert!(lines[2].ends_with("explained [1]") && lines[3].ends_with("not comparable [2]"), "{text}");
        assert_eq!(
            lines[4..],
            [
                "[1] Another law.",
                "[2] There are none.",
                "3 comparisons: 1 passed, 1 explained, 1 not comparable, 0 failed"
            ]
        );
        assert!(csv(&rows).lines().nth(2).unwrap().contains("explained,Another law."));
    }
}
