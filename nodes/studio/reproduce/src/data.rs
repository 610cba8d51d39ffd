//! The data of the page as JSON and CSV.

use crate::Reproduction;
use crate::paper::inversion::Errors;
use crate::paper::{Comparison, PAPER, PRESSURE};
use grainlab_console::{Cell, Failure, json};
use grainlab_page::Dataset;
use serde_json::{Value, json as object};
use std::collections::BTreeMap;

type Column = (&'static str, fn(&Comparison) -> Cell);

const COLUMNS: [Column; 12] = [
    ("quantity", |c| Cell::Text(c.quantity.key().to_owned())),
    ("sample", |c| Cell::Text(PAPER[c.sample].name.to_owned())),
    ("pressure_pa", |c| Cell::Number(PRESSURE[c.pressure])),
    ("ours", |c| Cell::Number(c.ours.value)),
    ("standard_error", |c| number(c.ours.error)),
    ("expected_error", |c| number(c.expected)),
    ("seeds", |c| Cell::Count(c.ours.count as u64)),
    ("paper", |c| number(c.paper.map(|p| p.value))),
    ("paper_rounding", |c| number(c.paper.map(|p| p.rounding))),
    ("paper_is_printed", |c| c.paper.map_or(Cell::Unknown, |p| Cell::Flag(p.is_printed))),
    ("difference", |c| number(c.difference())),
    ("difference_in_errors", |c| number(c.in_errors())),
];

fn number(value: Option<f64>) -> Cell {
    value.map_or(Cell::Unknown, Cell::Number)
}

impl Reproduction {
    /// Every comparison as a row.
    pub fn csv(&self) -> String {
        let mut table = Dataset::new(COLUMNS.map(|(name, _)| name.to_owned()));
        self.compared.iter().for_each(|c| table.row(COLUMNS.map(|(_, cell)| cell(c))));
        table.csv()
    }

    /// Provenance, claims, comparisons and errors of the models.
    pub fn json(&self) -> Result<String, Failure> {
        let p = &self.provenance;
        let claims = self
            .claims
            .iter()
            .map(|c| object!({"claim": c.text, "verdict": c.verdict.words(), "found": c.found}));
        let compared =
            self.compared.iter().map(|c| BTreeMap::from(COLUMNS.map(|(name, cell)| (name, cell(c)))));
        let judged = self.judged.iter().map(|j| {
            object!({
                "model": j.case.model.name(),
                "calibration": j.case.calibration.name(),
                "gamma_over_delta": j.case.gamma.map(|g| g.name()),
                "k": errors(j.k.as_ref()),
                "z": errors(j.z.as_ref()),
                "eps": errors(j.eps.as_ref()),
                "unanswered": j.unanswered,
            })
        });
        json(&object!({
            "version": p.version,
            "command": p.command,
            "grains": p.grains,
            "seeds": p.seeds,
            "claims": claims.collect::<Vec<_>>(),
            "states": compared.collect::<Vec<_>>(),
            "models": judged.collect::<Vec<_>>(),
        }))
    }
}

fn errors(found: Option<&Errors>) -> Value {
    found.map_or(
        Value::Null,
        |e| object!({"mean_magnitude": e.magnitude, "bias": e.bias, "rms": e.rms, "states": e.count}),
    )
}
