//! Several packings of a run, one line each, in at most 100 columns.

use crate::findings::Findings;
use crate::inference::{Inference, Origin, by_origin};
use crate::packing_text::{eps, moduli, stress_ratio};
use crate::read_back::InvertedPacking;
use grainlab_console::{Table, count, fixed, three_digits};
use grainlab_core::notes::Status;
use grainlab_core::results::InferredQuantity;
use std::collections::BTreeSet;

/// Rows of the table; with more estimates, those of the last states have rows.
const MOST_ROWS: usize = 10;

/// The mark after the model of an estimate outside its range.
const OUTSIDE: &str = "*";

/// The table, and below it what is left out of it.
pub(super) fn lines(states: &[InvertedPacking]) -> Vec<String> {
    let mut t = Table::new([
        "step", "p/kPa", "q/p", "phi", "k", "z", "eps", "G12", "Theta", "est. k", "z", "eps", "by",
    ]);
    let mut rows = 0;
    let has_room = |state: &&InvertedPacking| {
        rows += by_origin(&state.results).len().clamp(1, MOST_ROWS);
        rows <= MOST_ROWS
    };
    let left_out = states.len() - states.iter().rev().take_while(has_room).count();
    let mut notes = Vec::new();
    let mut note = |line: String| {
        if !notes.contains(&line) {
            notes.push(line);
        }
    };
    for state in &states[left_out..] {
        let r = &state.packing.report;
        let [g12, _, theta] = moduli(r).map(|m| three_digits(m, 1));
        if g12 != "-" {
            note("G12 and Theta in MPa; est.: estimated".to_owned());
        } else {
            note("G12 and Theta -: no contacts that resist a strain; `analyze` has the reason".to_owned());
        }
        let packing = [
            state.packing.step.to_string(),
            three_digits(Some(r.pressure() / 1e3), 1),
            stress_ratio(r),
            format!("{:.4}", r.solid_fraction),
            format!("{:.3}", r.contacts.coordination),
            format!("{:.3}", r.contacts.mechanical_coordination),
            fixed(eps(r), 4),
            g12,
            theta,
        ];
        let groups = by_origin(&state.results);
        // A measurement without an estimate has a row, too, where there are several.
        let found: Vec<(&Origin, Option<&Inference>)> = groups
            .iter()
            .map(|(origin, results)| (origin, Inference::recommended(results)))
            .filter(|(origin, best)| best.is_some() || origin.measurement.is_some())
            .collect();
        let step = state.packing.step;
        // Each node is named where several infer.
        let nodes: BTreeSet<_> = groups.iter().map(|(origin, _)| &origin.by).collect();
        let named = |o: &Origin| if nodes.len() > 1 { o.data_and_node() } else { o.data() };
        let shown = &found[..found.len().min(MOST_ROWS)];
        for (_, best) in shown {
            if best.is_some_and(|b| b.status == Status::Extrapolated) {
                note(format!("{OUTSIDE} {}", Status::Extrapolated));
            }
        }
        let first = shown.first();
        if let Some(other) = first.and_then(|(o, _)| named(o)).filter(|from| from != "moduli") {
            note(format!("step {step}: inferred from {other}"));
        }
        let unknown = if groups.is_empty() { "" } else { "unknown" };
        t.row(packing.into_iter().chain(estimated(first.and_then(|(_, best)| *best), unknown)));
        // The data of a further estimate stand in its first cell.
        for (origin, best) in shown.iter().skip(1) {
            let from = named(origin).unwrap_or_default();
            t.row([from].into_iter().chain((1..9).map(|_| String::new())).chain(estimated(*best, unknown)));
        }
        if found.len() > shown.len() {
            let more = count(found.len() - shown.len(), "estimate");
            note(format!("step {step}: and {more} more: summary.json has all"));
        }
    }
    if left_out > 0 {
        note(format!("and {} before these: summary.json has all", count(left_out, "packing")));
    }
    let all: Vec<&InvertedPacking> = states.iter().collect();
    notes.extend(Findings::doubts(&all, "state"));
    let table = t.without_empty_columns().text();
    table.lines().map(str::to_owned).chain(notes).collect()
}

/// The recommended estimate; without one, its cell has `unknown`.
fn estimated(best: Option<&Inference>, unknown: &str) -> [String; 4] {
    let Some(b) = best else { return ["", "", "", unknown].map(str::to_owned) };
    let by = match b.status {
        Status::Ok => b.model.clone(),
        Status::Extrapolated => b.model.clone() + OUTSIDE,
        status => format!("{}, {status}", b.model),
    };
    let [k, z, eps] = [InferredQuantity::K, InferredQuantity::Z, InferredQuantity::Eps]
        .map(|q| fixed(b.values[q], q.digits()));
    [k, z, eps, by]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured_packing::tests::{lattice, measured};

    /// A lattice of grains with the modulus of a gel.
    #[test]
    fn moduli_and_pressure_of_soft_grains_keep_three_digits_in_the_line_of_a_state() {
        let mut soft = lattice(true);
        soft.material.shear_modulus = 1e4;
        soft.contacts.iter_mut().for_each(|c| c.normal_force *= 1e-4);
        let packing = measured(&soft);
        let [g12, _, theta] = moduli(&packing.report);
        let values = [g12, theta, Some(packing.report.pressure() / 1e3)];
        let state =
            InvertedPacking { packing, acoustic: None, further_acoustic: Vec::new(), results: Vec::new() };
        let text = lines(&[state]).join("\n");
        for value in values {
            assert!(value.unwrap() < 0.01 && text.contains(&three_digits(value, 1)), "{value:?}: {text}");
        }
    }
}
