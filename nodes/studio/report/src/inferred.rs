//! What was inferred from moduli and wave speeds, beside what was counted.

use crate::figure::{PageFigure, number};
use crate::run::{Run, recommended};
use grainlab_console::fixed;
use grainlab_core::results::InferredQuantity;
use grainlab_msgs::topics::PACKING_REPORT;
use grainlab_page::html::{Cell, escaped, paragraph, table};
use grainlab_page::plot::{Bar, Bars};
use grainlab_results::Inference;
use grainlab_results::brief::moduli;
use grainlab_results::read_back::InvertedPacking;
use std::fmt::Write;

/// Most bars of a plot; its data have all.
const MOST_BARS: usize = 60;

/// Name of a result: its model, and its data unless these are the report of the packing.
fn name(e: &Inference) -> String {
    let which = || e.measurement.as_ref().map_or_else(String::new, |m| format!(" {}", m.label));
    let is_named = |s: &&str| *s != PACKING_REPORT.name || e.measurement.is_some();
    let data = e.source.as_deref().filter(is_named).map(|s| format!(", {}{}", s.replace('_', " "), which()));
    let by =
        e.by.as_deref().filter(|b| *b != "/emt_inversion" && *b != "emt_inversion").map(|b| format!(", {b}"));
    format!("{}{}{}", e.model, data.unwrap_or_default(), by.unwrap_or_default())
}

fn figure(quantity: InferredQuantity, state: &InvertedPacking) -> Option<String> {
    let counted = state.packing.report.counted(quantity)?;
    let digits = quantity.digits();
    let mut csv = String::from("model,status,inferred,low,high,counted\n");
    let mut bars = Vec::new();
    let best = recommended(state);
    let is_best = |e: &&Inference| best.is_some_and(|b| std::ptr::eq(b, *e));
    let others = state.results.iter().filter(|e| !is_best(e));
    for e in best.into_iter().chain(others) {
        let Some(value) = e.values[quantity] else { continue };
        let by_sigma = || e.sigma[quantity].map(|s| [value - 1.96 * s, value + 1.96 * s]);
        let interval = e.interval.bounds[quantity].or_else(by_sigma);
        let [low, high] = interval.map_or([String::new(), String::new()], |i| i.map(number));
        let _ = writeln!(
            csv,
            "{},{},{},{low},{high},{}",
            name(e).replace(',', ""),
            e.status,
            number(value),
            number(counted)
        );
        if bars.len() >= MOST_BARS {
            continue;
        }
        let colour = if e.status == "ok" { 0 } else { 1 };
        let error = format!("{value:.digits$} ({:+.digits$})", value - counted);
        bars.push(Bar { name: name(e), colour, value, interval, text: error });
    }
    let reference = Some((counted, format!("counted {counted:.digits$}")));
    let title = format!("{}: {}", quantity.symbol(), quantity.meaning());
    let id = format!("inferred-{}", quantity.text().replace('_', "-"));
    (!bars.is_empty()).then(|| {
        let svg = Bars { title, from_zero: false, bars, reference }.svg();
        PageFigure { id: &id, svg, caption: "", csv }.html()
    })
}

/// Cells of the inferred quantities; empty without an estimate.
fn of_best(best: Option<&Inference>) -> impl Iterator<Item = Cell> {
    InferredQuantity::countable().map(move |q| {
        let sigma = best.and_then(|b| b.sigma[q]).map(|s| format!(" ± {s:.*}", q.digits()));
        Cell::number(fixed(best.and_then(|b| b.values[q]), q.digits()) + &sigma.unwrap_or_default())
    })
}

impl Run {
    /// Inferred against counted, of the last state, and all states as a table.
    pub(crate) fn inferred(&self) -> String {
        let Some(state) = self.last() else { return paragraph("No packing was measured.") };
        let figures: String = InferredQuantity::countable().filter_map(|q| figure(q, state)).collect();
        let level = state.results.iter().find_map(|e| e.interval.level).unwrap_or(0.95);
        let about = if figures.is_empty() {
            paragraph("Nothing was inferred.")
        } else {
            paragraph(&format!(
                "Inferred from moduli, or from wave speeds if there are some, with the stress and the sizes and material of the grains; the contacts \
                 were not seen. Bars are intervals of {:.0} %, which assume the errors of the data that the inversion was given; the vertical line is the \
                 count. The model that is recommended comes first. Orange: its status is not ok; the notes have the reason.",
                100.0 * level
            ))
        };
        let warnings: String = state
            .results
            .iter()
            .flat_map(|e| {
                e.warnings.iter().map(move |w| format!("<li>{}: {}</li>", escaped(&name(e)), escaped(w)))
            })
            .collect();
        let warnings = if warnings.is_empty() {
            warnings
        } else {
            format!("<details><summary>Notes of the models</summary><ul>{warnings}</ul></details>\n")
        };
        format!("{about}<div class=\"grid\">\n{figures}</div>\n{warnings}{}", self.of_instruments())
    }

    /// What was inferred from data that are not about a packing of the run; empty if nothing was.
    fn of_instruments(&self) -> String {
        let row = |e: &Inference| {
            let mut cells = vec![
                Cell::text(e.origin().data().unwrap_or_default()),
                Cell::text(format!("{} ({})", e.model, e.status)),
            ];
            cells.extend(InferredQuantity::countable().map(|q| Cell::number(fixed(e.values[q], q.digits()))));
            cells
        };
        let rows: Vec<Vec<Cell>> = self.of_instruments.iter().map(row).collect();
        if rows.is_empty() {
            return String::new();
        }
        let symbols = InferredQuantity::countable().map(InferredQuantity::symbol);
        let header: Vec<&str> = ["data", "model"].into_iter().chain(symbols).collect();
        table("Inferred from data of no packing of the run", &header, &rows)
    }

    /// The measured states, one a row.
    pub(crate) fn states_table(&self) -> String {
        let symbols = || InferredQuantity::countable().map(InferredQuantity::symbol);
        let counted = ["phase", "p, kPa", "φ"].into_iter().chain(symbols());
        let measured = counted.chain(["G12, MPa", "G13, MPa", "Θ, MPa"]);
        let before = measured.clone().count();
        let inferred = symbols().map(|symbol| format!("inferred {symbol}"));
        let header: Vec<String> =
            measured.map(str::to_owned).chain(inferred).chain(["by".to_owned()]).collect();
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        let row = |s: &InvertedPacking| {
            let r = &s.packing.report;
            let phase = s.packing.position.filter(|p| p.phase > 0).map_or_else(String::new, |p| {
                self.timeline.phase_name(p.phase as u32 - 1 + self.timeline.first_phase())
            });
            let best = recommended(s);
            let mut cells = vec![
                Cell::text(phase),
                Cell::number(format!("{:.2}", r.pressure() / 1e3)),
                Cell::number(format!("{:.4}", r.solid_fraction)),
            ];
            cells
                .extend(InferredQuantity::countable().map(|q| Cell::number(fixed(r.counted(q), q.digits()))));
            cells.extend(moduli(r).map(|m| Cell::number(fixed(m, 2))));
            cells.extend(of_best(best));
            let unknown = if s.results.is_empty() { "" } else { "unknown" };
            let which = best
                .and_then(|b| b.measurement.as_ref())
                .map_or_else(String::new, |m| format!(", {}", m.label));
            cells.push(Cell::text(
                best.map_or_else(|| unknown.to_owned(), |b| format!("{} ({}){which}", b.model, b.status)),
            ));
            cells
        };
        // Each of several measurements of a packing has a row of its own.
        let further = |s: &InvertedPacking| -> Vec<Vec<Cell>> {
            let first = recommended(s).map(Inference::origin);
            let groups = grainlab_results::by_origin(&s.results);
            let others = groups.iter().filter(|(o, _)| o.measurement.is_some() && Some(o) != first.as_ref());
            let row = |(origin, results): &(grainlab_results::Origin, Vec<&Inference>)| {
                let best = Inference::recommended(results);
                let by = best.map_or_else(|| "unknown".to_owned(), |b| format!("{} ({})", b.model, b.status));
                let mut cells = vec![Cell::text(origin.data().unwrap_or_default())];
                cells.extend((1..before).map(|_| Cell::text("")));
                cells.extend(of_best(best));
                cells.push(Cell::text(by));
                cells
            };
            others.map(row).collect()
        };
        let rows: Vec<Vec<Cell>> =
            self.states.iter().flat_map(|s| std::iter::once(row(s)).chain(further(s))).collect();
        table(
            "Packings at the ends of phases: counted, measured, and inferred with standard deviations.",
            &header,
            &rows,
        )
    }
}
