//! A quantity by direction: a polar histogram about a vertical axis, which is one of rotation and a mirror too.

use super::draw::{Drawing, class};
use crate::markup::Html;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write;

const PICTURE: [f64; 2] = [300.0, 330.0];

const CENTRE: [f64; 2] = [150.0, 184.0];

/// Radius of the largest circle.
const RADIUS: f64 = 118.0;

/// Corners of the curve in a quarter.
const CORNERS: usize = 45;

/// Values by x = |cos θ|, relative to their mean: 1 everywhere if no direction stands out.
#[derive(Clone, Debug, Default)]
pub struct Rose {
    /// Title of the plot.
    pub title: String,
    /// Values in bins of equal width in x, from 0 to 1, hence of equal solid angle.
    pub bins: Vec<f64>,
    /// a of the curve 1 + a (3 x² − 1).
    pub curve: Option<f64>,
    /// Number of the colour of the bins.
    pub colour: usize,
    /// Name of the axis.
    pub axis: String,
}

impl Rose {
    /// The plot as an element of a page.
    pub fn svg(&self) -> Html {
        let fitted = |x: f64| 1.0 + self.curve.unwrap_or(0.0) * (3.0 * x * x - 1.0);
        let finite = self.bins.iter().copied().chain([fitted(0.0), fitted(1.0)]).filter(|v| v.is_finite());
        let largest = finite.fold(1.0, f64::max);
        let scale = RADIUS / (0.25 * (largest / 0.25).ceil()).max(1.25);
        let said = self
            .curve
            .map_or_else(String::new, |a| format!("; fitted: 1 + a (3 cos² θ − 1) with a = {a:.4}"));
        let values: Vec<String> = self.bins.iter().map(|v| format!("{v:.2}")).collect();
        let about = format!("{}, by |cos θ| from 0 to 1: {}{said}", self.title, values.join(", "));
        let mut drawing = Drawing::small(PICTURE, [0.0; 4], &self.title, &about, "");
        let [x, y] = CENTRE;
        let step = [0.5, 1.0, 2.0, 5.0].into_iter().find(|s| s * 3.0 * scale >= RADIUS).unwrap_or(10.0);
        for ring in (1..).map(|n| step * f64::from(n)).take_while(|r| r * scale <= RADIUS + 0.5) {
            let (radius, dash) = (ring * scale, if ring == 1.0 { "" } else { " stroke-dasharray=\"2 3\"" });
            drawing.add(format_args!(
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius:.1}\" fill=\"none\" class=\"grid\"{dash}/>"
            ));
            drawing.text([x + radius + 3.0, y - 3.0], "start", "class=\"faint\"", &format!("{ring}"));
        }
        drawing.segment([x, y - RADIUS - 8.0, x, y + RADIUS + 8.0], "grid");
        drawing.segment([x - RADIUS - 8.0, y, x + RADIUS + 8.0, y], "grid");
        drawing.text([x, y - RADIUS - 13.0], "middle", "class=\"ink\"", &self.axis);
        let (class_of_bins, count) = (class(Some(self.colour)), self.bins.len() as f64);
        for (n, value) in self.bins.iter().enumerate().filter(|(_, v)| v.is_finite()) {
            // Angles from the axis: the bin of the largest x is at the poles.
            let [from, to] = [(n as f64 + 1.0) / count, n as f64 / count].map(|x| x.min(1.0).acos());
            let radius = value.max(0.0) * scale;
            let words =
                format!("|cos θ| {:.2} to {:.2}: {value:.3}", n as f64 / count, (n as f64 + 1.0) / count);
            drawing.saying(&words, |drawing| for [from, to] in [[from, to], [-to, -from], [PI - to, PI - from], [PI + from, PI + to]] {
                let at = |angle: f64| [x + radius * angle.sin(), y - radius * angle.cos()];
                let ([x1, y1], [x2, y2]) = (at(from), at(to));
                drawing.add(format_args!(
                    "<path d=\"M {x} {y} L {x1:.1} {y1:.1} A {radius:.1} {radius:.1} 0 0 1 {x2:.1} {y2:.1} Z\" \
                     class=\"{class_of_bins}\" fill=\"currentColor\" fill-opacity=\"0.3\"/>"
                ));
            });
        }
        if self.curve.is_some() {
            let mut path = String::new();
            for n in 0..4 * CORNERS {
                let angle = FRAC_PI_2 * n as f64 / CORNERS as f64;
                let radius = fitted(angle.cos()).max(0.0) * scale;
                let first = if n == 0 { 'M' } else { 'L' };
                let _ =
                    write!(path, "{first} {:.1} {:.1} ", x + radius * angle.sin(), y - radius * angle.cos());
            }
            drawing.add(format_args!(
                "<path d=\"{path}Z\" class=\"{}\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"2\"/>",
                class(Some(1))
            ));
        }
        drawing.element()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bin_says_its_value_and_has_a_wedge_in_each_quarter_and_a_missing_one_has_none() {
        let rose = Rose { bins: vec![1.2, f64::NAN, 0.7], curve: Some(0.1), ..Rose::default() };
        let svg = rose.svg();
        assert_eq!((svg.matches("fill-opacity").count(), svg.matches("data-said").count()), (8, 2));
        assert!(svg.contains("a = 0.1000") && !svg.contains("=\"NaN"), "{svg:?}");
        assert!(!Rose { curve: None, ..rose }.svg().contains("stroke-width=\"2\""));
    }
}
