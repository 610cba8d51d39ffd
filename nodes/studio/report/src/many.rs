//! The page of many runs: one row per run, sortable, with outliers marked.

use crate::outliers::Outliers;
use crate::page::STYLE;
use crate::run::{Run, recommended};
use grainlab_console::{CsvText, count};
use grainlab_core::results::InferredQuantity;
use grainlab_page::{Cell, Page, Section, data, fixed, heading, html, paragraph, six_digits, table};
use grainlab_results::brief::moduli;
use std::collections::BTreeMap;

/// A number of a run.
type ValueOfRun = Box<dyn Fn(&Run) -> Option<f64>>;

/// A column: header, decimal places, and its value for a run.
struct Column {
    name: String,
    digits: usize,
    value: ValueOfRun,
}

/// Numbers that are compared between runs of one scene.
fn columns() -> Vec<Column> {
    let column = |name: &str, digits, value: fn(&Run) -> Option<f64>| Column {
        name: name.to_owned(),
        digits,
        value: Box::new(value),
    };
    let counted = InferredQuantity::countable().map(|q| Column {
        name: q.symbol().to_owned(),
        digits: q.digits(),
        value: Box::new(move |r| r.last()?.packing.report.counted(q)),
    });
    let measured = ["G12, MPa", "G13, MPa", "Θ, MPa"].into_iter().enumerate().map(|(n, name)| Column {
        name: name.to_owned(),
        digits: 2,
        value: Box::new(move |r| moduli(&r.last()?.packing.report)[n]),
    });
    let errors = InferredQuantity::countable().map(|q| Column {
        name: format!("error of {}", q.symbol()),
        digits: q.digits(),
        value: Box::new(move |r| {
            let state = r.last()?;
            Some(recommended(state)?.values[q]? - state.packing.report.counted(q)?)
        }),
    });
    let mut columns = vec![
        column("p, kPa", 2, |r| Some(r.last()?.packing.report.pressure() / 1e3)),
        column("φ", 4, |r| Some(r.last()?.packing.report.solid_fraction)),
    ];
    columns.extend(counted.chain(measured).chain(errors));
    columns.extend([
        column("unbalanced", 9, |r| r.last()?.packing.report.unbalanced_force_ratio),
        column("wall, s", 1, |r| r.summary.wall_seconds),
        column("lost", 0, |r| (!r.summary.topics.is_empty()).then(|| r.summary.total(|t| t.lost) as f64)),
    ]);
    columns
}

/// Column of times and counts of a computer: far values say nothing about a packing.
fn is_compared(column: &Column) -> bool {
    !matches!(column.name.as_str(), "wall, s" | "lost" | "unbalanced")
}

/// The page of many runs, each with the link to its own report.
pub fn overview(runs: &[(Run, String)]) -> String {
    let columns = columns();
    let mut by_scene: BTreeMap<String, Vec<&Run>> = BTreeMap::new();
    for (run, _) in runs {
        by_scene.entry(run.scene_name()).or_default().push(run);
    }
    let distributions: BTreeMap<&str, Vec<Option<Outliers>>> = by_scene
        .iter()
        .map(|(scene, runs)| {
            let of = |c: &Column| {
                if is_compared(c) { Outliers::of(runs.iter().filter_map(|r| (c.value)(r))) } else { None }
            };
            (scene.as_str(), columns.iter().map(of).collect())
        })
        .collect();
    let mut marked = 0;
    let mut csv = CsvText::default();
    let names = columns.iter().map(|c| c.name.as_str());
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
        for (column, outliers) in columns.iter().zip(&distributions[scene.as_str()]) {
            let value = (column.value)(run);
            line.push(value.map(six_digits).unwrap_or_default());
            row.push(value.map_or_else(
                || Cell::number(""),
                |v| {
                    let cell = match column.name.as_str() {
                        "unbalanced" => Cell::number(format!("{v:.1e}")),
                        _ => Cell::fixed(v, column.digits),
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
        "The last packing of each run; errors are inferred less counted. Marked: {}, more than 3.5 robust standard deviations from the \
         median of the runs of a scene, of which there must be five. Click a header to sort.",
        count(marked, "value")
    );
    let content = html!(
        "{{ about }}<div class=\"drawing sortable\" id=\"runs-table\">{{ table }}\
         <p class=\"save\"><button type=\"button\" data-save=\"csv\">Save CSV</button></p>{{ data }}</div>\n",
        about => paragraph(about),
        table => table("Runs", header, rows),
        data => data("text/csv", "runs-data", &csv.finish())
    );
    let title = format!("{} of {}", count(runs.len(), "run"), count(by_scene.len(), "scene"));
    let page = Page {
        heading: heading("grainlab", &title, ""),
        title,
        sections: vec![Section { id: "runs", title: "Runs", content }],
        styles: vec![STYLE],
        has_bar: true,
        ..Page::default()
    };
    page.text()
}
