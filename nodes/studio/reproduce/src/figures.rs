//! Figures 1 to 4, ours as filled symbols with error bars, the paper's as outlines.

use crate::Reproduction;
use grainlab_emt::Modulus;
use grainlab_page::plot::{Axis, Entry, Figure, Line, Marker, Point, Series};
use grainlab_page::{Html, figure};
use grainlab_paper::inversion::Row;
use grainlab_paper::{Mean, PAPER, PRESSURE, PRESSURES, Quantity, SAMPLES};

/// A pressure in kPa.
fn kpa(pressure: usize) -> f64 {
    PRESSURE[pressure] / 1e3
}

/// One curve of a sample.
#[derive(Clone)]
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

/// The curves of all samples, with these values at each pressure.
fn curves(
    marker: Marker,
    hollow: bool,
    line: Line,
    name: &'static str,
    value: impl Fn(usize, usize) -> Option<(f64, Option<f64>)>,
) -> [Curve; SAMPLES] {
    let values = |sample| std::array::from_fn(|pressure| value(sample, pressure));
    std::array::from_fn(|sample| Curve { marker, hollow, line, values: values(sample), name })
}

impl Reproduction {
    fn simulated(
        &self,
        quantity: Quantity,
        scale: f64,
        marker: Marker,
        name: &'static str,
    ) -> [Curve; SAMPLES] {
        curves(marker, false, Line::Straight, name, |s, p| {
            self.get(quantity, s, p).map(|c| ours(&c.ours, scale))
        })
    }

    fn inferred(
        &self,
        (model, gamma, calibration): (&str, Option<&str>, &str),
        value: fn(&Row) -> Option<Mean>,
        marker: Marker,
        name: &'static str,
    ) -> [Curve; SAMPLES] {
        let found = self.judged(model, gamma, calibration);
        curves(marker, false, Line::Faint, name, |sample, pressure| {
            let row = found?.rows.iter().find(|r| r.sample == sample && r.pressure == pressure)?;
            value(row).map(|m| ours(&m, 1.0))
        })
    }

    /// Counted here, inferred by the models, and counted in the paper.
    fn counted_and_inferred(
        &self,
        quantity: Quantity,
        value: fn(&Row) -> Option<Mean>,
    ) -> [[Curve; SAMPLES]; 4] {
        let (ratio, relaxed) = (("ratio", Some("total"), "paper"), ("relaxed", None, "grainlab"));
        [
            self.simulated(quantity, 1.0, Marker::Circle, "counted"),
            self.inferred(ratio, value, Marker::Triangle, "by the paper's ratios"),
            self.inferred(relaxed, value, Marker::Diamond, "by relaxed"),
            in_paper(quantity, 1.0, Marker::Circle, "counted in the paper"),
        ]
    }

    /// All four, with their captions.
    pub(crate) fn figures(&self) -> Html {
        let fabric = [
            self.simulated(Quantity::DeviatoricFabric, 1.0, Marker::Circle, "ours"),
            in_paper(Quantity::DeviatoricFabric, 1.0, Marker::Circle, "paper"),
        ];
        let moduli = [(Modulus::G12, Marker::Circle, "G12"), (Modulus::G13, Marker::Triangle, "G13")];
        let simulated =
            moduli.map(|(m, marker, name)| self.simulated(Quantity::Modulus(m), 1e6, marker, name));
        let implied =
            moduli.map(|(m, marker, _)| in_paper(Quantity::Modulus(m), 1e6, marker, "implied by Table III"));
        let figures = [
            (
                "deviatoric-fabric",
                plot("Fig. 1: deviatoric fabric", "L33 − (L11 + L22)/2", &fabric),
                "The paper finds it almost constant with pressure. Its values are 2/5 of its ε (Eq. 20).",
            ),
            (
                "shear-moduli",
                plot("Fig. 2: shear moduli", "MPa", &[simulated, implied].concat()),
                "The paper draws its moduli without a table; the outlines are those that its Table III implies.",
            ),
            (
                "coordination",
                plot("Fig. 3: coordination number", "k", &self.counted_and_inferred(Quantity::K, |r| r.k)),
                "Counted, and inferred from the moduli of the same packings. k by the absolute moduli is in the table of moduli.",
            ),
            (
                "anisotropy",
                plot("Fig. 4: anisotropy", "ε", &self.counted_and_inferred(Quantity::Eps, |r| r.eps)),
                "Counted, and inferred from the moduli of the same packings; the paper's model takes γ/Δ of the total strain.",
            ),
        ];
        figures.into_iter().map(|(id, plot, caption)| figure(id, plot, caption, "")).collect()
    }
}

fn in_paper(quantity: Quantity, scale: f64, marker: Marker, name: &'static str) -> [Curve; SAMPLES] {
    curves(marker, true, Line::Faint, name, |s, p| quantity.in_paper(s, p).map(|v| (v.value / scale, None)))
}

/// A plot against pressure, a colour for each sample.
fn plot(title: &str, unit: &str, curves: &[[Curve; SAMPLES]]) -> Html {
    let mut legend: Vec<Entry> = PAPER
        .iter()
        .enumerate()
        .map(|(n, s)| Entry::Colour(n, format!("{}, μ2 = {}", s.name, s.mu2)))
        .collect();
    legend.push(Entry::Gap);
    let mut known = Vec::new();
    for [first, ..] in curves {
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
    figure.element()
}
