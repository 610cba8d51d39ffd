//! The page of many runs: one row per run, sortable, with outliers marked.

use crate::figure::number;
use crate::inferred::COUNTED;
use crate::outliers::Outliers;
use crate::page::whole;
use crate::run::{Run, recommended};
use grainlab_console::{CsvText, count};
use grainlab_page::html::{escaped, paragraph};
use grainlab_results::brief::moduli;
use std::collections::BTreeMap;

/// A column: header, decimal places, and its value for a run.
struct Column {
    name: &'static str,
    digits: usize,
    value: fn(&Run) -> Option<f64>,
}

/// A modulus of the last state, MPa.
fn modulus(run: &Run, n: usize) -> Option<f64> {
    run.last().and_then(|s| moduli(&s.packing.report)[n])
}

/// Error of a quantity inferred from the last state.
fn error(run: &Run, n: usize) -> Option<f64> {
    let state = run.last()?;
    Some((COUNTED[n].inferred)(recommended(state)?)? - (COUNTED[n].counted)(&state.packing.report)?)
}

/// Numbers that are compared between runs of one scene.
const COLUMNS: [Column; 16] = [
    Column { name: "p, kPa", digits: 2, value: |r| Some(r.last()?.packing.report.pressure() / 1e3) },
    Column { name: "φ", digits: 4, value: |r| Some(r.last()?.packing.report.solid_fraction) },
    Column { name: "k", digits: 3, value: |r| Some(r.last()?.packing.report.contacts.coordination) },
    Column {
        name: "z",
        digits: 3,
        value: |r| Some(r.last()?.packing.report.contacts.mechanical_coordination),
    },
    Column { name: "ε", digits: 4, value: |r| Some(r.last()?.packing.report.fabric.contact_anisotropy) },
    Column { name: "ε_k", digits: 4, value: |r| r.last()?.packing.report.stiffness_anisotropy() },
    Column { name: "G12, MPa", digits: 2, value: |r| modulus(r, 0) },
    Column { name: "G13, MPa", digits: 2, value: |r| modulus(r, 1) },
    Column { name: "Θ, MPa", digits: 2, value: |r| modulus(r, 2) },
    Column { name: "error of k", digits: 3, value: |r| error(r, 0) },
    Column { name: "of z", digits: 3, value: |r| error(r, 1) },
    Column { name: "of ε", digits: 4, value: |r| error(r, 2) },
    Column { name: "of ε_k", digits: 4, value: |r| error(r, 3) },
    Column { name: "unbalanced", digits: 9, value: |r| r.last()?.packing.report.unbalanced_force_ratio },
    Column { name: "wall, s", digits: 1, value: |r| r.summary.wall_seconds },
    Column {
        name: "lost",
        digits: 0,
        value: |r| (!r.summary.topics.is_empty()).then(|| r.summary.total(|t| t.lost) as f64),
    },
];

/// Column of times and counts of a computer: far values say nothing about a packing.
fn is_compared(column: &Column) -> bool {
    !matches!(column.name, "wall, s" | "lost" | "unbalanced")
}

/// The page of many runs, each with the link to its own report.
pub fn overview(runs: &[(Run, String)]) -> String {
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
            (scene.as_str(), COLUMNS.iter().map(of).collect())
        })
        .collect();
    let mut marked = 0;
    let mut csv = CsvText::new();
    let header = ["run", "scene", "seed", "end"].into_iter().chain(COLUMNS.iter().map(|c| c.name));
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
        for (n, column) in COLUMNS.iter().enumerate() {
            let value = (column.value)(run);
            let score = value.and_then(|v| {
                let o = distributions.get(scene.as_str())?[n]?;
                o.has(v).then(|| o.score(v))
            });
            let text = value.map_or_else(String::new, |v| match column.name {
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
