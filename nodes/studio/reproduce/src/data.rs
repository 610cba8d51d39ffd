//! The data of the page as JSON and CSV.

use crate::Reproduction;
use grainlab_console::{Cell, Failure, json};
use grainlab_page::Dataset;
use grainlab_paper::inversion::Errors;
use grainlab_paper::{PAPER, PRESSURE};
use serde_json::{Value, json as object};

impl Reproduction {
    /// Every comparison as a row.
    pub fn csv(&self) -> String {
        let names = [
            "quantity",
            "sample",
            "pressure_pa",
            "ours",
            "standard_error",
            "seeds",
            "paper",
            "paper_rounding",
            "paper_is_printed",
            "difference",
            "difference_in_errors",
        ];
        let mut table = Dataset::new(names.map(str::to_owned));
        let number = |v: Option<f64>| v.map_or(Cell::Unknown, Cell::Number);
        for c in &self.compared {
            table.row([
                Cell::Text(c.quantity.key().to_owned()),
                Cell::Text(PAPER[c.sample].name.to_owned()),
                Cell::Number(PRESSURE[c.pressure]),
                Cell::Number(c.ours.value),
                number(c.ours.error),
                Cell::Count(c.ours.count as u64),
                number(c.paper.map(|p| p.value)),
                number(c.paper.map(|p| p.rounding)),
                c.paper.map_or(Cell::Unknown, |p| Cell::Flag(p.is_printed)),
                number(c.difference()),
                number(c.in_errors()),
            ]);
        }
        table.csv()
    }

    /// Provenance, claims, comparisons and errors of the models.
    pub fn json(&self) -> Result<String, Failure> {
        let p = &self.provenance;
        let claims =
            self.claims.iter().map(|c| object!({"claim": c.text, "holds": c.holds, "found": c.found}));
        let compared = self.compared.iter().map(|c| {
            object!({
                "quantity": c.quantity.key(),
                "sample": PAPER[c.sample].name,
                "pressure_pa": PRESSURE[c.pressure],
                "ours": c.ours.value,
                "standard_error": c.ours.error,
                "seeds": c.ours.count,
                "paper": c.paper.map(|p| p.value),
                "paper_is_printed": c.paper.map(|p| p.is_printed),
                "difference_in_errors": c.in_errors(),
            })
        });
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
