//! Results of the models, as cells of a table or of CSV.

use crate::inference::Inference;
use grainlab_console::{CsvText, Table, fixed, wrapped};
use grainlab_core::notes::Note;
use grainlab_core::results::InferredQuantity;

impl Inference {
    /// Names of the cells of [`Inference::cells`].
    pub fn columns() -> impl Iterator<Item = &'static str> {
        let quantities = InferredQuantity::ALL.into_iter().flat_map(|q| [q.text(), "sigma"]);
        ["model", "calibration"].into_iter().chain(quantities).chain(["status"])
    }

    /// Cells of a text table; columns without values should be left out.
    pub fn cells(&self) -> Vec<String> {
        let mut cells = vec![self.model.clone(), self.calibration.clone()];
        cells.extend(
            InferredQuantity::ALL
                .into_iter()
                .flat_map(|q| [self.values[q], self.sigma(q)].map(|number| fixed(number, q.digits()))),
        );
        cells.push(self.status.to_string());
        cells
    }

    /// Names of the cells of [`Inference::exact_cells`].
    pub fn exact_columns() -> Vec<String> {
        let names = InferredQuantity::ALL.map(InferredQuantity::name);
        let with = |prefix: &'static str| names.into_iter().map(move |name| format!("{prefix}{name}"));
        let mut columns: Vec<String> = ["model", "calibration"].map(str::to_owned).into();
        columns.extend(["", "sigma_", "sigma_model_"].into_iter().flat_map(with));
        columns.extend(names.into_iter().flat_map(|name| [format!("{name}_low"), format!("{name}_high")]));
        columns.extend(["chi_square", "degrees_of_freedom", "condition_number", "status"].map(str::to_owned));
        columns
    }

    /// Adds the cells at full precision to a line of CSV.
    pub fn exact_cells(&self, line: &mut CsvText) {
        line.cell(&self.model);
        line.cell(&self.calibration);
        let sigma = InferredQuantity::ALL.map(|q| self.sigma(q));
        let sigma_model = InferredQuantity::ALL.map(|q| self.sigma_model(q));
        let bounds = self.interval.bounds.0.iter();
        [self.values.0, sigma, sigma_model]
            .into_iter()
            .flatten()
            .chain(bounds.flat_map(|bound| [bound.map(|b| b[0]), bound.map(|b| b[1])]))
            .chain([self.chi_square, self.degrees_of_freedom.map(|n| n as f64), self.condition_number])
            .for_each(|number| line.number(number));
        line.cell(self.status.name());
    }
}

/// The warnings of several results as lines, each with its models.
pub fn warning_lines<'a>(results: impl IntoIterator<Item = &'a Inference>) -> String {
    let mut seen: Vec<(&Note, Vec<&str>)> = Vec::new();
    for r in results {
        for note in &r.notes {
            match seen.iter_mut().find(|(known, _)| *known == note) {
                Some((_, models)) => models.push(&r.model),
                None => seen.push((note, vec![&r.model])),
            }
        }
    }
    let line = |(note, models): &(&Note, Vec<&str>)| wrapped("  ", &format!("{}: {note}", models.join(", ")));
    seen.iter().map(line).collect()
}

/// The recommended result with its intervals and notes, and the number of the others; without one, all of them with their reasons.
pub fn recommended(results: &[Inference]) -> String {
    let Some(best) = Inference::recommended(&results.iter().collect::<Vec<_>>()) else {
        return table(results);
    };
    let mut text = format!("model {}, status {}\n", best.model, best.status);
    let mut t = Table::new(["", "value", "sigma", "95 % interval", ""]);
    for q in InferredQuantity::ALL {
        let (Some(value), digits) = (best.values[q], q.digits()) else { continue };
        let interval = best.interval.bounds[q].map(|b| b.map(|end| format!("{end:.digits$}")).join(" to "));
        let sigma = fixed(best.sigma(q), digits);
        let cells = [format!("{value:.digits$}"), sigma, interval.unwrap_or_else(|| "-".to_owned())];
        t.row([q.text().to_owned()].into_iter().chain(cells).chain([format!("{:32}", q.meaning())]));
    }
    text += &t.text();
    best.notes.iter().for_each(|note| text += &wrapped("note: ", &note.to_string()));
    let others = results.len() - 1;
    if others > 0 {
        text += &format!("{others} other models: --verbose\n");
    }
    text
}

/// Results as a text table, warnings below.
pub fn table(results: &[Inference]) -> String {
    let mut t = Table::new(Inference::columns());
    results.iter().for_each(|r| t.row(r.cells()));
    let best = Inference::recommended(&results.iter().collect::<Vec<_>>());
    let best = best.filter(|_| results.len() > 1);
    let advice = best.map_or_else(String::new, |b| format!("  recommended: {}, {}\n", b.model, b.status));
    t.without_empty_columns().text() + &advice + &warning_lines(results)
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::results::{Estimate, Quantities};
    use grainlab_emt::{Calibration, Observation, StrainRatio};

    fn s1(modulus_error: f64) -> Inference {
        let observation =
            Observation::from_g12_g13_theta(121.71e6, 127.37e6, 144.38e6, 50e3, StrainRatio::given(-0.0623))
                .with_relative_error(modulus_error);
        Inference::new(
            "ratio",
            "paper",
            &grainlab_emt::model("ratio").unwrap().infer(&observation, &Calibration::PAPER),
        )
    }

    #[test]
    fn the_text_table_leaves_out_what_no_model_infers() {
        let failed = || Inference::from(Estimate::unknown("ours", "paper", vec![Note::no_answer("because")]));
        let text = table(&[s1(0.01), failed()]);
        let words: Vec<&str> = text.lines().next().unwrap().split_whitespace().collect();
        assert_eq!(words, ["model", "calibration", "k", "sigma", "k_hat", "sigma", "eps", "sigma", "status"]);
        assert!(text.contains("5.73") && text.ends_with("  ours: because\n"), "{text}");
        let mut with_z = s1(0.01);
        with_z.estimate.values = Quantities::from_fn(|q| (q == InferredQuantity::Z).then_some(5.9));
        assert!(table(&[with_z, failed()]).contains("  5.900"), "one model that knows z brings its column");
    }

    #[test]
    fn every_exact_cell_stands_under_its_name() {
        let mut r = s1(0.01);
        let [z, eps_stiffness] = [InferredQuantity::Z, InferredQuantity::EpsStiffness].map(|q| q as usize);
        let found = &mut r.estimate;
        (found.values.0[z], found.values.0[eps_stiffness]) = (Some(5.9), Some(0.02));
        found.covariance_model.as_mut().unwrap()[(z, z)] = 0.25;
        found.interval.bounds.0[eps_stiffness] = Some([-0.01, 0.05]);
        (found.chi_square, found.degrees_of_freedom) = (Some(1.5), Some(2));
        let mut line = CsvText::default();
        r.exact_cells(&mut line);
        line.end();
        let line = line.finish();
        let cells: Vec<&str> = line.trim_end().split(',').collect();
        let columns = Inference::exact_columns();
        assert_eq!(cells.len(), columns.len());
        let cell = |name| cells[columns.iter().position(|c| *c == name).unwrap()];
        assert_eq!((cell("model"), cell("status")), ("ratio", "ok"));
        assert_eq!((cell("z"), cell("sigma_z"), cell("eps_stiffness")), ("5.9", "0", "0.02"));
        assert_eq!((cell("sigma_model_z"), cell("sigma_model_eps_stiffness")), ("0.5", "0"));
        assert_eq!((cell("eps_stiffness_low"), cell("eps_stiffness_high")), ("-0.01", "0.05"));
        assert_eq!((cell("chi_square"), cell("degrees_of_freedom")), ("1.5", "2"));
        assert_eq!(cell("k_low").parse::<f64>().ok(), r.interval.bounds[InferredQuantity::K].map(|b| b[0]));
        assert_eq!(
            cell("eps_high").parse::<f64>().ok(),
            r.interval.bounds[InferredQuantity::Eps].map(|b| b[1])
        );
        assert_eq!(cell("sigma_eps").parse::<f64>().ok(), r.sigma(InferredQuantity::Eps));
        assert!(cell("condition_number").parse::<f64>().unwrap() >= 1.0);
    }
}
