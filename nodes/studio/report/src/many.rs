//! The page of many runs: one row per run, sortable, with outliers marked.

use crate::outliers::Outliers;
use crate::over_settings::{Quantities, figures};
use crate::page::STYLE;
use crate::run::{Run, recommended};
use crate::settings::keys;
use grainlab_console::{CsvText, count};
use grainlab_core::results::InferredQuantity;
use grainlab_page::{Cell, Page, Section, data, fixed, heading, html, paragraph, six_digits, table};
use grainlab_results::brief::moduli;
use std::collections::{BTreeMap, BTreeSet};

/// A number of a run: header, decimal places, and value.
type Number = (String, usize, Option<f64>);

/// Numbers of a run, of its last packing first.
fn numbers(run: &Run) -> Vec<Number> {
    let number = |name: &str, digits: usize, value: Option<f64>| (name.to_owned(), digits, value);
    let report = run.last().map(|state| &state.packing.report);
    let best = run.last().and_then(recommended);
    let counted = |q: InferredQuantity| report.and_then(|r| r.counted(q));
    let error = |q: InferredQuantity| Some(best?.values[q]? - counted(q)?);
    let moduli = ["G12, MPa", "G13, MPa", "Θ, MPa"].into_iter().zip(report.map_or([None; 3], moduli));
    let lost = (!run.summary.topics.is_empty()).then(|| run.summary.total(|t| t.lost) as f64);
    let mut all = vec![
        number("p, kPa", 2, report.map(|r| r.pressure() / 1e3)),
        number("φ", 4, report.map(|r| r.solid_fraction)),
    ];
    all.extend(InferredQuantity::countable().map(|q| number(q.symbol(), q.digits(), counted(q))));
    all.extend(moduli.map(|(name, value)| number(name, 2, value)));
    let errors = InferredQuantity::countable();
    all.extend(errors.map(|q| number(&format!("error of {}", q.symbol()), q.digits(), error(q))));
    all.extend([
        number("unbalanced", 9, report.and_then(|r| r.unbalanced_force_ratio)),
        number("wall, s", 1, run.summary.wall_seconds),
        number("lost", 0, lost),
    ]);
    all
}

/// Number of times and counts of a computer: far values say nothing about a packing.
fn is_compared(name: &str) -> bool {
    !matches!(name, "wall, s" | "lost" | "unbalanced")
}

/// The page of many runs, each with the link to its own report.
pub fn overview(runs: &[(Run, String)]) -> String {
    let columns = numbers(&Run::default());
    let settings = |run: &Run| (run.scene_name(), keys(&run.scene_text));
    let mut alike: BTreeMap<_, Vec<Vec<Number>>> = BTreeMap::new();
    for (run, _) in runs {
        alike.entry(settings(run)).or_default().push(numbers(run));
    }
    let distributions: BTreeMap<_, Vec<Option<Outliers>>> = alike
        .iter()
        .map(|(settings, runs)| {
            let of = |(n, (name, ..)): (usize, &Number)| {
                if is_compared(name) { Outliers::of(runs.iter().filter_map(|r| r[n].2)) } else { None }
            };
            (settings, columns.iter().enumerate().map(of).collect())
        })
        .collect();
    let mut marked = 0;
    let mut csv = CsvText::default();
    let names = columns.iter().map(|(name, ..)| name.as_str());
    let header: Vec<&str> = ["run", "scene", "seed", "end"].into_iter().chain(names).collect();
    csv.row(&header);
    let mut rows = Vec::new();
    for (run, link) in runs {
        let (name, scene) = (run.name(), run.scene_name());
        let end = match run.summary.exit {
            None => "not known".to_owned(),
            Some(0) if run.is_incomplete() => "damaged".to_owned(),
            Some(0) if run.summary.warnings.is_empty() => "complete".to_owned(),
            Some(0) => "complete, with warnings".to_owned(),
            Some(code) => format!("exit code {code}"),
        };
        let seed = run.seed().map(|s| s.to_string()).unwrap_or_default();
        let class = if run.summary.exit == Some(0) && !run.is_incomplete() { "" } else { "bad" };
        let linked = html!("<a href=\"{{ link }}\">{{ name }}</a>", link, name);
        let mut row =
            vec![Cell::text(linked), Cell::text(&scene), Cell::number(&seed), Cell::classed(&end, class)];
        let mut line = vec![name, scene.clone(), seed, end];
        for ((name, digits, value), outliers) in numbers(run).iter().zip(&distributions[&settings(run)]) {
            line.push(value.map(six_digits).unwrap_or_default());
            row.push(value.map_or_else(
                || Cell::number(""),
                |v| {
                    let cell = match name.as_str() {
                        "unbalanced" => Cell::number(format!("{v:.1e}")),
                        _ => Cell::fixed(v, *digits),
                    };
                    let cell = cell.sorted_by(v);
                    let Some(score) = outliers.filter(|o| o.has(v)).map(|o| o.score(v)) else { return cell };
                    marked += 1;
                    cell.noted(
                        "n outlier",
                        match score.is_finite() {
                            true => format!("outlier: robust z-score {}", fixed(score, 1)),
                            false => "outlier: all others are alike".to_owned(),
                        },
                    )
                },
            ));
        }
        rows.push(row);
        csv.row(line);
    }
    let about = format!(
        "The last packing of each run; errors are inferred less counted. Marked: {}, further from the \
         median of the runs of a scene with the same settings (six or more) than chance alone has it in one column of a hundred. Click a header to sort.",
        count(marked, "value")
    );
    let content = html!(
        "{{ about }}<div class=\"drawing sortable\" id=\"runs-table\">{{ table }}\
         <p class=\"save\"><button type=\"button\" data-save=\"csv\">Save CSV</button></p>{{ data }}</div>\n",
        about => paragraph(about),
        table => table("Runs", header, rows),
        data => data("text/csv", "runs-data", &csv.finish())
    );
    let scenes: BTreeSet<String> = runs.iter().map(|(run, _)| run.scene_name()).collect();
    let title = format!("{} of {}", count(runs.len(), "run"), count(scenes.len(), "scene"));
    let compared = |run| {
        let all = numbers(run).into_iter().filter(|(name, ..)| is_compared(name));
        (run, all.map(|(name, _, value)| (name, value)).collect())
    };
    let compared: Vec<Quantities<'_>> = runs.iter().map(|(run, _)| compared(run)).collect();
    let mut sections = vec![Section { id: "runs", title: "Runs", content }];
    sections.extend(figures(&compared).map(|content| Section { id: "settings", title: "Settings", content }));
    let page = Page {
        heading: heading("grainlab", &title, ""),
        title,
        sections,
        styles: vec![STYLE],
        has_bar: true,
        ..Page::default()
    };
    page.text()
}
