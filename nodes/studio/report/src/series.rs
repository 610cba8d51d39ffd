//! The page of a series: speeds and z over pressure, the contact, and what is not determined.

use crate::page::STYLE;
use grainlab_emt::{Interval, PressureEstimate, SeriesEstimate, SpeedMode, SpeedSeries};
use grainlab_page::plot::{Axis, Entry, Figure, Line, Marker, Point, Series};
use grainlab_page::{
    Cell, Html, Page, Section, csv, details, figure, finding, grid, heading, html, list, paragraph, slug,
    table,
};
use std::f64::consts::PI;

/// Share of the posterior beyond the simulated packings from which z has only a lower end.
const OPEN: f64 = 0.1;

/// Pressures closer than this relative difference are one.
const SAME_PRESSURE: f64 = 1e-3;

/// A sample on the page.
pub struct InferredSample<'a> {
    /// Name of the sample; may be empty.
    pub name: &'a str,
    /// Speeds of the sample.
    pub series: &'a SpeedSeries,
    /// Result of the inversion.
    pub estimate: &'a SeriesEstimate,
    /// True if the speeds contradict each other or the model.
    pub is_contradictory: bool,
    /// Reasons to doubt the result.
    pub doubts: &'a [String],
    /// Further sentences on it.
    pub notes: &'a [String],
}

impl InferredSample<'_> {
    fn is_measured(&self, pressure: f64) -> bool {
        let is_here = |p: f64| (p - pressure).abs() <= SAME_PRESSURE * pressure;
        self.series.rows.iter().any(|row| row.speed.is_some() && is_here(row.pressure))
    }
}

/// The page of samples.
pub fn series_page(samples: &[InferredSample<'_>]) -> String {
    let content = |of: fn(usize, &InferredSample<'_>) -> Html| -> Html {
        samples.iter().enumerate().map(|(n, sample)| of(n, sample)).collect()
    };
    let title = format!("Wave speeds of {}", grainlab_console::count(samples.len(), "sample"));
    let page = Page {
        heading: heading("grainlab", &title, "") + samples.iter().map(found).collect::<Html>(),
        title,
        sections: vec![
            Section { id: "structure", title: "Structure", content: content(structure) },
            Section { id: "speeds", title: "Speeds", content: content(speeds) },
            Section { id: "contact", title: "Contact", content: content(contact) },
        ],
        styles: vec![STYLE],
        has_bar: true,
        ..Page::default()
    };
    page.text()
}

/// A pressure in kPa, to four digits.
fn kilopascals(pressure: f64) -> f64 {
    format!("{:.3e}", pressure / 1e3).parse().unwrap_or(f64::NAN)
}

fn found(sample: &InferredSample<'_>) -> Html {
    let InferredSample { series, estimate: e, doubts, .. } = sample;
    let kpa = |p: f64| format!("{} kPa", kilopascals(p));
    let at = |p: &PressureEstimate| {
        let z = lower_end(p).unwrap_or_else(|| format!("{:.2} ± {:.2}", p.z.mean, p.z.stddev));
        format!("{z} at {}", kpa(p.pressure))
    };
    let measured: Vec<&PressureEstimate> =
        e.pressures.iter().filter(|p| sample.is_measured(p.pressure)).collect();
    let (z, over) = match measured.as_slice() {
        [] => return Html::default(),
        [one] => (at(one), format!("at {}", kpa(one.pressure))),
        [first, .., last] => (
            format!("{} and {}", at(first), at(last)),
            format!(
                "at {} pressures, {} to {}",
                measured.len(),
                kilopascals(first.pressure),
                kpa(last.pressure)
            ),
        ),
    };
    let speeds = grainlab_console::count(series.rows.iter().filter(|r| r.speed.is_some()).count(), "speed");
    let done = format!(
        "{} {over}. z is the number of contacts per grain without rattlers, and was not counted.",
        named(sample, &speeds)
    );
    let law = e.laws.iter().max_by(|a, b| a.probability.total_cmp(&b.probability));
    let law =
        law.map(|l| format!("The most probable contact law is {} ({:.2}).", l.law.name(), l.probability));
    let of_eps = |p: &PressureEstimate| {
        let eps = p.eps?;
        let open = if eps.is_undetermined() { ", which is the prior's" } else { "" };
        Some(format!("{:.3} ± {:.3}{open} at {}", eps.mean, eps.stddev, kpa(p.pressure)))
    };
    let ends = [measured.first(), measured.last().filter(|_| measured.len() > 1)];
    let eps: Vec<String> = ends.into_iter().flatten().filter_map(|p| of_eps(p)).collect();
    let eps = match eps.is_empty() {
        true => "The anisotropy of the contacts, eps, is not determined by them.".to_owned(),
        false => format!("The anisotropy of the contacts, eps, is {}.", eps.join(" and ")),
    };
    let found: Vec<String> = [format!("The speeds give z {z}."), eps].into_iter().chain(law).collect();
    finding(&done, &found, doubts)
}

/// All that is known of z where the posterior reaches beyond the packings that were simulated; `None` elsewhere.
fn lower_end(p: &PressureEstimate) -> Option<String> {
    (p.z_beyond > OPEN).then(|| format!("{:.2} or more", p.z.low))
}

fn file(n: usize, sample: &InferredSample<'_>, figure: &str) -> String {
    let name = slug(sample.name);
    match (name.is_empty(), n) {
        (false, _) => format!("{figure}-{name}"),
        (true, 0) => figure.to_owned(),
        (true, n) => format!("{figure}-{}", n + 1),
    }
}

fn named(sample: &InferredSample<'_>, what: &str) -> String {
    if sample.name.is_empty() { what.to_owned() } else { format!("{}: {what}", sample.name) }
}

/// Mean and 95 % of a quantity over pressure; nothing where it is not determined.
fn over_pressure(
    n: usize,
    sample: &InferredSample<'_>,
    (name, title): (&str, &str),
    of: impl Fn(&PressureEstimate) -> Option<Interval>,
) -> Html {
    let all: Vec<(&PressureEstimate, Interval)> =
        sample.estimate.pressures.iter().filter_map(|p| Some((p, of(p)?))).collect();
    if all.is_empty() {
        return Html::default();
    }
    let place = |p: &PressureEstimate, value: f64| Point::at(p.pressure / 1e3, value);
    let line = |of: fn(&Interval) -> f64, line: Line| Series {
        colour: Some(0),
        line: Some(line),
        points: all.iter().map(|(p, i)| place(p, of(i))).collect(),
        ..Series::default()
    };
    let marked = |is_measured: bool| Series {
        marker: Some(Marker::Circle),
        hollow: !is_measured,
        line: None,
        points: all
            .iter()
            .filter(|(p, _)| sample.is_measured(p.pressure) == is_measured)
            .map(|(p, i)| place(p, i.mean))
            .collect(),
        ..line(|i| i.mean, Line::Straight)
    };
    // One point has no line: its interval is a bar.
    let bar = all
        .iter()
        .filter(|_| all.len() == 1)
        .map(|(p, i)| Point { error: Some(0.5 * (i.high - i.low)), ..place(p, 0.5 * (i.low + i.high)) });
    let bar = Series { colour: Some(0), points: bar.collect(), ..Series::default() };
    let drawn = Figure {
        title: named(sample, title),
        subtitle: "mean and 95 % of the posterior".to_owned(),
        x: Axis::log("pressure, kPa"),
        series: vec![
            bar,
            line(|i| i.low, Line::Faint),
            line(|i| i.mean, Line::Straight),
            line(|i| i.high, Line::Faint),
            marked(true),
            marked(false),
        ],
        ..Figure::default()
    };
    let stated = |p: &PressureEstimate, i: &Interval| {
        let lower = lower_end(p).filter(|_| name == "z");
        lower.or_else(|| i.is_undetermined().then(|| "not determined".to_owned())).unwrap_or_default()
    };
    let rows = all.iter().map(|(p, i)| {
        let [pressure, mean, sigma, low, high, prior] =
            [p.pressure, i.mean, i.stddev, i.low, i.high, i.prior_stddev].map(|v| v.to_string());
        [pressure, mean, sigma, low, high, prior, stated(p, i)]
    });
    let data = csv(["pressure_pa", name, "sigma", "low", "high", "prior_sigma", "statement"], rows);
    let mut caption = "Mean and 95 % of the posterior; hollow: predicted, without a speed.".to_owned();
    for (p, i) in &all {
        let text = stated(p, i);
        if !text.is_empty() {
            caption += &format!(" At {} kPa {name} is {text}.", kilopascals(p.pressure));
        }
    }
    if sample.is_contradictory {
        caption += " The status is contradictory.";
    }
    figure(&file(n, sample, &format!("{name}-over-pressure")), drawn.element(), caption, &data)
}

fn structure(n: usize, sample: &InferredSample<'_>) -> Html {
    let e = sample.estimate;
    let fit = match sample.is_contradictory {
        true => "These speeds contradict each other or the model.".to_owned(),
        false => format!("Fit of the model: p = {:.2}; below 0.01 it would be bad.", e.p),
    };
    let drawn: Html = [
        over_pressure(n, sample, ("z", "coordination number z"), |p| Some(p.z)),
        over_pressure(n, sample, ("eps", "anisotropy of the contacts, eps"), |p| p.eps),
    ]
    .into_iter()
    .collect();
    let rows = e.pressures.iter().map(|p| {
        let eps = |of: fn(&Interval) -> f64| p.eps.as_ref().map(of);
        [
            Cell::fixed(p.pressure / 1e3, 1),
            Cell::number(lower_end(p).unwrap_or_else(|| format!("{:.2}", p.z.mean))),
            Cell::fixed(Some(p.z.stddev).filter(|_| lower_end(p).is_none()), 2),
            Cell::fixed(p.z.left(), 2),
            Cell::fixed(eps(|i| i.mean), 4),
            Cell::fixed(eps(|i| i.stddev), 4),
            Cell::fixed(eps(Interval::left), 2),
        ]
    });
    let header =
        ["pressure, kPa", "z", "sigma of z", "over the prior's", "eps", "sigma of eps", "over the prior's"];
    html!(
        "{{ fit }}{{ drawn }}{{ numbers }}{{ notes }}",
        fit => paragraph(fit),
        drawn => grid(drawn),
        numbers => table(named(sample, "structure"), header, rows),
        notes => details("Notes", list(sample.notes.iter().map(String::as_str)))
    )
}

fn speeds(n: usize, sample: &InferredSample<'_>) -> Html {
    let InferredSample { series, estimate: e, .. } = sample;
    let kind = |row: &grainlab_emt::SeriesRow| {
        let mode = match row.mode {
            SpeedMode::P => "P",
            SpeedMode::Sv => "SV",
            SpeedMode::Sh => "SH",
            SpeedMode::Bulk => "bulk",
        };
        match row.angle {
            Some(angle) => format!("{mode} at {:.0}°", angle * 180.0 / PI),
            None if row.mode == SpeedMode::P => "P".to_owned(),
            None => "S".to_owned(),
        }
    };
    let mut kinds: Vec<String> = series.rows.iter().map(kind).collect();
    kinds.sort();
    kinds.dedup();
    let (mut drawn, mut legend) = (Vec::new(), Vec::new());
    for (colour, name) in kinds.iter().enumerate() {
        let of = || series.rows.iter().zip(&e.rows).filter(|(row, _)| kind(row) == *name);
        let marker = Marker::of(colour);
        let measured = of().filter_map(|(row, _)| Some(Point::at(row.pressure / 1e3, row.speed?))).collect();
        let mut predicted: Vec<Point> = of()
            .map(|(row, to)| Point { error: Some(to.stddev), ..Point::at(row.pressure / 1e3, to.predicted) })
            .collect();
        predicted.sort_by(|a, b| a.x.total_cmp(&b.x));
        let colour = Some(colour);
        drawn.push(Series { colour, line: Some(Line::Faint), points: predicted, ..Series::default() });
        drawn.push(Series { colour, marker: Some(marker), points: measured, ..Series::default() });
        legend.push(Entry::Shape(marker, colour, false, name.clone()));
    }
    let drawn = Figure {
        title: named(sample, "wave speeds, m/s"),
        subtitle: "markers: measured; lines with errors: predicted from the others".to_owned(),
        x: Axis::log("pressure, kPa"),
        y: Axis::log(""),
        series: drawn,
        legend,
    };
    let rows = series.rows.iter().zip(&e.rows).map(|(row, to)| {
        let measured = row.speed.map(|s| s.to_string()).unwrap_or_default();
        [row.pressure.to_string(), kind(row), measured, to.predicted.to_string(), to.stddev.to_string()]
    });
    let data = csv(["pressure_pa", "mode", "speed", "predicted", "predicted_sigma"], rows);
    grid(figure(
        &file(n, sample, "speeds"),
        drawn.element(),
        "Markers: measured. Lines with errors: predicted from the other pressures, or of one pressure from its other speeds.",
        &data,
    ))
}

fn contact(_: usize, sample: &InferredSample<'_>) -> Html {
    let e = sample.estimate;
    let unknown = |name: &str, of: &Interval| {
        let numbers = [of.mean, of.stddev, of.low, of.high].map(|value| Cell::fixed(value, 3));
        [Cell::text(name)].into_iter().chain(numbers).chain([Cell::fixed(of.left(), 2)])
    };
    let unknowns = [
        unknown("k_t/k_n", &e.stiffness_ratio),
        unknown("ln of the stiffness divided by the stiffness of the law", &e.level),
        unknown("scatter over the stated errors", &e.noise),
    ];
    let header =
        ["unknown", "mean", "standard deviation", "2.5 %", "97.5 %", "standard deviation over the prior's"];
    let laws = e.laws.iter().map(|l| {
        let at = l.ln_crossover.map(|c| Cell::fixed(c.mean.exp() / 1e6, 3));
        [Cell::text(l.law.name()), Cell::fixed(l.probability, 3), at.unwrap_or_else(|| Cell::number(""))]
    });
    let preparations = e.preparations.iter().map(|(name, p)| [Cell::text(name), Cell::fixed(*p, 3)]);
    [
        table(named(sample, "the sample"), header, unknowns),
        table(named(sample, "contact laws"), ["contact law", "probability", "changes at, MPa"], laws),
        table(named(sample, "preparations"), ["preparation", "probability"], preparations),
    ]
    .into_iter()
    .collect()
}
