//! The comparisons as a table.

use grainlab_console::{Table, count, exact};
use grainlab_verify::{Point, Row, Verdict};
use serde::Serialize;

/// A comparison with what follows from it.
#[derive(Serialize)]
pub(super) struct Judged<'a> {
    #[serde(flatten)]
    row: &'a Row,
    difference: Option<f64>,
    worst: Option<Worst>,
    unexplained_difference: Option<f64>,
    unreproduced_difference: Option<f64>,
    verdict: Verdict,
}

/// The point of the largest difference, and its residual.
#[derive(Serialize)]
struct Worst {
    #[serde(flatten)]
    point: Point,
    residual: f64,
}

impl<'a> Judged<'a> {
    pub(super) fn new(row: &'a Row) -> Self {
        let (difference, unexplained_difference) = (row.difference(), row.unexplained());
        let unreproduced_difference = row.unreproduced();
        let worst = row.worst().zip(row.worst_residual());
        let worst = worst.map(|(point, residual)| Worst { point: *point, residual });
        Self {
            row,
            difference,
            worst,
            unexplained_difference,
            unreproduced_difference,
            verdict: row.verdict(),
        }
    }
}

/// A table for each suite, with the notes of what does not pass, and a summary.
pub(super) fn text(rows: &[Row]) -> String {
    let mut text = String::new();
    for group in rows.chunk_by(|a, b| a.suite == b.suite) {
        let mut sources: Vec<&str> = group.iter().map(|r| short(&r.source)).collect();
        sources.sort_unstable();
        sources.dedup();
        text += &format!("{}: {}\n", group[0].suite, sources.join(", "));
        let mut notes = Vec::new();
        let mut table = Table::new(HEADINGS);
        for row in group {
            let mut verdict = row.verdict().word().to_owned();
            if row.verdict() != Verdict::Passed && !row.note.is_empty() {
                let known = notes.iter().position(|n| *n == &row.note);
                verdict += &format!(" [{}]", known.unwrap_or(notes.len()) + 1);
                notes.extend(known.is_none().then_some(&row.note));
            }
            let number_of = |of: fn(&Point) -> f64| row.worst().map_or_else(dash, |p| number(of(p)));
            table.row([
                row.name.clone(),
                number_of(|p| p.theirs),
                number_of(|p| p.ours),
                row.unit.to_owned(),
                row.worst_residual().map_or_else(dash, residual),
                row.difference().map_or_else(dash, |_| row.measure.word().to_owned()),
                row.difference().map_or_else(dash, amount),
                limit(row.tolerance),
                verdict,
            ]);
        }
        text += &table.text();
        notes.iter().zip(1..).for_each(|(note, n)| text += &format!("[{n}] {note}\n"));
        text.push('\n');
    }
    text + MEASURES + &summary(rows)
}

const HEADINGS: [&str; 9] =
    ["comparison", "theirs", "ours", "unit", "residual", "measure", "off by", "allowed", "verdict"];

/// Meaning of the columns of numbers.
const MEASURES: &str = "\
theirs, ours and residual are those of the worst point of a comparison, the residual over theirs there. The measure says what is
off by: relative, the largest residual; of largest, the largest difference over the largest of theirs, and so is the residual; of
sum, the sum of all differences over the sum of theirs; absolute, the largest difference, and so is the residual.

";

/// Number of comparisons of each verdict.
fn summary(rows: &[Row]) -> String {
    let of = |verdict| rows.iter().filter(|r| r.verdict() == verdict).count();
    let mut text = format!(
        "{}: {} passed, {} explained, {} differ from their source, {} not comparable, {} failed\n",
        count(rows.len(), "comparison"),
        of(Verdict::Passed),
        of(Verdict::Explained),
        of(Verdict::Differs),
        of(Verdict::NotComparable),
        of(Verdict::Failed)
    );
    for (verdict, words) in [
        (Verdict::Differs, "DIFFERS from its source for the reason in its note"),
        (Verdict::Failed, "FAILED"),
    ] {
        for row in rows.iter().filter(|r| r.verdict() == verdict) {
            text += &format!("  {words}: {}, {}\n", row.suite, row.name);
        }
    }
    text
}

/// A column: its name, and its value in a row.
type Column = (&'static str, fn(&Row) -> String);

/// Columns of CSV: of a curve the worst point.
const COLUMNS: [Column; 19] = [
    ("suite", |r| r.suite.to_owned()),
    ("comparison", |r| r.name.clone()),
    ("source", |r| r.source.clone()),
    ("points", |r| r.points.len().to_string()),
    ("at", |r| exact(r.worst().map(|p| p.at))),
    ("theirs", |r| exact(r.worst().map(|p| p.theirs))),
    ("ours", |r| exact(r.worst().map(|p| p.ours))),
    ("residual", |r| exact(r.worst_residual())),
    ("explained", |r| exact(r.worst().and_then(|p| p.explained))),
    ("unit", |r| r.unit.to_owned()),
    ("measure", |r| name(r.measure)),
    ("difference", |r| exact(r.difference())),
    ("unexplained_difference", |r| exact(r.unexplained())),
    ("reproduced", |r| exact(r.worst().and_then(|p| p.reproduced))),
    ("unreproduced_difference", |r| exact(r.unreproduced())),
    ("tolerance", |r| exact(Some(r.tolerance))),
    ("tolerance_from", |r| r.tolerance_from.to_owned()),
    ("verdict", |r| name(r.verdict())),
    ("note", |r| r.note.clone()),
];

/// One line a comparison, with the point of the largest difference.
pub(super) fn csv(rows: &[Row]) -> String {
    let mut table = Table::new(COLUMNS.map(|(name, _)| name));
    rows.iter().for_each(|row| table.row(COLUMNS.map(|(_, cell)| cell(row))));
    table.csv()
}

/// The name of a measure or a verdict, as in JSON.
fn name(word: impl Serialize) -> String {
    serde_json::json!(word).as_str().unwrap_or_default().to_owned()
}

fn dash() -> String {
    "-".to_owned()
}

/// The name of a source: what is before the details.
fn short(source: &str) -> &str {
    source.split([',', '(', ':']).next().unwrap_or(source).trim_end()
}

/// Five significant digits.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e5).contains(&size) {
        let digits = if value == 0.0 { 0 } else { (4 - size.log10().floor() as i32).max(0) as usize };
        format!("{value:.digits$}")
    } else {
        format!("{value:.4e}")
    }
}

/// A difference, in the unit of the row or a pure number.
fn amount(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") }
}

/// A difference with its sign.
fn residual(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:+.1e}") }
}

/// A tolerance, which has one digit or two.
fn limit(value: f64) -> String {
    amount(value).replace(".0e", "e")
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_verify::Measure;

    #[test]
    fn the_table_shows_the_worst_point_and_numbers_the_notes_of_what_does_not_pass() {
        let row = |name: &str, points| {
            Row::new("suite", name, "Somebody (2011), table 1", "N", Measure::Relative, 0.01, points)
        };
        let rows = [
            row("same", vec![Point::new(0.0, 2.0, 2.0), Point::new(1.0, 1.0, 1.001)]),
            row("other law", vec![Point::explained(0.0, 1.0, 1.5, 1.5, 1.0)]).with_note("Another law."),
            row("own law", vec![Point::by_own_law(0.0, 1.0, 1.5, 1.5)]).with_note("Another law."),
            Row::not_comparable("suite", "walls", "Somebody", "There are none."),
        ];
        let text = text(&rows);
        let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split_whitespace().collect()).collect();
        assert_eq!(lines[0], ["suite:", "Somebody"], "{text}");
        let same = ["same", "1.0000", "1.0010", "N", "+1.0e-3", "relative", "1.0e-3", "1e-2", "passed"];
        assert_eq!(lines[2], same, "{text}");
        assert!(lines[3].ends_with(&["explained", "[1]"]), "{text}");
        assert!(lines[4].ends_with(&["DIFFERS", "[1]"]), "{text}");
        assert!(lines[5].ends_with(&["not", "comparable", "[2]"]), "{text}");
        assert!(
            text.ends_with(
                "4 comparisons: 1 passed, 1 explained, 1 differ from their source, 1 not comparable, 0 failed\n  DIFFERS from its \
                 source for the reason in its note: suite, own law\n"
            ) && text.contains("[1] Another law.\n[2] There are none.\n\n"),
            "{text}"
        );
        let csv = csv(&rows);
        assert!(csv.lines().nth(2).unwrap().contains("explained,Another law."), "{csv}");
        assert!(
            csv.lines().nth(4).unwrap().contains(",relative,") && csv.contains(",not_comparable,"),
            "{csv}"
        );
    }

    /// The pair of the worst of two points is 5 % apart, and the sum over both points 2 %.
    #[test]
    fn a_sum_over_points_is_shown_as_one_beside_the_residual_of_its_worst_point() {
        let points = vec![Point::new(2.0, 800.0, 840.0), Point::new(3.0, 1200.0, 1200.0)];
        let row = Row::new("suite", "P", "Somebody", "m/s", Measure::OfSum, 0.03, points);
        let text = text(std::slice::from_ref(&row));
        let line: Vec<&str> = text.lines().nth(2).unwrap().split_whitespace().collect();
        let shown = ["P", "800.00", "840.00", "m/s", "+5.0e-2", "of", "sum", "2.0e-2", "3e-2", "passed"];
        assert_eq!(line, shown, "{text}");
        let json = serde_json::to_value(Judged::new(&row)).unwrap();
        assert_eq!((&json["measure"], &json["worst"]["at"]), (&"of_sum".into(), &2.0.into()));
        assert_eq!(json["worst"]["residual"], 0.05);
        assert!(csv(&[row]).lines().nth(1).unwrap().contains(",0.05,"));
    }
}
