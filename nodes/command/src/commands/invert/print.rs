//! Results as text: JSON, CSV, a table.

use super::answer::{Answer, More};
use super::case::Case;
use super::{evidence, explain, predictive};
use grainlab_console::{CsvText, Table};
use grainlab_core::notes::texts;
use grainlab_results::{Inference, inference_text};

pub(super) struct Printer<'a> {
    pub(super) cases: &'a [Case],
    /// True for every model in the text of one state, instead of the recommended one.
    pub(super) verbose: bool,
}

impl Printer<'_> {
    pub(super) fn csv_header() -> String {
        let name = |name: &str| name.to_owned();
        let columns = ["sample", "pressure_pa"].map(name).into_iter().chain(Inference::exact_columns());
        let mut text = CsvText::default();
        text.row(columns.chain(["gamma_over_delta", "gamma_over_delta_source", "line", "reason"].map(name)));
        text.finish()
    }

    /// One line per case.
    pub(super) fn csv(&self, answer: &Answer) -> String {
        let state = answer.state.as_ref().ok();
        let line = answer.line.map_or_else(String::new, |l| l.to_string());
        let mut text = CsvText::default();
        for (result, case) in answer.inferences(self.cases).iter().zip(self.cases) {
            text.cell(answer.sample().unwrap_or_default());
            text.number(state.map(|s| s.conditions.pressure.value));
            result.exact_cells(&mut text);
            text.number(result.gamma.map(|gamma| gamma.value));
            text.cell(state.map_or("", |s| s.gamma_source(case)));
            text.cell(&line);
            text.cell(&texts(&result.notes).join("; "));
            text.end();
        }
        text.finish()
    }

    pub(super) fn state(&self, answer: &Answer, more: &More) -> String {
        let all = answer.inferences(self.cases);
        let mut text =
            if self.verbose { inference_text::table(&all) } else { inference_text::recommended(&all) };
        text += &more.explained.as_deref().map_or_else(String::new, explain::people);
        text += &more.predictive.as_deref().map_or_else(String::new, predictive::people);
        text + &more.evidence.as_deref().map_or_else(String::new, evidence::people)
    }

    pub(super) fn people(&self, answers: &[Answer]) -> String {
        let mut t = Table::new(["sample", "p/kPa", "gamma/Delta"].into_iter().chain(Inference::columns()));
        let mut warnings = String::new();
        for answer in answers {
            let line = answer.line.map_or_else(String::new, |l| format!("line {l}"));
            let sample = answer.sample().map_or_else(|| line.clone(), str::to_owned);
            let pressure = answer.state.as_ref().ok().map(|s| kilopascals(s.conditions.pressure.value));
            let results = answer.inferences(self.cases);
            for (result, case) in results.iter().zip(self.cases) {
                let asked = case.gamma.map_or("-", grainlab_emt::StrainRatioSource::name).to_owned();
                let label = [sample.clone(), pressure.clone().unwrap_or_else(|| "-".to_owned()), asked];
                t.row(label.into_iter().chain(result.cells()));
            }
            let lines = inference_text::warning_lines(&results);
            if !lines.is_empty() {
                let at = pressure.map_or_else(String::new, |p| format!(" at {p} kPa"));
                warnings += &format!("{sample}{at}:\n{lines}");
            }
        }
        t.without_empty_columns().text() + &warnings
    }
}

/// A pressure, Pa, in kPa to six digits.
fn kilopascals(pressure: f64) -> String {
    let rounded = format!("{:.5e}", pressure / 1e3);
    rounded.parse::<f64>().map_or(rounded, |p| p.to_string())
}
