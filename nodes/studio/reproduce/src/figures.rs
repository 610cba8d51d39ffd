//! Figures 1 to 4, ours as filled symbols with error bars, the paper's as outlines.

use crate::Reproduction;
use grainlab_emt::Modulus;
use grainlab_page::html::figure;
use grainlab_page::plot::{Axis, Entry, Figure, Line, Marker, Point, Series, Theme};
use grainlab_paper::inversion::{Judged, Row};
use grainlab_paper::{Mean, PAPER, PRESSURE, PRESSURES, Quantity, SAMPLES};

/// A pressure in kPa.
fn kpa(pressure: usize) -> f64 {
    PRESSURE[pressure] / 1e3
}

/// One curve of a sample.
struct Curve {
    marker: Marker,
    hollow: bool,
    line: Line,
    /// Value and error at each pressure.
    values: [Option<(f64, Option<f64>)>; PRESSURES],
    name: &'static str,
}

impl Curve {
    fn series(&self, sample: usize) -> Series {
        let point = |(pressure, value): (usize, &Option<(f64, Option<f64>)>)| {
            let (y, error) = (*value)?;
            let tooltip = format!("{} at {} kPa, {}: {y:.4}", PAPER[sample].name, kpa(pressure), self.name);
            Some(Point { error, tooltip: Some(tooltip), ..Point::at(kpa(pressure), y) })
        };
        Series {
            colour: Some(sample),
            marker: Some(self.marker),
            hollow: self.hollow,
            line: Some(self.line),
            points: self.values.iter().enumerate().filter_map(point).collect(),
        }
    }
}

fn ours(mean: &Mean, scale: f64) -> (f64, Option<f64>) {
    (mean.value / scale, mean.error.map(|e| e / scale))
}

impl Reproduction {
    fn simulated(
        &self,
        quantity: Quantity,
        scale: f64,
        marker: Marker,
        name: &'static str,
    ) -> [Curve; SAMPLES] {
        std::array::from_fn(|sample| Curve {
            marker,
            hollow: false,
            line: Line::Straight,
            values: std::array::from_fn(|p| self.get(quantity, sample, p).map(|c| ours(&c.ours, scale))),
            name,
        })
    }

    fn in_paper(
        &self,
        quantity: Quantity,
        scale: f64,
        marker: Marker,
        name: &'static str,
    ) -> [Curve; SAMPLES] {
        std::array::from_fn(|sample| Curve {
            marker,
            hollow: true,
            line: Line::Faint,
            values: std::array::from_fn(|p| quantity.in_paper(sample, p).map(|v| (v.value / scale, None))),
            name,
        })
    }

    fn way(&self, model: &str, gamma: Option<&str>) -> Option<&Judged> {
        let calibration = if model == "relaxed" { "grainlab" } else { "paper" };
        self.judged.iter().find(|j| {
            j.way.model.name() == model
                && j.way.calibration.name() == calibration
                && j.way.gamma.map(|g| g.name()) == gamma
        })
    }

    fn inferred(
        &self,
        (model, gamma): (&str, Option<&str>),
        value: fn(&Row) -> Option<Mean>,
        marker: Marker,
        name: &'static str,
    ) -> [Curve; SAMPLES] {
        let found = self.way(model, gamma);
        let at = |sample: usize, pressure: usize| {
            let row = found?.rows.iter().find(|r| r.sample == sample && r.pressure == pressure)?;
            value(row).map(|m| ours(&m, 1.0))
        };
        std::array::from_fn(|sample| Curve {
            marker,
            hollow: false,
            line: Line::Faint,
            values: std::array::from_fn(|p| at(sample, p)),
            name,
        })
    }

    /// All four, with their captions.
    pub(crate) fn figures(&self) -> String {
        let moduli = [(Modulus::G12, Marker::Circle, "G12"), (Modulus::G13, Marker::Triangle, "G13")];
        let figures = [
            (
                plot(
                    "Fig. 1: deviatoric fabric",
                    "L33 − (L11 + L22)/2",
                    [
                        self.simulated(Quantity::DeviatoricFabric, 1.0, Marker::Circle, "ours"),
                        self.in_paper(Quantity::DeviatoricFabric, 1.0, Marker::Circle, "paper"),
                    ],
                ),
                "The paper finds it almost constant with pressure. Its values are 2/5 of its ε (Eq. 20).",
            ),
            (
                plot(
                    "Fig. 2: shear moduli",
                    "MPa",
                    moduli
                        .map(|(m, marker, name)| self.simulated(Quantity::Modulus(m), 1e6, marker, name))
                        .into_iter()
                        .chain(moduli.map(|(m, marker, _)| {
                            self.in_paper(Quantity::Modulus(m), 1e6, marker, "implied by Table III")
                        })),
                ),
                "The paper draws its moduli without a table; the outlines are those that its Table III implies.",
            ),
            (
                plot(
                    "Fig. 3: coordination number",
                    "k",
                    [
                        self.simulated(Quantity::K, 1.0, Marker::Circle, "counted"),
                        self.inferred(
                            ("ratio", Some("total")),
                            |r| r.k,
                            Marker::Triangle,
                            "by the paper's ratios",
                        ),
                        self.inferred(("relaxed", None), |r| r.k, Marker::Diamond, "by relaxed"),
                        self.in_paper(Quantity::K, 1.0, Marker::Circle, "counted in the paper"),
                    ],
                ),
                "Counted, and inferred from the moduli of the same packings. k by the absolute moduli is in the table of moduli.",
            ),
            (
                plot(
                    "Fig. 4: anisotropy",
                    "ε",
                    [
                        self.simulated(Quantity::Eps, 1.0, Marker::Circle, "counted"),
                        self.inferred(
                            ("ratio", Some("total")),
                            |r| r.eps,
                            Marker::Triangle,
                            "by the paper's ratios",
                        ),
                        self.inferred(("relaxed", None), |r| r.eps, Marker::Diamond, "by relaxed"),
                        self.in_paper(Quantity::Eps, 1.0, Marker::Circle, "counted in the paper"),
                    ],
                ),
                "Counted, and inferred from the moduli of the same packings; the paper's model takes γ/Δ of the total strain.",
            ),
        ];
        figures.iter().map(|(svg, caption)| figure(svg, caption)).collect()
    }
}

/// A plot against pressure, a colour for each sample.
fn plot(title: &str, unit: &str, curves: impl IntoIterator<Item = [Curve; SAMPLES]>) -> String {
    let curves: Vec<[Curve; SAMPLES]> = curves.into_iter().collect();
    let mut legend: Vec<Entry> = PAPER
        .iter()
        .enumerate()
        .map(|(n, s)| Entry::Colour(n, format!("{}, μ2 = {}", s.name, s.mu2)))
        .collect();
    legend.push(Entry::Gap);
    let mut known = Vec::new();
    for [first, ..] in &curves {
        if !known.contains(&(first.name, first.hollow)) {
            known.push((first.name, first.hollow));
            legend.push(Entry::Shape(first.marker, None, first.hollow, first.name.to_owned()));
        }
    }
    let series =
        curves.iter().flat_map(|set| set.iter().enumerate().map(|(sample, curve)| curve.series(sample)));
    let figure = Figure {
        title: title.to_owned(),
        subtitle: "mean and standard error over seeds; outlines: the paper".to_owned(),
        x: Axis::log("p, kPa"),
        y: Axis::linear(unit),
        series: series.collect(),
        legend,
    };
    figure.svg(Theme::System)
}
