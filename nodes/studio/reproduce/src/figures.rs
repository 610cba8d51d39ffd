//! Figures 1 to 4 as a plot for each sample: ours and inferred values with error bars, the paper's as outlines.

use crate::Reproduction;
use crate::paper::inversion::Row;
use crate::paper::{Mean, PAPER, PRESSURE, PRESSURES, Quantity};
use grainlab_emt::Modulus;
use grainlab_page::plot::{Axis, Figure, Line, Marker, Point, Series};
use grainlab_page::{Html, csv, figure, html, six_digits};

/// Values of one sample at each pressure, with standard errors.
type Values = [Option<(f64, Option<f64>)>; PRESSURES];

struct Curve<'a> {
    name: &'static str,
    colour: Option<usize>,
    marker: Marker,
    hollow: bool,
    values: Box<dyn Fn(usize) -> Values + 'a>,
}

fn mean(m: &Mean, scale: f64) -> (f64, Option<f64>) {
    (m.value / scale, m.error.map(|e| e / scale))
}

impl Reproduction {
    fn simulated(&self, quantity: Quantity, scale: f64, name: &'static str) -> Curve<'_> {
        let values = move |sample| -> Values {
            std::array::from_fn(|p| {
                self.get(quantity, sample, p).map(|c| mean(&Mean { error: c.error(), ..c.ours }, scale))
            })
        };
        Curve { name, colour: Some(0), marker: Marker::Circle, hollow: false, values: Box::new(values) }
    }

    fn inferred(
        &self,
        (model, gamma, calibration): (&str, Option<&str>, &str),
        value: fn(&Row) -> Option<Mean>,
        (name, colour, marker): (&'static str, usize, Marker),
    ) -> Curve<'_> {
        let found = self.judged(model, gamma, calibration);
        let values = move |sample| -> Values {
            std::array::from_fn(|p| {
                let row = found?.rows.iter().find(|r| r.sample == sample && r.pressure == p)?;
                value(row).map(|m| mean(&m, 1.0))
            })
        };
        Curve { name, colour: Some(colour), marker, hollow: false, values: Box::new(values) }
    }

    fn counted_and_inferred(&self, quantity: Quantity, value: fn(&Row) -> Option<Mean>) -> Vec<Curve<'_>> {
        let (ratio, relaxed) = (("ratio", Some("total"), "paper"), ("relaxed", None, "grainlab"));
        let counted = self.simulated(quantity, 1.0, "counted");
        // Counted in the very packings that are inverted.
        let exact = move |sample| (counted.values)(sample).map(|v| v.map(|(value, _)| (value, None)));
        vec![
            Curve { values: Box::new(exact), ..self.simulated(quantity, 1.0, "counted") },
            self.inferred(ratio, value, ("by the paper's model", 1, Marker::Triangle)),
            self.inferred(relaxed, value, ("by relaxed", 2, Marker::Diamond)),
        ]
    }

    pub(crate) fn figures(&self) -> Html {
        let beside = |q, scale, name| vec![self.simulated(q, scale, "ours"), in_paper(q, scale, name)];
        let [g12, g13] = [Modulus::G12, Modulus::G13].map(Quantity::Modulus);
        let figures = [
            (
                "deviatoric-fabric",
                "Fig. 1: deviatoric fabric L33 − (L11 + L22)/2",
                beside(Quantity::DeviatoricFabric, 1.0, "paper"),
                "The paper finds it almost constant with pressure. Its values are 2/5 of its ε (Eq. 20).",
            ),
            (
                "shear-moduli-across",
                "Fig. 2: shear modulus G12, MPa",
                beside(g12, 1e6, "implied by Table III"),
                "The paper draws its moduli without a table; the outlines are those that its Table III implies.",
            ),
            (
                "shear-moduli-along",
                "Fig. 2: shear modulus G13, MPa",
                beside(g13, 1e6, "implied by Table III"),
                "",
            ),
            (
                "coordination",
                "Fig. 3: coordination number k",
                self.counted_and_inferred(Quantity::K, |r| r.k),
                "Counted, and inferred from the moduli of the same packings with an error of 1 %; bars: standard deviation of an estimate. k by the absolute moduli is in the table of moduli.",
            ),
            (
                "anisotropy",
                "Fig. 4: anisotropy ε",
                self.counted_and_inferred(Quantity::Eps, |r| r.eps),
                "Counted, and inferred from the moduli of the same packings with an error of 1 %; bars: standard deviation of an estimate. The paper's model takes γ/Δ of the total strain.",
            ),
        ];
        figures.iter().map(|(id, title, curves, caption)| drawn(id, title, curves, caption)).collect()
    }
}

fn in_paper<'a>(quantity: Quantity, scale: f64, name: &'static str) -> Curve<'a> {
    let values = move |sample| -> Values {
        std::array::from_fn(|p| quantity.in_paper(sample, p).map(|v| (v.value / scale, None)))
    };
    Curve { name, colour: None, marker: Marker::Circle, hollow: true, values: Box::new(values) }
}

/// A plot against pressure for each sample, all with the curves and one caption.
fn drawn(id: &str, title: &str, curves: &[Curve<'_>], caption: &str) -> Html {
    let mut rows = Vec::new();
    let plots: Html = (PAPER.iter().enumerate())
        .map(|(sample, s)| {
            let series = curves.iter().map(|curve| {
                let points =
                    (curve.values)(sample).into_iter().enumerate().filter_map(|(pressure, value)| {
                        let ((y, error), x) = (value?, PRESSURE[pressure] / 1e3);
                        let stated = error.map(six_digits).unwrap_or_default();
                        rows.push([
                            s.name.to_owned(),
                            curve.name.to_owned(),
                            x.to_string(),
                            six_digits(y),
                            stated,
                        ]);
                        Some(Point { error, ..Point::at(x, y) })
                    });
                Series {
                    name: curve.name.to_owned(),
                    colour: curve.colour,
                    marker: Some(curve.marker),
                    hollow: curve.hollow,
                    line: Some(Line::Faint),
                    points: points.collect(),
                }
            });
            let series = series.collect();
            let title = format!("{}, μ2 = {}", s.name, s.mu2);
            Figure { title, x: Axis::log("p, kPa"), series, ..Figure::default() }.element()
        })
        .collect();
    let data = csv(["sample", "curve", "pressure_kpa", "value", "standard_error"], rows);
    let plots = html!("<h3>{{ title }}</h3>\n<div class=\"panels\">{{ plots }}</div>", title, plots);
    figure(id, plots, caption, &data)
}
