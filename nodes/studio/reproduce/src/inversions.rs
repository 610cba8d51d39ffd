//! The inversion: every model judged, and the rows of Table III.

use crate::Reproduction;
use crate::paper::inversion::{ERROR, Errors, Judged, Row, of_the_paper};
use crate::paper::{Mean, PAPER, Quantity, States};
use crate::tables::{head, mean, of_paper};
use grainlab_page::{Cell, Html, code, html, signed, table};

fn errors(found: Option<&Errors>, digits: usize) -> [Cell; 2] {
    [Cell::fixed(found.map(|e| e.magnitude), digits), Cell::signed(found.map(|e| e.bias), digits)]
}

impl Reproduction {
    pub(crate) fn judge_command(&self) -> String {
        let folder = &self.provenance.folder;
        format!("grainlab invert --table {folder}/states.csv --judge --gamma all --error {ERROR}")
    }

    /// Mean error of each model with each γ/Δ, after that of the paper on its own packings.
    pub(crate) fn judged_table(&self) -> Html {
        let [ratio, emt, eps] = of_the_paper();
        let row = |names: [&str; 3], k, eps, z, unanswered: usize| {
            let found = [errors(k, 3), errors(eps, 4), errors(z, 3)].concat();
            let unanswered = [Cell::number(unanswered)];
            names.map(Cell::text).into_iter().chain(found).chain(unanswered).collect::<Vec<_>>()
        };
        let of_paper = |name, k, eps| row([name, "paper", "total"], Some(k), eps, None, 0);
        let theirs = [
            of_paper("ratio, the paper on its packings", &ratio, Some(&eps)),
            of_paper("emt, the paper on its packings, Δ since φ = 0.607", &emt, None),
        ];
        let ours = self.judged.iter().map(|j| {
            // The strain of the theory is another one in the paper than in the model of this name.
            let model =
                if j.case.model.name() == "emt" { "emt, Δ of the pressure" } else { j.case.model.name() };
            let names = [model, j.case.calibration.name(), j.case.gamma.map_or("–", |g| g.name())];
            row(names, j.k.as_ref(), j.eps.as_ref(), j.z.as_ref(), j.unanswered)
        });
        let rows = theirs.into_iter().chain(ours);
        let caption = html!(
            "Errors of the models on these packings: mean magnitude, and mean with sign. Also by {{ command }}, and for the \
             constants grainlab with {{ constants }}",
            command => code(&self.judge_command()),
            constants => code("--calibration grainlab")
        );
        let header = "model | constants | γ/Δ | |error of k| | bias of k | |error of ε| | bias of ε | |error of z| | \
                      bias of z | unanswered";
        table(caption, header.split(" | "), rows)
    }

    /// Each row of Table III: the paper's inversion on its packings, on ours, and ours.
    pub(crate) fn rows_table(&self) -> Html {
        let models = [self.judged("ratio", Some("total"), "paper"), self.judged("relaxed", None, "grainlab")];
        let rows = States::places().map(|(sample, pressure)| {
            let state = &PAPER[sample].states[pressure];
            let inferred = |value: fn(&Row) -> Option<Mean>, truth: Quantity, digits: usize| {
                let truth = self.get(truth, sample, pressure).map(|c| c.ours.value);
                models.into_iter().flat_map(move |judged: Option<&Judged>| {
                    let is_here = |r: &&Row| r.sample == sample && r.pressure == pressure;
                    let found = judged.and_then(|j| j.rows.iter().find(is_here)).and_then(value);
                    let error = found.zip(truth).map(|(f, t)| f.value - t);
                    [mean(found.as_ref(), 1.0, digits), Cell::signed(error, digits)]
                })
            };
            head(sample, pressure)
                .into_iter()
                .chain([of_paper(signed(state.k_ratio - state.k_sim, 2))])
                .chain(inferred(|r| r.k, Quantity::K, 2))
                .chain([of_paper(signed(state.eps_ratio - state.eps_sim, 3))])
                .chain(inferred(|r| r.eps, Quantity::Eps, 3))
                .collect::<Vec<_>>()
        });
        let command = format!(
            "grainlab invert --table {}/states.csv --gamma total --error {ERROR}",
            self.provenance.folder
        );
        let caption = html!(
            "Table III, inversion: errors of the paper on its packings, of its model ratio with γ/Δ of the total strain on \
             ours, and of our model relaxed. Each packing by {{ command }}",
            command => code(&command)
        );
        let header = "sample | p/kPa | paper, error of k | ratio k | error | relaxed k | error | paper, error of ε | \
                      ratio ε | error | relaxed ε | error";
        table(caption, header.split(" | "), rows)
    }
}
