//! What the rows say about the default, in words.

use super::report::Row;
use super::statistics::{Estimate, Observables};

/// CPU times of one run scatter by this much on a shared machine; a smaller gain is none.
const TIME_NOISE: f64 = 0.05;

/// One sentence on the default's place, and one for each setting that does better or that costs something for sure.
pub(crate) fn verdict(rows: &[Row]) -> Vec<String> {
    let Some(default) = rows.iter().find(|r| r.default) else { return Vec::new() };
    let (Some(seconds), Some(error)) = (default.seconds, default.combined) else { return Vec::new() };
    let mut lines = Vec::new();
    let better = |r: &&Row| {
        let faster = r.seconds.is_some_and(|s| s < (1.0 - TIME_NOISE) * seconds);
        faster && r.combined.is_some_and(|e| e <= error)
    };
    let faster: Vec<String> = rows
        .iter()
        .filter(better)
        .map(|r| {
            format!("{} in {:.0} % of the time", name(r), 100.0 * r.seconds.unwrap_or(seconds) / seconds)
        })
        .collect();
    lines.push(if faster.is_empty() {
        format!(
            "default: {seconds:.2} s, combined error {error:.2}; no setting tried is more than {:.0} % faster and as accurate",
            100.0 * TIME_NOISE
        )
    } else {
        let list = faster.join("; ");
        format!("default: {seconds:.2} s, combined error {error:.2}; as accurate or better and faster: {list}")
    });
    for row in rows.iter().filter(|r| !r.default) {
        let time =
            row.seconds.map_or("no time".to_owned(), |s| format!("{:.0} % of the time", 100.0 * s / seconds));
        let effects = effects(row);
        if row.runs == 0 {
            lines.push(format!("{}: fails at every seed: {}", name(row), row.warnings.join("; ")));
        } else if !effects.is_empty() {
            lines.push(format!("{} ({time}) differs from the default: {}", name(row), effects.join(", ")));
        }
    }
    lines
}

/// The resolved changes from the default that are not exactly zero.
fn effects(row: &Row) -> Vec<String> {
    let Some(changes) = &row.changes else { return Vec::new() };
    let told = |(name, c): (&str, &Estimate)| {
        let certain = c.resolved() && c.mean != 0.0;
        certain.then(|| format!("{name} {:+.2e} ± {:.0e}", c.mean, c.standard_error))
    };
    Observables::<f64>::NAMES.into_iter().zip(&changes.array()).filter_map(told).collect()
}

fn name(row: &Row) -> String {
    format!("{} = {}", row.knob.name(), row.value)
}
