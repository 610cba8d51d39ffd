//! The inversion: every model judged, and the rows of Table III.

use crate::Reproduction;
use crate::tables::{mean, places};
use grainlab_core::results::InferredQuantity;
use grainlab_emt::Calibration;
use grainlab_page::html::{Cell, code, escaped, table};
use grainlab_paper::inversion::{Errors, Judged, of_the_paper};
use grainlab_paper::{PAPER, PRESSURE, Quantity};

fn errors(found: Option<&Errors>, digits: usize) -> [Cell; 2] {
    let Some(e) = found else { return ["–", "–"].map(Cell::number) };
    [Cell::number(format!("{:.digits$}", e.magnitude)), Cell::number(format!("{:+.digits$}", e.bias))]
}

impl Reproduction {
    /// Mean error of each model with each γ/Δ, after that of the paper on its own packings.
    pub(crate) fn judged_table(&self) -> String {
        let [ratio, emt, eps] = of_the_paper();
        let mut rows = Vec::new();
        for (name, k, eps) in [
            ("ratio, the paper on its packings", &ratio, Some(&eps)),
            ("emt, the paper on its packings", &emt, None),
        ] {
            let row = [Cell::text(name), Cell::text("paper"), Cell::text("total")];
            let none = [Cell::number("–"), Cell::number("–"), Cell::number("0")];
            rows.push(row.into_iter().chain(errors(Some(k), 3)).chain(errors(eps, 4)).chain(none).collect());
        }
        for j in &self.judged {
            let gamma = j.way.gamma.map_or("–", |g| g.name());
            let row =
                [Cell::text(j.way.model.name()), Cell::text(j.way.calibration.name()), Cell::text(gamma)];
            let found = errors(j.k.as_ref(), 3)
                .into_iter()
                .chain(errors(j.eps.as_ref(), 4))
                .chain(errors(j.z.as_ref(), 3));
            rows.push(row.into_iter().chain(found).chain([Cell::number(j.unanswered.to_string())]).collect());
        }
        let command =
            format!("grainlab invert --table {}/states.csv --judge --gamma all", self.provenance.folder);
        let caption = format!(
            "{}. Also by {}",
            escaped("Errors of the models on these packings: mean magnitude, and mean with sign"),
            code(&command)
        );
        let header = [
            "model",
            "constants",
            "γ/Δ",
            "|error of k|",
            "bias of k",
            "|error of ε|",
            "bias of ε",
            "|error of z|",
            "bias of z",
            "unanswered",
        ];
        table(&caption, &header, &rows)
    }

    /// Each row of Table III: the paper's inversion on its packings, on ours, and ours.
    pub(crate) fn rows_table(&self) -> String {
        let way = |model: &str, gamma: Option<&str>, calibration: &str| {
            self.judged.iter().find(|j| {
                j.way.model.name() == model
                    && j.way.calibration.name() == calibration
                    && j.way.gamma.map(|g| g.name()) == gamma
            })
        };
        let (paper, ours) = (way("ratio", Some("total"), "paper"), way("relaxed", None, "grainlab"));
        let mut rows = Vec::new();
        for (sample, pressure) in places() {
            let state = &PAPER[sample].states[pressure];
            let inferred = |judged: Option<&Judged>, q: InferredQuantity, truth: Quantity, digits: usize| {
                let row =
                    judged.and_then(|j| j.rows.iter().find(|r| r.sample == sample && r.pressure == pressure));
                let found = row.and_then(|r| if q == InferredQuantity::K { r.k } else { r.eps });
                let truth = self.get(truth, sample, pressure).map(|c| c.ours.value);
                let error = found.zip(truth).map(|(f, t)| format!("{:+.digits$}", f.value - t));
                [
                    Cell::number(found.map_or_else(|| "–".to_owned(), |m| mean(&m, 1.0, digits))),
                    Cell::number(error.unwrap_or_else(|| "–".to_owned())),
                ]
            };
            let mut row = vec![
                Cell::text(PAPER[sample].name),
                Cell::number(format!("{}", PRESSURE[pressure] / 1e3)),
                Cell::paper(format!("{:+.2}", state.k_ratio - state.k_sim)),
            ];
            row.extend(inferred(paper, InferredQuantity::K, Quantity::K, 2));
            row.extend(inferred(ours, InferredQuantity::K, Quantity::K, 2));
            row.push(Cell::paper(format!("{:+.3}", state.eps_ratio - state.eps_sim)));
            row.extend(inferred(paper, InferredQuantity::Eps, Quantity::Eps, 3));
            row.extend(inferred(ours, InferredQuantity::Eps, Quantity::Eps, 3));
            rows.push(row);
        }
        let command = format!("grainlab invert --table {}/states.csv --gamma total", self.provenance.folder);
        let caption = format!(
            "{}. Each packing by {}",
            escaped(
                "Table III, inversion: errors of the paper on its packings, of its model ratio with γ/Δ of the total strain on \
                 ours, and of our model relaxed"
            ),
            code(&command)
        );
        let header = [
            "sample",
            "p/kPa",
            "paper, error of k",
            "ratio k",
            "error",
            "relaxed k",
            "error",
            "paper, error of ε",
            "ratio ε",
            "error",
            "relaxed ε",
            "error",
        ];
        table(&caption, &header, &rows)
    }

    /// Our isotropic calibration beside Eqs. 21 and 22.
    pub(crate) fn calibration_table(&self) -> String {
        let all = ["paper", "grainlab", "grainlab-z"].into_iter().filter_map(Calibration::builtin);
        let mut rows = Vec::new();
        for calibration in all {
            let isotropic = calibration.isotropic();
            let [alpha, beta, rho, zeta] = isotropic.constants();
            let [low, high] = isotropic.fitted;
            let fitted =
                if high.is_finite() { format!("{low:.2} to {high:.2}") } else { format!("above {low}") };
            let row = [Cell::text(calibration.name()), Cell::text(isotropic.coordination_kind.name())];
            let constants = [(alpha, 1), (beta, 2), (rho, 1), (zeta, 2)]
                .map(|(v, digits)| Cell::number(format!("{v:.digits$}")));
            let moduli = [5.0, 6.0].into_iter().flat_map(|k| {
                [isotropic.shear_modulus(k, 100e3), isotropic.bulk_modulus(k, 100e3)]
                    .map(|m| Cell::number(format!("{:.1}", m / 1e6)))
            });
            rows.push(row.into_iter().chain(constants).chain([Cell::text(fitted)]).chain(moduli).collect());
        }
        let caption = format!(
            "{} {}",
            escaped(
                "Isotropic packings: G = α(k̂ + β) p^⅓ and Θ = ρ(k̂ + ζ) p^⅓ in MPa (Eqs. 21 and 22), and both at 100 kPa. \
                 Ours are learned by"
            ),
            code("grainlab calibrate tests/golden/ensembles/isotropic.csv")
        );
        let header =
            ["constants", "k̂ is", "α", "β", "ρ", "ζ", "fitted for k̂", "G at 5", "Θ at 5", "G at 6", "Θ at 6"];
        table(&caption, &header, &rows)
    }
}
