//! The file of a record: lines of text, then lines of numbers.

use super::list::Row;
use grainlab_acoustics::record::Record;
use grainlab_console::{input, separated};
use std::ops::Range;

/// Deviation of a time from even spacing, in samples, that rounding of the file may cause.
const UNEVEN: f64 = 0.5;

/// Signal of the source over its largest, at which it starts.
const STARTS: f64 = 0.02;

pub(super) fn read(row: &Row) -> Result<Record, String> {
    let text = input::bytes(&row.path, input::TEXT).map_err(|e| e.to_string())?;
    parsed(&String::from_utf8_lossy(separated::utf8(&text)?), row)
}

fn parsed(text: &str, row: &Row) -> Result<Record, String> {
    let mut rows: Vec<[f64; 3]> = Vec::new();
    for (line, text) in text.lines().enumerate() {
        match numbers(text, &row.columns) {
            Some(found) => rows.push(found),
            None if rows.is_empty() || text.trim().is_empty() => {}
            None => return Err(format!("line {}: {text:?} is not a time with two samples", line + 1)),
        }
    }
    if rows.len() < 2 {
        let [time, source, receiver] = row.columns.map(|c| c + 1);
        return Err(format!("there are no lines of numbers in the columns {time}, {source} and {receiver}"));
    }
    let last = rows.len() - 1;
    let interval = (rows[last][0] - rows[0][0]) / last as f64;
    if interval.is_nan() || interval <= 0.0 {
        return Err("the times do not increase".to_owned());
    }
    let off = |(k, row): (usize, &[f64; 3])| ((row[0] - rows[0][0]) / interval - k as f64).abs();
    let worst = rows.iter().enumerate().map(off).fold(0.0, f64::max);
    if worst > UNEVEN {
        return Err(format!("the times are not evenly spaced: one is {worst:.1} samples from its place"));
    }
    let source: Vec<f64> = rows.iter().map(|r| r[1]).collect();
    let receiver: Vec<f64> = rows.iter().map(|r| r[2]).collect();
    Ok(Record {
        sample_rate: 1.0 / (interval * row.unit),
        quiet: quiet(&source, &receiver),
        source,
        receiver,
    })
}

/// The numbers of a line, which commas, semicolons, tabs or spaces separate; with semicolons or tabs, commas are decimal points.
fn numbers(line: &str, columns: &[usize; 3]) -> Option<[f64; 3]> {
    let cells = separated::cells(line, separated::separator(line));
    let cell = |c: usize| cells.get(c)?.trim_matches('"').parse::<f64>().ok().filter(|v| v.is_finite());
    Some([cell(columns[0])?, cell(columns[1])?, cell(columns[2])?])
}

/// The samples before the source starts, less one in eight for what precedes its threshold; if the record starts with the source, the
/// sixteenth of the record after the source in which the receiver is quietest.
fn quiet(source: &[f64], receiver: &[f64]) -> Range<usize> {
    let mut sorted = source.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rest = sorted[sorted.len() / 2];
    let largest = source.iter().fold(0.0, |most: f64, s| most.max((s - rest).abs()));
    let is_on = |s: &f64| (s - rest).abs() > STARTS * largest;
    let start = source.iter().position(is_on).unwrap_or(0);
    let part = source.len() / 16;
    if start > 8 || part < 8 {
        return 0..start - start / 8;
    }
    let end = source.iter().rposition(is_on).unwrap_or(0) + 1;
    let scatter = |from: &usize| {
        let samples = &receiver[*from..from + part];
        let mean = samples.iter().sum::<f64>() / part as f64;
        samples.iter().map(|s| (s - mean).powi(2)).sum::<f64>()
    };
    let places = (end..source.len().saturating_sub(part)).step_by(part);
    let quietest = places.min_by(|a, b| scatter(a).total_cmp(&scatter(b))).unwrap_or(0);
    quietest..quietest + part
}
