//! Values inferred from moduli and wave speeds, with those that were counted.

use crate::run::{Run, recommended};
use grainlab_core::results::InferredQuantity;
use grainlab_msgs::topics::PACKING_REPORT;
use grainlab_page::plot::{Bar, Bars};
use grainlab_page::{
    Cell, Html, csv, details, figure, fixed, grid, list, paragraph, plus_minus, signed, six_digits, table,
};
use grainlab_results::Inference;
use grainlab_results::brief::moduli;
use grainlab_results::read_back::InvertedPacking;

/// Most bars of a plot; its data have all.
const MOST_BARS: usize = 60;

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

fn plot(quantity: InferredQuantity, state: &InvertedPacking) -> Option<Html> {
    let counted = state.packing.report.counted(quantity)?;
    let digits = quantity.digits();
    let best = recommended(state);
    let others = state.results.iter().filter(|e| !best.is_some_and(|b| std::ptr::eq(b, *e)));
    let (mut rows, mut bars) = (Vec::new(), Vec::new());
    for e in best.into_iter().chain(others) {
        let Some(value) = e.values[quantity] else { continue };
        let by_sigma = || e.sigma[quantity].map(|s| [value - 1.96 * s, value + 1.96 * s]);
        let interval = e.interval.bounds[quantity].or_else(by_sigma);
        let [low, high] = interval.map_or([String::new(), String::new()], |i| i.map(six_digits));
        let [inferred, counted_digits] = [value, counted].map(six_digits);
        rows.push([name(e).replace(',', ""), e.status.to_string(), inferred, low, high, counted_digits]);
        let colour = usize::from(e.status != "ok");
        let text = format!("{} ({})", fixed(value, digits), signed(value - counted, digits));
        bars.push(Bar { name: name(e), colour, value, interval, text });
    }
    bars.truncate(MOST_BARS);
    let reference = Some((counted, format!("counted {counted:.digits$}")));
    let title = format!("{}: {}", quantity.symbol(), quantity.meaning());
    let id = format!("inferred-{}", quantity.text().replace('_', "-"));
    let data = csv(["model", "status", "inferred", "low", "high", "counted"], rows);
    (!bars.is_empty())
        .then(|| figure(&id, Bars { title, from_zero: false, bars, reference }.svg(), "", &data))
}

/// Cells of the inferred quantities and of their model; empty without an estimate.
fn of_best(best: Option<&Inference>, by: String) -> impl Iterator<Item = Cell> {
    let cells = InferredQuantity::countable().map(move |q| {
        let sigma = plus_minus(best.and_then(|b| b.sigma[q]), q.digits());
        Cell::number(fixed(best.and_then(|b| b.values[q]), q.digits()) + &sigma)
    });
    cells.chain([Cell::text(by)])
}

/// A model with its status.
fn model(e: &Inference) -> String {
    format!("{} ({})", e.model, e.status)
}

fn symbols() -> impl Iterator<Item = &'static str> + Clone {
    InferredQuantity::countable().map(InferredQuantity::symbol)
}

impl Run {
    /// Inferred against counted, of the last state, and all states as a table.
    pub(crate) fn inferred(&self) -> Html {
        let Some(state) = self.last() else { return paragraph("No packing was measured.") };
        let figures: Html = InferredQuantity::countable().filter_map(|q| plot(q, state)).collect();
        let level = state.results.iter().find_map(|e| e.interval.level).unwrap_or(0.95);
        let about = if figures.is_empty() {
            "Nothing was inferred.".to_owned()
        } else {
            format!(
                "Inferred from moduli, or from wave speeds if there are some, with the stress and the sizes and material of the grains; the contacts \
                 were not seen. Bars are intervals of {:.0} %, which assume the errors of the data that the inversion was given; the vertical line is the \
                 count. The model that is recommended comes first. Orange: its status is not ok; the notes have the reason.",
                100.0 * level
            )
        };
        let notes = state.results.iter().flat_map(|e| e.warnings.iter().map(move |w| (e, w)));
        let warnings = list(notes.map(|(e, w)| format!("{}: {w}", name(e))));
        paragraph(about) + grid(figures) + details("Notes of the models", warnings) + self.of_instruments()
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

    /// The measured states, one a row.
    pub(crate) fn states_table(&self) -> Html {
        let measured =
            ["phase", "p, kPa", "φ"].into_iter().chain(symbols()).chain(["G12, MPa", "G13, MPa", "Θ, MPa"]);
        let before = measured.clone().count();
        let inferred = symbols().map(|symbol| format!("inferred {symbol}"));
        let header = measured.map(str::to_owned).chain(inferred).chain(["by".to_owned()]);
        let row = |s: &InvertedPacking| {
            let r = &s.packing.report;
            let phase = s.packing.position.filter(|p| p.phase > 0).map_or_else(String::new, |p| {
                self.timeline.phase_name(p.phase as u32 - 1 + self.timeline.first_phase())
            });
            let best = recommended(s);
            let unknown = if s.results.is_empty() { "" } else { "unknown" };
            let which = best.and_then(|b| b.origin.measurement.as_ref()).map(|m| format!(", {}", m.label));
            let by = best.map_or_else(|| unknown.to_owned(), model) + &which.unwrap_or_default();
            [Cell::text(phase), Cell::fixed(r.pressure() / 1e3, 2), Cell::fixed(r.solid_fraction, 4)]
                .into_iter()
                .chain(InferredQuantity::countable().map(|q| Cell::fixed(r.counted(q), q.digits())))
                .chain(moduli(r).map(|m| Cell::fixed(m, 2)))
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
        let rows = self.states.iter().flat_map(|s| std::iter::once(row(s)).chain(further(s)));
        table(
            "Packings at the ends of phases: counted, measured, and inferred with standard deviations.",
            header,
            rows,
        )
    }
}
