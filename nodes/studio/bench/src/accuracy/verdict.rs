//! The conclusions about the default, in words.

use super::row::Row;
use super::statistics::{Estimate, Observables};

/// Relative scatter of the CPU time of a run on a shared machine; smaller gains are ignored.
const TIME_NOISE: f64 = 0.05;

/// The cost of the default, faster alternatives, and one sentence for each setting with a resolved change or
/// a failure. A change that is not resolved is no reason for or against a setting: only more seeds resolve
/// it.
pub(crate) fn verdict(rows: &[Row]) -> Vec<String> {
    let Some(default) = rows.iter().find(|r| r.default) else { return Vec::new() };
    let (Some(seconds), Some(bound)) = (default.seconds, default.combined) else { return Vec::new() };
    let known = resolved(default.errors.as_ref());
    let known =
        if known.is_empty() { "none of the five errors is resolved".to_owned() } else { known.join(", ") };
    let mut lines =
        vec![format!("default: {seconds:.2} s; {known}; combined error at most {bound:.2} seed scatters")];
    let share = |r: &Row| r.seconds.map(|s| s / seconds);
    let candidate = |r: &&Row| {
        let faster = share(r).is_some_and(|s| s < 1.0 - TIME_NOISE);
        faster && r.runs == default.runs && resolved(r.changes.as_ref()).is_empty()
    };
    let faster: Vec<String> = rows
        .iter()
        .filter(candidate)
        .map(|r| {
            let same = r.change.array() == [Some(0.0); 5];
            let same = if same { ", exactly the same result" } else { "" };
            format!("{} ({:.0} % of the time{same})", name(r), 100.0 * share(r).unwrap_or(1.0))
        })
        .collect();
    lines.push(if faster.is_empty() {
        let noise = 100.0 * TIME_NOISE;
        format!("no setting tried is more than {noise:.0} % faster without a resolved change or a failure")
    } else {
        format!("faster, with no change from the default that is resolved: {}", faster.join("; "))
    });
    for row in rows.iter().filter(|r| !r.default) {
        let effects = resolved(row.changes.as_ref());
        if !effects.is_empty() {
            let time = share(row).map_or("no time".to_owned(), |s| format!("{:.0} % of the time", 100.0 * s));
            lines.push(format!("{} ({time}) differs from the default: {}", name(row), effects.join(", ")));
        }
        if row.runs < default.runs {
            let reason = row.warnings.first().map_or("", String::as_str);
            let failed = default.runs - row.runs;
            lines.push(format!("{} fails at {failed} of {} seeds: {reason}", name(row), default.runs));
        }
    }
    lines
}

/// The resolved differences that are not exactly zero.
fn resolved(differences: Option<&Observables<Estimate>>) -> Vec<String> {
    let Some(differences) = differences else { return Vec::new() };
    let text = |(name, d): (&str, &Estimate)| {
        let certain = d.resolved() && d.mean != 0.0;
        certain.then(|| format!("{name} {:+.2e} ± {:.0e}", d.mean, d.standard_error))
    };
    Observables::<f64>::NAMES.into_iter().zip(&differences.array()).filter_map(text).collect()
}

fn name(row: &Row) -> String {
    format!("{} = {}", row.knob.name(), row.value)
}
