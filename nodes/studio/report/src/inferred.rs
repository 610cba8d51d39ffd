//! Values inferred from moduli and wave speeds, with those that were counted.

use crate::run::Run;
use grainlab_core::notes::Status;
use grainlab_core::results::InferredQuantity;
use grainlab_msgs::topics::PACKING_REPORT;
use grainlab_page::plot::{Axis, Estimated, Figure, Intervals, Line, Marker, Point, Series};
use grainlab_page::{
    Cell, Html, csv, details, figure, fixed, grid, html, list, paragraph, plus_minus, six_digits, table,
};
use grainlab_results::Inference;
use grainlab_results::brief::moduli;
use grainlab_results::findings::{self, Judged, recommended};
use grainlab_results::read_back::InvertedPacking;

/// Most rows of a plot; its data have all.
const MOST_ROWS: usize = 60;

/// Name of a result: its model, and its data unless these are the report of the packing.
fn name(e: &Inference) -> String {
    let which = || e.origin.measurement.as_ref().map_or_else(String::new, |m| format!(" {}", m.label));
    let is_named = |s: &&str| *s != PACKING_REPORT.name || e.origin.measurement.is_some();
    let data =
        e.origin.source.as_deref().filter(is_named).map(|s| format!(", {}{}", s.replace('_', " "), which()));
    let by = e
        .origin
        .by
        .as_deref()
        .filter(|b| *b != "/emt_inversion" && *b != "emt_inversion")
        .map(|b| format!(", {b}"));
    format!("{}{}{}", e.model, data.unwrap_or_default(), by.unwrap_or_default())
}

/// Every result of a state, the recommended one first, with its values beside those that were counted.
fn judged(state: &InvertedPacking) -> Vec<(&Inference, Vec<Judged>)> {
    let best = recommended(state);
    let others = state.results.iter().filter(|e| !best.is_some_and(|b| std::ptr::eq(b, *e)));
    best.into_iter().chain(others).map(|e| (e, Judged::of(e, &state.packing.report))).collect()
}

/// A plot for each quantity with a row for each result; the first one is set apart.
fn plots(results: &[(&Inference, Vec<Judged>)], is_first_apart: bool) -> Html {
    let plot = |q: InferredQuantity| {
        let of = |judged: &[Judged]| judged.iter().find(|j| j.quantity == q).copied();
        let counted = results.iter().find_map(|(_, judged)| of(judged))?.counted;
        let rows = results.iter().take(MOST_ROWS).enumerate().map(|(n, (e, judged))| {
            let found = of(judged);
            Estimated {
                name: name(e),
                value: found.map(|j| j.inferred),
                interval: found.and_then(|j| j.interval),
                text: found.map_or_else(|| "not inferred".to_owned(), |j| j.value()),
                below: found.filter(|_| n == 0 && is_first_apart).map_or_else(String::new, |j| j.distance()),
                hollow: e.status != Status::Ok,
            }
        });
        let digits = q.digits();
        let reference = Some((counted, format!("counted {counted:.digits$}")));
        let (title, meaning) = (q.symbol().to_owned(), q.meaning().to_owned());
        Some(Intervals { title, meaning, rows: rows.collect(), reference }.svg())
    };
    let drawn: Html = InferredQuantity::countable().filter_map(plot).collect();
    if drawn.is_empty() { drawn } else { html!("<div class=\"panels\">{{ drawn }}</div>", drawn) }
}

fn data(results: &[(&Inference, Vec<Judged>)]) -> String {
    let row = |e: &Inference, j: &Judged| {
        let [low, high] = j.interval.map_or([String::new(), String::new()], |i| i.map(six_digits));
        let [inferred, counted] = [j.inferred, j.counted].map(six_digits);
        let quantity = j.quantity.name().to_owned();
        [quantity, name(e).replace(',', ""), e.status.to_string(), inferred, low, high, counted]
    };
    let rows = results.iter().flat_map(|(e, judged)| judged.iter().map(move |j| row(e, j)));
    csv(["quantity", "model", "status", "inferred", "low", "high", "counted"], rows)
}

/// Inferred over counted values of several states, by the recommended model of each.
fn over_counted(states: &[InvertedPacking]) -> Html {
    let all: Vec<Judged> = (states.iter())
        .filter_map(|s| Some(Judged::of(recommended(s)?, &s.packing.report)))
        .flatten()
        .collect();
    let plot = |q: InferredQuantity| {
        let of: Vec<&Judged> = all.iter().filter(|j| j.quantity == q).collect();
        let points = of.iter().map(|j| {
            let error = j.interval.map(|[low, high]| 0.5 * (high - low));
            Point { error, ..Point::at(j.counted, j.inferred) }
        });
        let ends = of
            .iter()
            .map(|j| j.counted)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
        let exact = Series {
            name: "equal".to_owned(),
            line: Some(Line::Straight),
            points: ends.map(|v| Point::at(v, v)).into(),
            ..Series::default()
        };
        let marker = Some(Marker::Circle);
        let found = Series { colour: Some(0), marker, points: points.collect(), ..Series::default() };
        let rows = of.iter().map(|j| {
            let [low, high] = j.interval.map_or([String::new(), String::new()], |i| i.map(six_digits));
            [six_digits(j.counted), six_digits(j.inferred), low, high]
        });
        let title = format!("{}: inferred against counted", q.symbol());
        let drawn =
            Figure { title, x: Axis::linear("counted"), series: vec![exact, found], ..Figure::default() };
        let id = format!("{}-over-counted", q.text().replace('_', "-"));
        (of.len() > 1)
            .then(|| figure(&id, drawn.element(), "", &csv(["counted", "inferred", "low", "high"], rows)))
    };
    let drawn: Html = InferredQuantity::countable().filter_map(plot).collect();
    if drawn.is_empty() { drawn } else { grid(drawn) }
}

/// Cells of the inferred quantities and of their model; empty without an estimate.
fn of_best(best: Option<&Inference>, by: String) -> impl Iterator<Item = Cell> {
    let cells = InferredQuantity::countable().map(move |q| {
        let sigma = plus_minus(best.and_then(|b| b.sigma(q)), q.digits());
        Cell::number(fixed(best.and_then(|b| b.values[q]), q.digits()) + &sigma)
    });
    cells.chain([Cell::text(by)])
}

fn model(e: &Inference) -> String {
    format!("{} ({})", e.model, e.status)
}

fn symbols() -> impl Iterator<Item = &'static str> + Clone {
    InferredQuantity::countable().map(InferredQuantity::symbol)
}

impl Run {
    pub(crate) fn inferred(&self) -> Html {
        let Some(state) = self.last() else { return paragraph("No packing was measured.") };
        let results = judged(state);
        let (best, all) = (plots(&results[..results.len().min(1)], true), plots(&results, false));
        if recommended(state).is_none() {
            let all = if all.is_empty() {
                all
            } else {
                figure("inferred-by-model", all, "No model is recommended.", &data(&results))
            };
            let others = details("Estimates of models that are not recommended", all);
            let with = self.states.iter().filter(|s| recommended(s).is_some()).count();
            let nothing = match with {
                0 => "Nothing was inferred.".to_owned(),
                _ => format!(
                    "Of the last of {} states nothing was inferred. {with} others have estimates.",
                    self.states.len()
                ),
            };
            return paragraph(nothing) + over_counted(&self.states) + others + self.of_instruments();
        }
        let level = state.results.iter().find_map(|e| e.interval.level).unwrap_or(0.95);
        let which = if self.states.len() > 1 { " Of the last state." } else { "" };
        let hollow = results[0].0.status != Status::Ok;
        let hollow = if hollow { " The point is hollow: the estimate has a warning." } else { "" };
        let caption = format!(
            "Points: inferred, ± one standard deviation, with intervals of {:.0} %, which assume the errors of the data that the inversion was given. Vertical \
             line: counted. Below the interval: inferred less counted, and that in standard deviations (σ).{hollow}{which}",
            100.0 * level
        );
        let others = match results.len() {
            0 | 1 => Html::default(),
            n => details(
                format!("All {n} estimates: the other models, for comparison"),
                figure("inferred-by-model", all, "The recommended model comes first.", &data(&results)),
            ),
        };
        let best = figure("inferred", best, caption, &data(&results[..1]));
        let about = format!(
            "The inversion was given {}. It was not given the contacts.",
            findings::data(results[0].0)
        );
        let notes = state.results.iter().flat_map(|e| e.notes.iter().map(move |w| (e, w)));
        let warnings = list(notes.map(|(e, w)| format!("{}: {w}", name(e))));
        let notes = details("Notes of the models", warnings);
        paragraph(about) + over_counted(&self.states) + best + others + notes + self.of_instruments()
    }

    /// Values inferred from data of no packing of the run, for example from an instrument; may be empty.
    fn of_instruments(&self) -> Html {
        let rows = self.of_instruments.iter().map(|e| {
            let cells = InferredQuantity::countable().map(|q| Cell::fixed(e.values[q], q.digits()));
            [Cell::text(e.origin.data().unwrap_or_default()), Cell::text(model(e))].into_iter().chain(cells)
        });
        let header = ["data", "model"].into_iter().chain(symbols());
        table("Inferred from data of no packing of the run", header, rows)
    }

    pub(crate) fn states_table(&self) -> Html {
        let measured =
            ["phase", "p, kPa", "φ"].into_iter().chain(symbols()).chain(["G12, MPa", "G13, MPa", "Θ, MPa"]);
        let before = measured.clone().count();
        let inferred = symbols().map(|symbol| format!("inferred {symbol}"));
        let header = measured.map(str::to_owned).chain(inferred).chain(["by".to_owned()]);
        let row = |s: &InvertedPacking| {
            let r = &s.packing.report;
            let phase = s.packing.position.as_ref().filter(|p| p.phase > 0).map_or_else(String::new, |p| {
                self.timeline.phase_name(p.phase as u32 - 1 + self.timeline.first_phase())
            });
            let best = recommended(s);
            let unknown = if s.results.is_empty() { "" } else { "unknown" };
            let which = best.and_then(|b| b.origin.measurement.as_ref()).map(|m| format!(", {}", m.label));
            let by = best.map_or_else(|| unknown.to_owned(), model) + &which.unwrap_or_default();
            [Cell::text(phase), Cell::three_digits(r.pressure() / 1e3, 2), Cell::fixed(r.solid_fraction, 4)]
                .into_iter()
                .chain(InferredQuantity::countable().map(|q| Cell::fixed(r.counted(q), q.digits())))
                .chain(moduli(r).map(|m| Cell::three_digits(m, 2)))
                .chain(of_best(best, by))
                .collect::<Vec<_>>()
        };
        // Each of several measurements of a packing has a row of its own.
        let further = |s: &InvertedPacking| -> Vec<Vec<Cell>> {
            let first = recommended(s).map(|best| &best.origin);
            let groups = grainlab_results::by_origin(&s.results);
            let others = groups.iter().filter(|(o, _)| o.measurement.is_some() && Some(o) != first);
            let row = |(origin, results): &(grainlab_results::Origin, Vec<&Inference>)| {
                let best = Inference::recommended(results);
                let empty = std::iter::repeat_n(Cell::text(""), before - 1);
                let by = best.map_or_else(|| "unknown".to_owned(), model);
                let data = Cell::text(origin.data().unwrap_or_default());
                std::iter::once(data).chain(empty).chain(of_best(best, by)).collect()
            };
            others.map(row).collect()
        };
        let rows: Vec<_> =
            self.states.iter().flat_map(|s| std::iter::once(row(s)).chain(further(s))).collect();
        // The values of a single state are beside those of its cards.
        if rows.len() < 2 {
            return Html::default();
        }
        table(
            "Packings at the ends of phases: counted, measured, and inferred with standard deviations.",
            header,
            rows,
        )
    }
}
