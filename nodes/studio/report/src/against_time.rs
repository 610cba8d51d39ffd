//! The run against time: small plots over one axis, with the phases behind.

use crate::phased::Phased;
use crate::timeline::{Structure, Timeline};
use grainlab_console::count;
use grainlab_core::SymTensor;
use grainlab_page::plot::{Axis, Band, Figure, Line, Marker, Point, Scale, Series, Strip};
use grainlab_page::{Html, csv, figure, html, paragraph, six_digits};
use std::collections::BTreeSet;

/// Seconds to milliseconds.
const MS: f64 = 1e3;

/// Share of the largest component below which shear components are not drawn.
const SMALL: f64 = 0.01;

struct Curve {
    name: String,
    colour: usize,
    /// Time, s, and value.
    points: Vec<(f64, f64)>,
    /// Points instead of a line.
    marked: bool,
    faint: bool,
}

impl Curve {
    fn line(name: &str, colour: usize, series: &Phased, unit: f64) -> Self {
        let points = series.points().into_iter().map(|(t, v)| (t, v * unit)).collect();
        Self { name: name.to_owned(), colour, points, marked: false, faint: false }
    }

    fn points(name: &str, colour: usize, all: &[Structure], value: fn(&Structure) -> f64) -> Self {
        let points = all.iter().map(|s| (s.time, value(s))).collect();
        Self { name: name.to_owned(), colour, points, marked: true, faint: false }
    }
}

struct Plot {
    id: &'static str,
    title: &'static str,
    scale: Scale,
    caption: &'static str,
    curves: Vec<Curve>,
}

impl Timeline {
    pub(crate) fn against_time(&self) -> Html {
        if self.pressure.count() == 0 {
            return paragraph("The recording has no stress against time.");
        }
        let plots = self.drawable(&BTreeSet::new()).iter().map(|p| self.drawn(p, true)).collect();
        let about = format!(
            "The bands are the phases of the scene, drawn with equal widths, or in simulated time. Of {}, each line has the \
             extremes in bins about a pixel wide.",
            count(self.pressure.count(), "exchange")
        );
        curves(&about, self.phase_list(), plots)
    }

    /// The plots without their data, for a page that draws them again and again. Those of `shown`, by name, stay although their
    /// values have become small; what is drawn is added.
    pub fn drawings(&self, shown: &mut BTreeSet<&'static str>) -> Html {
        let plots = self.drawable(shown);
        shown.extend(plots.iter().map(|p| p.id));
        plots.iter().map(|p| self.drawn(p, false)).collect()
    }

    /// The phases as items of a list.
    pub fn phase_list(&self) -> Html {
        let item = |b: &Band| {
            let name = b.tooltip.split_once(": ").map_or("", |t| t.1);
            html!("<li><b>{{ number }}</b> {{ name }}</li>", number => b.label, name)
        };
        self.bands().iter().map(item).collect()
    }

    /// The plots that have points.
    fn drawable(&self, shown: &BTreeSet<&'static str>) -> Vec<Plot> {
        let has_points = |p: &Plot| p.curves.iter().any(|c| !c.points.is_empty());
        self.plots(shown).into_iter().filter(has_points).collect()
    }

    fn plots(&self, shown: &BTreeSet<&'static str>) -> Vec<Plot> {
        let t = self;
        let components = |series: &[Phased; 6], unit: f64, which: std::ops::Range<usize>| -> Vec<Curve> {
            let curve = |n: usize| Curve::line(SymTensor::COMPONENTS[n], n % 3, &series[n], unit);
            which.map(curve).collect()
        };
        let largest =
            |curves: &[Curve]| curves.iter().flat_map(|c| &c.points).map(|p| p.1.abs()).fold(0.0, f64::max);
        let with_shear = |series: &[Phased; 6], unit: f64, id: &str| {
            let (normal, shear) = (components(series, unit, 0..3), components(series, unit, 3..6));
            let is_small = !shown.contains(id) && largest(&shear) < SMALL * largest(&normal);
            (normal, if is_small { Vec::new() } else { shear })
        };
        let (stress, shear_stress) = with_shear(&t.stress, 1e-3, "shear-stress");
        let (strain, shear_strain) = with_shear(&t.strain, 100.0, "shear-strain");
        let mut coordination = vec![Curve::line("k", 0, &t.coordination, 1.0)];
        if !t.fabrics.is_empty() {
            coordination.push(Curve::points("z", 1, &t.fabrics, |s| s.z));
        }
        let target =
            |(n, series): (usize, &Phased)| Curve { faint: true, ..Curve::line("", n, series, 1e-3) };
        let targets = t.targets[..3].iter().enumerate().map(target);
        let fabric = match t.fabrics.as_slice() {
            [] | [_] => Vec::new(),
            all => {
                vec![Curve::points("ε", 0, all, |s| s.eps), Curve::points("ε_k", 1, all, |s| s.eps_stiffness)]
            }
        };
        let plot = |id, title, caption, curves| Plot { id, title, scale: Scale::Linear, caption, curves };
        vec![
            plot(
                "stress",
                "Normal stress, kPa",
                "Positive in compression; thin: targets. Shear components below 1 % of the largest of these are not drawn.",
                targets.chain(stress).collect(),
            ),
            plot("shear-stress", "Shear stress, kPa", "", shear_stress),
            plot(
                "pressure",
                "Pressure and deviator, kPa",
                "p is the mean stress, q = √(3/2 s : s) that of the deviator s.",
                vec![Curve::line("p", 0, &t.pressure, 1e-3), Curve::line("q", 1, &t.deviator, 1e-3)],
            ),
            plot(
                "strain",
                "Normal strain, %",
                "Logarithmic, positive in extension, since the reference state; before a phase sets one, since the first step. Shear components below 1 % of the largest of these are not drawn.",
                strain,
            ),
            plot("shear-strain", "Shear strain, %", "", shear_strain),
            plot("solid-fraction", "Solid fraction φ", "", vec![Curve::line("φ", 0, &t.solid_fraction, 1.0)]),
            plot(
                "coordination",
                "Coordination number",
                "k of all grains; z without rattlers, at the measured packings.",
                coordination,
            ),
            Plot {
                id: "unbalanced-force",
                title: "Unbalanced force",
                scale: Scale::Log,
                caption: "Mean net force of a grain over the mean contact force.",
                curves: vec![Curve::line("", 0, &t.unbalanced, 1.0)],
            },
            plot(
                "fabric",
                "Fabric: anisotropy",
                "ε of the contacts, and ε_k, weighted by their stiffness, at the measured packings.",
                fabric,
            ),
        ]
    }

    /// The phases as bands, ms.
    fn bands(&self) -> Vec<Band> {
        let phases = &self.phases;
        let ends = phases.iter().skip(1).map(|(_, t)| *t).chain([self.end]);
        let band = |((phase, from), to): (&(u32, f64), f64)| Band {
            range: [from * MS, to * MS],
            label: format!("{}", self.number(*phase)),
            tooltip: format!("{}: {}", self.number(*phase), self.phase_name(*phase)),
        };
        phases.iter().zip(ends).map(band).collect()
    }

    fn drawn(&self, plot: &Plot, with_data: bool) -> Html {
        let axis = self.axis();
        let bands = self.bands();
        let numbered = |(n, band): (usize, &Band)| Band { range: [n as f64, n as f64 + 1.0], ..band.clone() };
        let by_phase = Strip {
            figure: self.figure(plot, "phase", |t| axis.place(t)),
            bands: bands.iter().enumerate().map(numbered).collect(),
            by_band: true,
        };
        let by_time = Strip { figure: self.figure(plot, "time, ms", |t| t * MS), bands, by_band: false };
        let rows = plot.curves.iter().filter(|c| !c.faint).flat_map(|curve| {
            let name = if curve.name.is_empty() { plot.id } else { &curve.name };
            curve.points.iter().map(|(t, v)| [name.to_owned(), six_digits(*t), six_digits(*v)])
        });
        let unit = match plot.title.rsplit(", ").next() {
            Some("kPa") => "_kpa",
            Some("%") => "_percent",
            _ => "",
        };
        let value = plot.id.replace('-', "_") + unit;
        let data = if with_data { csv(["series", "time_s", &value], rows) } else { String::new() };
        let both = html!(
            "<div data-axis=\"phase\">{{ by_phase }}</div><div data-axis=\"time\">{{ by_time }}</div>",
            by_phase => by_phase.svg(),
            by_time => by_time.svg()
        );
        figure(plot.id, both, plot.caption, &data)
    }

    /// A plot over a horizontal axis that follows from time.
    fn figure(&self, plot: &Plot, name: &str, across: impl Fn(f64) -> f64) -> Figure {
        let drawable = |v: f64| plot.scale == Scale::Linear || v > 0.0;
        let series = |c: &Curve| Series {
            name: c.name.clone(),
            colour: Some(c.colour),
            marker: c.marked.then_some(Marker::Circle),
            line: Some(if c.marked || c.faint { Line::Faint } else { Line::Straight }),
            points: c
                .points
                .iter()
                .filter(|p| drawable(p.1))
                .map(|(t, v)| Point::at(across(*t), *v))
                .collect(),
            ..Series::default()
        };
        // The axis is that of the run, whatever the values of this plot.
        let ends = [self.begin(), self.end];
        let middle =
            plot.curves.iter().flat_map(|c| &c.points).map(|p| p.1).find(|v| drawable(*v)).unwrap_or(1.0);
        let span = Series { points: ends.map(|t| Point::at(across(t), middle)).into(), ..Series::default() };
        Figure {
            title: plot.title.to_owned(),
            subtitle: said(&plot.curves),
            x: Axis::linear(name),
            y: Axis { name: String::new(), scale: plot.scale },
            series: std::iter::once(span).chain(plot.curves.iter().map(series)).collect(),
            legend: Vec::new(),
        }
    }
}

/// Plots over a common axis, which the reader chooses.
pub fn curves(about: &str, phases: Html, plots: Html) -> Html {
    html!(include_str!("../assets/curves.html"), about, phases, plots)
}

/// The last values, for readers who do not see the plot.
fn said(curves: &[Curve]) -> String {
    let last = |c: &Curve| Some(format!("{} {}", c.name, six_digits(c.points.last()?.1)).trim().to_owned());
    format!(
        "Last values: {}",
        curves.iter().filter(|c| !c.faint).filter_map(last).collect::<Vec<_>>().join(", ")
    )
}
