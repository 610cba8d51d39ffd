//! Rows as a text table and as CSV.

use super::report::Report;
use super::row::{Differences, Row};
use super::statistics::{Estimate, Observables};
use grainlab_console::{Table, exact, fixed};

/// Decimal places of k, eps, phi, g12, theta.
const DIGITS: [usize; 5] = [3, 4, 5, 4, 4];

/// Two tables, errors and changes, with their notes and the conclusions.
pub(crate) fn text(report: &Report) -> String {
    let r = &report.reference;
    let mut text = format!(
        "scene {}, {} seeds; converged run: {} grains, {} s, {} steps, I = {}\n",
        report.scene,
        report.seeds.len(),
        r.grains,
        fixed(r.seconds, 2),
        fixed(r.steps, 0),
        r.inertial_number.map_or("-".to_owned(), |i| format!("{i:.1e}")),
    );
    let (means, errors, scatter) = (r.mean.array(), r.standard_error.array(), r.scatter.array());
    for (q, name) in Observables::<f64>::NAMES.iter().enumerate() {
        let unit = if q < 3 { "" } else { " MPa" };
        let scale = if q < 3 { 1.0 } else { 1e-6 };
        let number = |v: Option<f64>| fixed(v.map(|v| v * scale), DIGITS[q].min(if q < 3 { 5 } else { 2 }));
        let percent =
            if q < 3 { fixed(Some(scatter[q]), DIGITS[q]) } else { format!("{:.1} %", 100.0 * scatter[q]) };
        text += &format!(
            "  {name:5} = {} ± {}{unit}, scatter of one default run {percent}\n",
            number(means[q]),
            number(errors[q])
        );
    }
    text += "\nError against the converged run (mean ± standard error; ~ not resolved)\n";
    text += &block(report, |row| row.errors).text();
    text += "\nChange from the default at the same seeds\n";
    text += &block(report, |row| row.changes).text();
    text += "\n* the default; g12 and theta relative to the converged run; combined: over the seed scatter, unresolved errors \
             with their bound\n\n";
    text += &format!("{}\n", super::plot::figure(report).text("only an upper bound"));
    for line in &report.verdict {
        text += &format!("{line}\n");
    }
    text
}

fn block(report: &Report, part: impl Fn(&Row) -> Differences) -> Table {
    let header = ["knob", "value", "grains", "I", "runs", "seconds"];
    let mut t = Table::new(header.into_iter().chain(Observables::<f64>::NAMES).chain(["combined", "front"]));
    for row in &report.rows {
        let mark = if row.default { " *" } else { "  " };
        let mut cells = vec![
            row.knob.name(),
            format!("{}{mark}", row.value),
            row.grains.to_string(),
            row.inertial_number.map_or("-".to_owned(), |i| format!("{i:.1e}")),
            row.runs.to_string(),
            fixed(row.seconds, 2),
        ];
        let part = part(row).map(|d| d.array());
        cells.extend(DIGITS.iter().enumerate().map(|(q, digits)| cell(part.map(|p| p[q]), *digits)));
        cells.push(fixed(row.combined, 2));
        cells.push(if row.on_front { "yes" } else { "" }.to_owned());
        t.row(cells);
    }
    t
}

/// A mean is shown only if it is resolved, and zero only if every difference is zero.
fn cell(estimate: Option<Estimate>, digits: usize) -> String {
    match estimate {
        None => "-".to_owned(),
        Some(e) if e.mean == 0.0 && e.standard_error == 0.0 => "exactly 0".to_owned(),
        Some(e) if e.resolved() => format!("{:+.digits$} ±{:.digits$}", e.mean, e.standard_error),
        Some(e) => format!("~ ±{:.digits$}", e.standard_error),
    }
}

/// All columns, one line per row.
pub(crate) fn csv(report: &Report) -> String {
    let names = Observables::<f64>::NAMES;
    let mut header: Vec<String> = [
        "knob",
        "value",
        "default",
        "on_front",
        "grains",
        "inertial_number",
        "runs",
        "seconds",
        "seconds_standard_error",
        "steps",
        "combined",
    ]
    .map(str::to_owned)
    .into();
    for kind in ["error", "standard_error", "change", "change_standard_error"] {
        header.extend(names.map(|n| format!("{kind}_{n}")));
    }
    let mut t = Table::new(header);
    for row in &report.rows {
        let mut cells = vec![
            row.knob.name(),
            row.value.to_string(),
            row.default.to_string(),
            row.on_front.to_string(),
            row.grains.to_string(),
            exact(row.inertial_number),
            row.runs.to_string(),
        ];
        cells.extend([row.seconds, row.seconds_standard_error, row.steps, row.combined].map(exact));
        for group in [row.error, row.standard_error, row.change, row.change_standard_error] {
            cells.extend(group.array().map(exact));
        }
        t.row(cells);
    }
    t.csv()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_resolved_is_never_printed_as_a_number_and_zero_only_where_it_is_exact() {
        let e = |mean, standard_error| Some(Estimate { mean, standard_error, samples: 100 });
        assert_eq!(cell(e(0.0123, 0.002), 3), "+0.012 ±0.002");
        assert_eq!(cell(e(0.003, 0.002), 3), "~ ±0.002");
        assert_eq!(cell(e(0.0, 0.0), 3), "exactly 0");
        assert_eq!(cell(None, 3), "-");
    }
}
