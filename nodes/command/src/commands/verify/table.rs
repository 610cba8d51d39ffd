//! The comparisons as a table.

use grainlab_console::{Table, count, exact};
use grainlab_verification::{Row, Verdict};
use serde::Serialize;

/// A comparison with what follows from it.
#[derive(Serialize)]
pub(super) struct Judged<'a> {
    #[serde(flatten)]
    row: &'a Row,
    difference: Option<f64>,
    unexplained_difference: Option<f64>,
    unreproduced_difference: Option<f64>,
    verdict: Verdict,
}

impl<'a> Judged<'a> {
    /// The judgement of a row.
    pub(super) fn new(row: &'a Row) -> Self {
        let (difference, unexplained_difference) = (row.difference(), row.unexplained());
        let unreproduced_difference = row.unreproduced();
        Self { row, difference, unexplained_difference, unreproduced_difference, verdict: row.verdict() }
    }
}

/// A block for each suite, and a summary: at most 100 columns.
pub(super) fn text(rows: &[Row]) -> String {
    let mut notes: Vec<&str> = Vec::new();
    let mut text =
        columns(["comparison", "theirs", "ours", "off by", "allowed", "verdict"].map(str::to_owned));
    for group in rows.chunk_by(|a, b| a.suite == b.suite) {
        let mut sources: Vec<&str> = group.iter().map(|r| short(&r.source)).collect();
        sources.sort_unstable();
        sources.dedup();
        text += "\n";
        text += &wrapped(&format!("{}: ", group[0].suite), "  ", &sources.join(", "), WIDTH);
        let new = notes.len();
        for row in group {
            text += &line(row, &mut notes);
        }
        for (n, note) in notes.iter().enumerate().skip(new) {
            text += &wrapped(&format!("  [{}] ", n + 1), "      ", note, WIDTH);
        }
    }
    text + "\n" + &summary(rows)
}

/// Columns of a terminal that the table needs.
const WIDTH: usize = 100;

/// Columns of the name of a comparison; longer ones take several lines.
const NAME: usize = 36;

/// One comparison. A note that is new is added to `notes`.
fn line<'a>(row: &'a Row, notes: &mut Vec<&'a str>) -> String {
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
    let Some(worst) = row.worst() else {
        return wrapped("  ", "    ", &format!("{}: {word}", row.name), WIDTH);
    };
    let unit = if row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
    let difference = row.difference().map_or_else(dash, amount);
    columns([
        row.name.clone(),
        number(worst.theirs),
        number(worst.ours) + &unit,
        difference,
        limit(row.tolerance),
        word,
    ])
}

/// A line of the table; of a name that is too long, the rest is below.
fn columns([name, theirs, ours, difference, tolerance, verdict]: [String; 6]) -> String {
    // The unit stands behind the aligned number.
    let (ours, unit) = ours.split_once(' ').unwrap_or((&ours, ""));
    let name = wrapped("  ", "    ", &name, NAME + 2);
    let (first, rest) = name.split_once('\n').unwrap_or((&name, ""));
    let first =
        format!("{first:<38} {theirs:>11} {ours:>11} {unit:<5} {difference:>7} {tolerance:>7}  {verdict}");
    format!("{}\n{rest}", first.trim_end())
}

/// Words in lines of at most `width` columns, the first after `begin`, the others after `next`.
fn wrapped(begin: &str, next: &str, words: &str, width: usize) -> String {
    let (mut text, mut line) = (String::new(), begin.to_owned());
    let mut empty = true;
    for word in words.split_whitespace() {
        if !empty && line.chars().count() + 1 + word.chars().count() > width {
            text += &format!("{line}\n");
            (line, empty) = (next.to_owned(), true);
        }
        line += &if empty { word.to_owned() } else { format!(" {word}") };
        empty = false;
    }
    text + line.trim_end() + "\n"
}

/// How many comparisons there are of each verdict.
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
        (Verdict::Differs, "DIFFERS from its source, ours being what our own law gives"),
        (Verdict::Failed, "FAILED"),
    ] {
        for row in rows.iter().filter(|r| r.verdict() == verdict) {
            text += &wrapped("  ", "    ", &format!("{words}: {}, {}", row.suite, row.name), WIDTH);
        }
    }
    text
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
        "reproduced",
        "unreproduced_difference",
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
            row.measure.name().to_owned(),
            exact(row.difference()),
            exact(row.unexplained()),
            exact(worst.and_then(|p| p.reproduced)),
            exact(row.unreproduced()),
            exact(Some(row.tolerance)),
            row.verdict().name().to_owned(),
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

/// A tolerance, which has one digit or two.
fn limit(value: f64) -> String {
    amount(value).replace(".0e", "e")
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_verification::{Measure, Point};

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
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[2], "suite: Somebody", "{text}");
        assert!(lines[3].starts_with("  same ") && lines[3].ends_with("passed"), "{text}");
        assert!(lines[3].contains("1.0010 N") && lines[3].contains(" 1.0e-3    1e-2 "), "{text}");
        assert!(lines[4].ends_with("explained [1]"), "{text}");
        assert!(lines[5].ends_with("DIFFERS [1]"), "{text}");
        assert_eq!(
            lines[6..],
            [
                "  walls: not comparable [2]",
                "  [1] Another law.",
                "  [2] There are none.",
                "",
                "4 comparisons: 1 passed, 1 explained, 1 differ from their source, 1 not comparable, 0 failed",
                "  DIFFERS from its source, ours being what our own law gives: suite, own law"
            ]
        );
        let csv = csv(&rows);
        assert!(csv.lines().nth(2).unwrap().contains("explained,Another law."), "{csv}");
        assert!(
            csv.lines().nth(4).unwrap().contains(",relative,") && csv.contains(",not_comparable,"),
            "{csv}"
        );
    }

    #[test]
    fn long_names_sources_and_notes_take_several_lines_of_at_most_100_columns() {
        let words = "a note of many words ".repeat(20);
        let points =
            vec![Point::explained(0.0, -1.234_567e-12, -1.234_567e12, -1.234_567e12, -1.234_567e-12)];
        let name = "500 smooth spheres, 36 moduli, with the term of the normal forces";
        let row = Row::new("a-suite", name, words.clone(), "rad/s", Measure::Relative, 1.9e-2, points);
        let text = text(&[row.with_note(words)]);
        assert!(text.lines().all(|l| l.chars().count() <= 100), "{text}");
        let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
        for part in [
            "500 smooth spheres, 36 moduli,",
            "the normal forces",
            "-1.2346e12 rad/s",
            "1.9e-2",
            "explained [1]",
        ] {
            assert!(flat.contains(part), "{part} is missing:\n{text}");
        }
    }
}
