//! The page of many runs: one row per run, sortable, with outliers marked.

use crate::outliers::Outliers;
use crate::over_settings::{OverSettings, Quantities, strips};
use crate::page::STYLE;
use crate::run::Run;
use crate::settings::{Setting, differing, keys};
use grainlab_console::{CsvText, and, count, decimals_of};
use grainlab_core::results::InferredQuantity;
use grainlab_page::{
    Cell, Html, Page, Section, data, finding, fixed, grid, heading, html, paragraph, six_digits, table,
    three_digits,
};
use grainlab_results::brief::{ended, moduli};
use grainlab_results::findings::{Findings, recommended};
use grainlab_results::read_back::InvertedPacking;
use std::collections::{BTreeMap, BTreeSet};

/// A number of a run: header, form, and value.
type Number = (String, Form, Option<f64>);

/// How a number is written.
#[derive(Clone, Copy)]
enum Form {
    /// With this number of decimal places.
    Fixed(usize),
    /// With this number of decimal places, or three significant digits.
    Significant(usize),
    /// With two significant digits and a power of ten.
    Order,
}

impl Form {
    fn cell(self, value: f64) -> Cell {
        match self {
            Self::Fixed(digits) => Cell::fixed(value, digits),
            Self::Significant(digits) => Cell::three_digits(value, digits),
            Self::Order => Cell::number(format!("{value:.1e}")),
        }
    }

    /// The cell of `y` minus `x`, with the decimal places of these.
    fn difference(self, x: f64, y: f64) -> Cell {
        match self {
            Self::Fixed(digits) => Cell::signed(y - x, digits),
            Self::Significant(digits) => Cell::signed(y - x, decimals_of(x.abs().max(y.abs()), digits)),
            Self::Order => self.cell(y - x),
        }
    }
}

/// Numbers of a run, of its last packing first.
fn numbers(run: &Run) -> Vec<Number> {
    let number = |name: &str, form: Form, value: Option<f64>| (name.to_owned(), form, value);
    let (fixed, significant) = (Form::Fixed, Form::Significant);
    let report = run.last().map(|state| &state.packing.report);
    let best = run.last().and_then(recommended);
    let counted = |q: InferredQuantity| report.and_then(|r| r.counted(q));
    let error = |q: InferredQuantity| Some(best?.values[q]? - counted(q)?);
    let moduli = ["G12, MPa", "G13, MPa", "Θ, MPa"].into_iter().zip(report.map_or([None; 3], moduli));
    let lost = (!run.summary.topics.is_empty()).then(|| run.summary.total(|t| t.lost) as f64);
    let mut all = vec![
        number("p, kPa", significant(2), report.map(|r| r.pressure() / 1e3)),
        number("φ", fixed(4), report.map(|r| r.solid_fraction)),
    ];
    all.extend(InferredQuantity::countable().map(|q| number(q.symbol(), fixed(q.digits()), counted(q))));
    all.extend(moduli.map(|(name, value)| number(name, significant(2), value)));
    let errors = InferredQuantity::countable();
    all.extend(errors.map(|q| number(&format!("error of {}", q.symbol()), fixed(q.digits()), error(q))));
    all.extend([
        number("unbalanced", Form::Order, report.and_then(|r| r.unbalanced_force_ratio)),
        number("wall, s", fixed(1), run.summary.wall_seconds),
        number("lost", fixed(0), lost),
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
    let varied: Vec<Setting> = differing(&runs.iter().map(|(run, _)| run).collect::<Vec<_>>());
    let varied: Vec<Setting> = varied.into_iter().filter(|s| s.name != "scene").collect();
    let settings_names: Vec<String> = varied.iter().map(Setting::header).collect();
    let settings_names = settings_names.iter().map(String::as_str);
    let fixed_columns = ["no", "run", "scene", "seed"].into_iter();
    let header: Vec<&str> = fixed_columns.chain(settings_names).chain(["end"]).chain(names).collect();
    csv.row(&header);
    let mut rows = Vec::new();
    for (n, (run, link)) in runs.iter().enumerate() {
        let (name, scene) = (run.name(), run.scene_name());
        let end = match run.summary.exit {
            None => "not known".to_owned(),
            Some(0) if run.is_incomplete() => "damaged".to_owned(),
            Some(0) if run.summary.warnings.is_empty() => "complete".to_owned(),
            Some(0) => "complete, with warnings".to_owned(),
            Some(code) => {
                let reason = run.summary.warnings.first().map(String::as_str);
                ended(code, reason, run.summary.saved_step).map_or_else(
                    || format!("exit code {code}"),
                    |why| why.trim_start_matches("with ").to_owned(),
                )
            }
        };
        let seed = run.seed().map(|s| s.to_string()).unwrap_or_default();
        let class = if run.summary.exit == Some(0) && !run.is_incomplete() { "" } else { "bad" };
        let linked = html!("<a href=\"{{ link }}\">{{ name }}</a>", link, name);
        // A number stays with its row when a reader sorts the table.
        let no = n + 1;
        let mut row = vec![Cell::number(no), Cell::text(linked), Cell::text(&scene), Cell::number(&seed)];
        row.extend(varied.iter().map(|s| Cell::number(&s.values[n])));
        row.push(Cell::classed(&end, class));
        let mut line = vec![no.to_string(), name, scene.clone(), seed];
        line.extend(varied.iter().map(|s| s.values[n].clone()));
        line.push(end);
        for ((_, form, value), outliers) in numbers(run).iter().zip(&distributions[&settings(run)]) {
            line.push(value.map(six_digits).unwrap_or_default());
            row.push(value.map_or_else(
                || Cell::number(""),
                |v| {
                    let cell = form.cell(v).sorted_by(v);
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
    let about = "The last packing of each run; errors are inferred less counted. Marked: outliers among six or more runs with the same settings. \
                 Click a header to sort.";
    let content = html!(
        "{{ about }}<div class=\"drawing sortable\" id=\"runs-table\">{{ table }}\
         <p class=\"save\"><button type=\"button\" data-save=\"csv\">Save CSV</button></p>{{ data }}</div>\n",
        about => paragraph(about),
        table => table("Runs", header, rows),
        data => data("text/csv", "runs-data", &csv.finish())
    );
    let compared = |run| {
        let all = numbers(run).into_iter().filter(|(name, ..)| is_compared(name));
        (run, all.map(|(name, _, value)| (name, value)).collect())
    };
    let compared: Vec<Quantities<'_>> = runs.iter().map(|(run, _)| compared(run)).collect();
    let over = OverSettings::of(&compared);
    let figures = match (&over, runs) {
        (Some(over), _) => Section { id: "settings", title: "Over the settings", content: over.figures() },
        (None, [(a, _), (b, _)]) => {
            Section { id: "pair", title: "Side by side", content: side_by_side([a, b]) }
        }
        _ => Section { id: "strips", title: "Every run", content: strips(&compared) },
    };
    let scenes: BTreeSet<String> = runs.iter().map(|(run, _)| run.scene_name()).collect();
    let scenes: Vec<String> = scenes.into_iter().collect();
    let title = format!("{} of {}", count(runs.len(), "run"), and(&scenes));
    let complete = runs.iter().filter(|(run, _)| run.summary.exit == Some(0) && !run.is_incomplete()).count();
    let seeds: BTreeSet<Option<u64>> = runs.iter().map(|(run, _)| run.seed()).collect();
    let several = [("the scene", scenes.len() > 1), ("the seed", seeds.len() > 1)];
    let differ = varied.iter().map(|s| s.name.clone());
    let differ: Vec<String> =
        differ.chain(several.into_iter().filter(|s| s.1).map(|s| s.0.to_owned())).collect();
    let differ = if differ.is_empty() {
        " They do not differ.".to_owned()
    } else {
        format!(" They differ in {}.", and(&differ))
    };
    let grains: BTreeSet<u32> =
        runs.iter().filter_map(|(r, _)| Some(r.last()?.packing.report.contacts.grains)).collect();
    let grains: Vec<String> = grains.iter().map(u32::to_string).collect();
    let grains = if grains.is_empty() { String::new() } else { format!(", of {} grains", and(&grains)) };
    let lasts: Vec<&InvertedPacking> = runs.iter().filter_map(|(run, _)| run.last()).collect();
    let pressures = lasts.iter().map(|s| s.packing.report.pressure() / 1e3);
    let [low, high] = pressures.fold([f64::INFINITY, 0.0], |[l, h], p| [p.min(l), p.max(h)]);
    let [low, high] = [low, high].map(|p| three_digits(p, 1));
    let at = if low == high { low } else { format!("{low} to {high}") };
    let only_last = match runs.iter().any(|(run, _)| run.states.len() > 1) {
        true => format!(" Of each run the last state counts here, at {at} kPa; its own page has all."),
        false => String::new(),
    };
    let done = format!("{complete} of {} complete{grains}.{differ}{only_last}", count(runs.len(), "run"));
    let symbols = [InferredQuantity::Z, InferredQuantity::Eps].map(InferredQuantity::symbol);
    let mut found: Vec<String> =
        over.iter().flat_map(|o| symbols.iter().flat_map(|s| o.sentences(s))).collect();
    if over.is_none() && varied.len() > 2 {
        found.push("They differ in more than two settings: for figures over settings, report those that differ in one or two.".to_owned());
    }
    found.extend(Findings::inferred(&lasts));
    let warned = runs.iter().filter(|(run, _)| !run.summary.warnings.is_empty()).count();
    let doubts = [
        (runs.len() - complete, "run", "not complete: the table says why"),
        (warned, "run", "with warnings, which its page lists"),
        (marked, "value", "marked in the table: far from those of runs with the same settings"),
    ];
    let doubts = doubts.into_iter().filter(|(n, ..)| *n > 0);
    let of_states = Findings::doubts(&lasts, "run");
    let doubts = doubts.map(|(n, noun, what)| format!("{} {what}.", count(n, noun)));
    let doubts: Vec<String> = of_states.into_iter().chain(doubts).collect();
    let page = Page {
        heading: heading("grainlab", &title, "") + finding(&done, &found, &doubts),
        title,
        sections: vec![figures, Section { id: "runs", title: "Runs", content }],
        styles: vec![STYLE],
        has_bar: true,
        ..Page::default()
    };
    page.text()
}

/// The numbers of two runs beside each other.
fn side_by_side(pair: [&Run; 2]) -> Html {
    let [a, b] = pair.map(numbers);
    let rows = a.into_iter().zip(b).map(|((name, form, x), (_, _, y))| {
        let none = || Cell::number("–");
        let difference = x.zip(y).map(|(x, y)| form.difference(x, y));
        let cells = [x.map(|x| form.cell(x)), y.map(|y| form.cell(y)), difference];
        let cells = cells.map(|cell| cell.unwrap_or_else(none));
        std::iter::once(Cell::text(name)).chain(cells)
    });
    let [first, second] = pair.map(Run::name);
    let [x, y] = pair.map(|run| keys(&run.scene_text));
    let all: BTreeSet<&String> = x.keys().chain(y.keys()).collect();
    let of =
        |keys: &BTreeMap<String, String>, key: &String| keys.get(key).map_or("–", String::as_str).to_owned();
    let settings = all.into_iter().filter(|key| x.get(*key) != y.get(*key));
    let settings = settings.map(|key| [key.clone(), of(&x, key), of(&y, key)].map(Cell::text));
    let header = |what: &str| [what.to_owned(), first.clone(), second.clone()];
    let tables = table("Settings", header("setting"), settings)
        + table("Numbers", header("quantity").into_iter().chain(["difference".to_owned()]), rows);
    grid(tables)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_numbers_and_their_differences_keep_their_digits_side_by_side() {
        let form = Form::Significant(2);
        let cells = [form.cell(0.011_24), form.cell(0.012_36), form.difference(0.011_24, 0.012_36)];
        let text = table("", ["first", "second", "difference"], [cells]);
        for part in [">0.0112<", ">0.0124<", ">+0.0011<"] {
            assert!(text.contains(part), "{part}: {text:?}");
        }
    }
}
