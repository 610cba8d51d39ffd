//! The page of many runs: one row per run, sortable, with outliers marked.

use crate::numbers::{Number, mark_outliers, numbers};
use crate::over_settings::{OverSettings, Quantities, strips};
use crate::page::STYLE;
use crate::run::{Run, pressure_range};
use crate::settings::{Setting, differing, keys};
use grainlab_console::{CsvText, and, count};
use grainlab_core::results::InferredQuantity::{Eps, Z};
use grainlab_page::{
    Cell, Html, Page, Section, data, finding, grid, heading, html, paragraph, six_digits, table,
};
use grainlab_results::brief::ended;
use grainlab_results::findings::Findings;
use grainlab_results::read_back::InvertedPacking;
use std::collections::{BTreeMap, BTreeSet};

/// Found instead of figures over settings.
const MANY_SETTINGS: &str = "They differ in more than two settings: for figures over settings, report those that differ in one or two.";

const ABOUT_TABLE: &str = "The last packing of each run; errors are inferred less counted. Marked: outliers among six or more runs with the same \
                           settings. Click a header to sort.";

/// The page of many runs, each with the link to its own report.
pub fn overview(runs: &[(Run, String)]) -> String {
    let (runs, links): (Vec<&Run>, Vec<&str>) = runs.iter().map(|(run, link)| (run, link.as_str())).unzip();
    let mut varied = differing(&runs);
    varied.retain(|setting| setting.name != "scene");
    let mut numbers: Vec<Vec<Number>> = runs.iter().map(|run| numbers(run)).collect();
    mark_outliers(&runs, &mut numbers);
    let quantities = numbers.iter().map(|numbers| {
        let compared = numbers.iter().filter(|number| number.is_compared());
        compared.map(|number| (number.name.clone(), number.value)).collect()
    });
    let compared: Vec<Quantities<'_>> = runs.iter().copied().zip(quantities).collect();
    let over = OverSettings::of(&compared);
    let figures = match (&over, runs.as_slice()) {
        (Some(over), _) => Section { id: "settings", title: "Over the settings", content: over.figures() },
        (None, [a, b]) => Section {
            id: "pair",
            title: "Side by side",
            content: side_by_side([a, b], [&numbers[0], &numbers[1]]),
        },
        _ => Section { id: "strips", title: "Every run", content: strips(&compared) },
    };
    let table = runs_table(&runs, &links, &varied, &numbers);
    let scenes = distinct(runs.iter().map(|run| run.scene_name()));
    let title = format!("{} of {}", count(runs.len(), "run"), and(&scenes));
    let states: Vec<&InvertedPacking> = runs.iter().filter_map(|run| run.last()).collect();
    let mut found = match &over {
        Some(over) => [Z, Eps].map(|q| over.sentences(q.symbol())).concat(),
        None if varied.len() > 2 => vec![MANY_SETTINGS.to_owned()],
        None => Vec::new(),
    };
    found.extend(Findings::inferred(&states));
    let done = done(&runs, &states, &scenes, &varied);
    let page = Page {
        heading: heading("grainlab", &title, "") + finding(&done, &found, &doubts(&runs, &states, &numbers)),
        title,
        sections: vec![figures, Section { id: "runs", title: "Runs", content: table }],
        styles: vec![STYLE],
        has_bar: true,
        ..Page::default()
    };
    page.text()
}

/// Returns the different values, sorted.
fn distinct<T: Ord>(values: impl Iterator<Item = T>) -> Vec<T> {
    values.collect::<BTreeSet<T>>().into_iter().collect()
}

fn done(runs: &[&Run], states: &[&InvertedPacking], scenes: &[String], varied: &[Setting]) -> String {
    let reports = || states.iter().map(|state| &state.packing.report);
    let complete = runs.iter().filter(|run| run.is_complete()).count();
    let mut done = format!("{complete} of {} complete", count(runs.len(), "run"));
    let grains = distinct(reports().map(|report| report.contacts.grains));
    if !grains.is_empty() {
        done += &format!(", of {} grains", and(&grains.iter().map(u32::to_string).collect::<Vec<_>>()));
    }
    let mut differ: Vec<&str> = varied.iter().map(|setting| setting.name.as_str()).collect();
    differ.extend((scenes.len() > 1).then_some("the scene"));
    differ.extend((distinct(runs.iter().map(|run| run.seed())).len() > 1).then_some("the seed"));
    match differ.as_slice() {
        [] => done += ". They do not differ.",
        differ => done += &format!(". They differ in {}.", and(differ)),
    }
    if runs.iter().any(|run| run.states.len() > 1) {
        let range = pressure_range(states.iter().copied(), 1);
        done += &format!(" Of each run the last state counts here, at {range} kPa; its own page has all.");
    }
    done
}

fn doubts(runs: &[&Run], states: &[&InvertedPacking], numbers: &[Vec<Number>]) -> Vec<String> {
    let incomplete = runs.iter().filter(|run| !run.is_complete()).count();
    let warned = runs.iter().filter(|run| !run.summary.warnings.is_empty()).count();
    let marked = numbers.iter().flatten().filter(|number| number.outlier.is_some()).count();
    let mut doubts = Findings::doubts(states, "run");
    for (number, noun, what) in [
        (incomplete, "run", "not complete: the table says why"),
        (warned, "run", "with warnings, which its page lists"),
        (marked, "value", "marked in the table: far from those of runs with the same settings"),
    ] {
        doubts.extend((number > 0).then(|| format!("{} {what}.", count(number, noun))));
    }
    doubts
}

fn end(run: &Run) -> String {
    let summary = &run.summary;
    match summary.exit {
        None => "not known".to_owned(),
        Some(0) if run.is_incomplete() => "damaged".to_owned(),
        Some(0) if summary.warnings.is_empty() => "complete".to_owned(),
        Some(0) => "complete, with warnings".to_owned(),
        Some(code) => {
            let reason = summary.warnings.first().map(String::as_str);
            let why = ended(code, reason, summary.saved_step);
            why.map_or(format!("exit code {code}"), |why| why.trim_start_matches("with ").to_owned())
        }
    }
}

fn runs_table(runs: &[&Run], links: &[&str], varied: &[Setting], numbers: &[Vec<Number>]) -> Html {
    let mut header = ["no", "run", "scene", "seed"].map(str::to_owned).to_vec();
    header.extend(varied.iter().map(Setting::header));
    header.push("end".to_owned());
    header.extend(numbers.iter().take(1).flatten().map(|number| number.name.clone()));
    let mut csv = CsvText::default();
    csv.row(&header);
    // Each entry of a row is the cell of the page, and the text of the CSV.
    let entries = |n: usize| {
        let (run, link) = (runs[n], links[n]);
        let number = |text: String| (Cell::number(&text), text);
        let (name, scene, end) = (run.name(), run.scene_name(), end(run));
        let linked = Cell::text(html!("<a href=\"{{ link }}\">{{ name }}</a>", link, name => &name));
        let mut row = vec![
            // A number stays with its row when a reader sorts the table.
            number((n + 1).to_string()),
            (linked, name),
            (Cell::text(&scene), scene),
            number(run.seed().map(|seed| seed.to_string()).unwrap_or_default()),
        ];
        row.extend(varied.iter().map(|setting| number(setting.values[n].clone())));
        row.push((Cell::classed(&end, if run.is_complete() { "" } else { "bad" }), end));
        row.extend(numbers[n].iter().map(|n| (n.cell(), n.value.map(six_digits).unwrap_or_default())));
        let (cells, texts): (Vec<Cell>, Vec<String>) = row.into_iter().unzip();
        csv.row(texts);
        cells
    };
    let rows: Vec<Vec<Cell>> = (0..runs.len()).map(entries).collect();
    html!(
        "{{ about }}<div class=\"drawing sortable\" id=\"runs-table\">{{ table }}\
         <p class=\"save\"><button type=\"button\" data-save=\"csv\">Save CSV</button></p>{{ data }}</div>\n",
        about => paragraph(ABOUT_TABLE),
        table => table("Runs", header, rows),
        data => data("text/csv", "runs-data", &csv.finish())
    )
}

fn side_by_side(runs: [&Run; 2], numbers: [&[Number]; 2]) -> Html {
    let scenes = runs.map(|run| keys(&run.scene_text));
    let settings = distinct(scenes.iter().flat_map(BTreeMap::keys)).into_iter().filter_map(|key| {
        let [x, y] = scenes.each_ref().map(|scene| scene.get(key).map_or("–", String::as_str));
        (x != y).then(|| [key.as_str(), x, y].map(Cell::text))
    });
    let rows = numbers[0].iter().zip(numbers[1]).map(|(x, y)| {
        let [first, second, difference] = x.compared_with(y);
        [Cell::text(&x.name), first, second, difference]
    });
    let [first, second] = runs.map(Run::name);
    let settings = table("Settings", ["setting", &first, &second], settings);
    grid(settings + table("Numbers", ["quantity", &first, &second, "difference"], rows))
}
