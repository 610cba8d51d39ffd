//! The page of many runs: one row per run, sortable, with outliers marked.

use crate::figure::number;
use crate::outliers::Outliers;
use crate::page::whole;
use crate::run::{Run, recommended};
use grainlab_console::{CsvText, count};
use grainlab_core::results::InferredQuantity;
use grainlab_page::html::{escaped, paragraph};
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
    let mut csv = CsvText::new();
    let header = ["run", "scene", "seed", "end"].into_iter().chain(columns.iter().map(|c| c.name.as_str()));
    csv.row(header.clone());
    let mut rows = String::new();
    for (run, link) in runs {
        let scene = run.scene_name();
        let end = match run.summary.exit {
            None => "not known".to_owned(),
            Some(0) if run.is_incomplete() => "damaged".to_owned(),
            Some(0) if run.summary.warnings.is_empty() => "complete".to_owned(),
            Some(0) => "complete, with warnings".to_owned(),
            Some(code) => format!("exit code {code}"),
        };
        let seed = run.seed().map(|s| s.to_string()).unwrap_or_default();
        let class = if run.summary.exit == Some(0) && !run.is_incomplete() { "" } else { " class=\"bad\"" };
        rows += &format!(
            "<tr><th scope=\"row\"><a href=\"{}\">{}</a></th><td>{}</td><td class=\"n\">{seed}</td><td{class}>{end}</td>",
            escaped(link),
            escaped(&run.name()),
            escaped(&scene)
        );
        let mut cells = vec![run.name(), scene.clone(), seed, end];
        for (n, column) in columns.iter().enumerate() {
            let value = (column.value)(run);
            let score = value.and_then(|v| {
                let o = distributions.get(scene.as_str())?[n]?;
                o.has(v).then(|| o.score(v))
            });
            let text = value.map_or_else(String::new, |v| match column.name.as_str() {
                "unbalanced" => format!("{v:.1e}"),
                _ => format!("{v:.*}", column.digits),
            });
            let sorted = value.map_or_else(String::new, |v| format!(" data-value=\"{v}\""));
            rows += &match score {
                None => format!("<td class=\"n\"{sorted}>{text}</td>"),
                Some(score) => {
                    marked += 1;
                    let said = if score.is_finite() {
                        format!("outlier: robust z-score {score:.1}")
                    } else {
                        "outlier: all others are alike".to_owned()
                    };
                    format!(
                        "<td class=\"n outlier\"{sorted} title=\"{said}\">{text}<span class=\"hidden\"> ({said})</span></td>"
                    )
                }
            };
            cells.push(value.map(number).unwrap_or_default());
        }
        rows += "</tr>\n";
        csv.row(cells);
    }
    let head: String = header
        .map(|h| format!("<th scope=\"col\"><button type=\"button\" data-sort>{}</button></th>", escaped(h)))
        .collect();
    let about = paragraph(&format!(
        "The last packing of each run; errors are inferred less counted. Marked: {}, more than 3.5 robust standard deviations from the \
         median of the runs of a scene, of which there must be five. Click a header to sort.",
        count(marked, "value")
    ));
    let table = format!(
        "<div class=\"drawing\" id=\"runs-table\"><div class=\"scroll\"><table class=\"runs\"><caption class=\"hidden\">Runs</caption>\n\
         <thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n\
         <p class=\"save\"><button type=\"button\" data-save=\"csv\">Save CSV</button></p>\
         <script type=\"text/csv\">{}</script></div>\n",
        grainlab_page::html::script_text(&csv.finish())
    );
    let title = format!("{} of {}", count(runs.len(), "run"), count(by_scene.len(), "scene"));
    let heading = format!("<p class=\"eyebrow\">grainlab</p>\n<h1>{title}</h1>\n");
    whole(&title, &heading, &[("runs", "Runs", about + &table)], &[])
}
