//! Several packings of a run, one line each, in at most 100 columns.

use super::shown::{eps, moduli};
use crate::inference::{Inference, by_origin};
use crate::read_back::InvertedPacking;
use grainlab_console::{Table, count, fixed};
use grainlab_msgs::topics;

/// Rows of the table; with more states, the last ones have rows.
const MOST_ROWS: usize = 10;

/// The mark after the model of an estimate outside its range, and the status that it means.
const OUTSIDE: (&str, &str) = ("*", "extrapolated");

/// The table, and below it what is left out of it.
pub(super) fn lines(states: &[InvertedPacking]) -> Vec<String> {
    let mut t = Table::new([
        "step", "p/kPa", "q/p", "phi", "k", "z", "eps", "G12", "Theta", "est. k", "z", "eps", "by",
    ]);
    let origins = states.iter().map(|s| by_origin(&s.results).len()).max().unwrap_or(0).max(1);
    let left_out = states.len().saturating_sub(MOST_ROWS / origins);
    let mut notes = Vec::new();
    let mut note = |line: String| {
        if !notes.contains(&line) {
            notes.push(line);
        }
    };
    for state in &states[left_out..] {
        let r = &state.packing.report;
        let [g12, _, theta] = moduli(r).map(|m| fixed(m, 1));
        if g12 != "-" {
            note("G12 and Theta in MPa; est.: estimated".to_owned());
        }
        let packing = [
            state.packing.step.to_string(),
            format!("{:.1}", r.pressure() / 1e3),
            r.stress_ratio().map_or_else(|| "-".to_owned(), |q| format!("{q:.0e}")),
            format!("{:.4}", r.solid_fraction),
            format!("{:.3}", r.contacts.coordination),
            format!("{:.3}", r.contacts.mechanical_coordination),
            fixed(eps(r), 4),
            g12,
            theta,
        ];
        let groups = by_origin(&state.results);
        let found: Vec<&Inference> =
            groups.iter().filter_map(|(_, results)| Inference::recommended(results)).collect();
        for best in &found {
            if best.status == OUTSIDE.1 {
                note(format!("{} {}", OUTSIDE.0, OUTSIDE.1));
            }
        }
        let first = found.first().copied();
        if let Some(other) =
            first.and_then(|b| b.source.as_deref()).filter(|from| *from != topics::MODULI.name)
        {
            note(format!("step {}: inferred from {other}", state.packing.step));
        }
        let unknown = if groups.is_empty() { "" } else { "unknown" };
        t.row(packing.into_iter().chain(estimated(first, unknown)));
        // The data of a further estimate stand in its first cell.
        for best in found.iter().skip(1) {
            let from = best.source.clone().unwrap_or_default();
            t.row(
                [from].into_iter().chain((1..9).map(|_| String::new())).chain(estimated(Some(best), unknown)),
            );
        }
    }
    if left_out > 0 {
        note(format!("and {} before these: summary.json has all", count(left_out, "packing")));
    }
    let table = t.without_empty_columns().text();
    table.lines().map(str::to_owned).chain(notes).collect()
}

/// The recommended estimate; without one, its cell has `unknown`.
fn estimated(best: Option<&Inference>, unknown: &str) -> [String; 4] {
    let Some(b) = best else { return ["", "", "", unknown].map(str::to_owned) };
    let by = match b.status {
        "ok" => b.model.clone(),
        status if status == OUTSIDE.1 => b.model.clone() + OUTSIDE.0,
        status => format!("{}, {status}", b.model),
    };
    [fixed(b.values.k, 3), fixed(b.values.z, 3), fixed(b.values.eps, 4), by]
}
