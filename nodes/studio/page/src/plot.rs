//! Plots as SVG: series of points over two axes, linear or logarithmic, with error bars, labels and a legend, in light or
//! dark. Points can have tooltips.
//!
//! - [`Figure`]: the contents; [`Theme`]: the colours of a file; `page_style`: those of all plots of a page
//! - [`Strip`]: a plot of a page; [`Rose`]: a quantity by direction; [`Bars`]: values by name; [`Intervals`]: with their intervals
//! - `axis`: positions of values, and the tick marks of an axis
//! - `labels`: texts beside points, if there is room
//! - `draw`: the elements; `style`: their colours

mod axis;
mod bars;
mod draw;
mod figure;
mod intervals;
mod labels;
mod rose;
mod strip;
mod style;

pub use bars::{Bar, Bars};
pub use figure::{Axis, Entry, Figure, Line, Marker, Point, Scale, Series, Theme};
pub use intervals::{Estimated, Intervals};
pub use rose::Rose;
pub use strip::{Band, Strip};
pub(crate) use style::page_style;

use crate::markup::Html;
use axis::Range;
use draw::{Drawing, Key};

impl Figure {
    /// The plot as a file.
    pub fn svg(&self, theme: Theme) -> String {
        let mut drawing = Drawing::begin(theme, &self.title, &self.subtitle);
        let [x, y] = self.ranges(drawing.frame());
        drawing.axes((&x, &self.x.name), (&y, &self.y.name));
        self.draw(&mut drawing, [&x, &y]);
        drawing.legend(&self.legend);
        drawing.end()
    }

    /// The plot as an element of a page.
    pub fn element(self) -> Html {
        Strip { figure: self, ..Strip::default() }.svg()
    }

    fn ranges(&self, [left, top, right, bottom]: labels::Area) -> [Range; 2] {
        let points = || self.series.iter().flat_map(|s| &s.points);
        [
            Range::of(points().map(|p| p.x), self.x.scale, [left, right]),
            Range::of(points().flat_map(Point::up), self.y.scale, [bottom, top]),
        ]
    }

    fn draw(&self, drawing: &mut Drawing, [x, y]: [&Range; 2]) {
        let frame = drawing.frame();
        let drawable = |p: &&Point| x.has(p.x) && y.has(p.y);
        let mut labelled = Vec::new();
        let mut taken = Vec::new();
        for series in &self.series {
            drawing.series(&series.name, |drawing| {
                let drawn: Vec<&Point> = series.points.iter().filter(drawable).collect();
                let places: Vec<[f64; 2]> = drawn.iter().map(|p| [x.at(p.x), y.at(p.y)]).collect();
                drawing.line(series, &places);
                for (point, at) in drawn.iter().zip(&places) {
                    if let Some(error) = point.error {
                        let end = |value: f64| if y.has(value) { y.at(value) } else { frame[3] };
                        drawing.error_bar(series.colour, at[0], [end(point.y - error), end(point.y + error)]);
                    }
                    if let Some(marker) = series.marker {
                        let tooltip = point.tooltip.as_deref().unwrap_or("");
                        drawing.marker(
                            *at,
                            Key { marker, colour: series.colour, hollow: series.hollow },
                            tooltip,
                        );
                        taken.push(labels::around(*at));
                    }
                    if let Some(label) = &point.label {
                        labelled.push((*at, label.as_str(), series.colour));
                    }
                }
            });
        }
        for (place, label, colour) in labels::place(&labelled, taken, frame) {
            drawing.label(place, label, colour);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(points: Vec<Point>) -> Figure {
        let axis = |name: &str| Axis { name: name.into(), scale: Scale::Log };
        let series = Series { marker: Some(Marker::Circle), points, ..Series::default() };
        Figure {
            title: "a & b".into(),
            subtitle: String::new(),
            x: axis("x"),
            y: axis("y"),
            series: vec![series],
            ..Figure::default()
        }
    }

    #[test]
    fn what_is_written_into_the_svg_cannot_end_it() {
        let point = Point { tooltip: Some("<\"x\">".into()), ..Point::at(1.0, 2.0) };
        let svg = figure(vec![point]).svg(Theme::Light);
        assert!(svg.contains("a &amp; b") && svg.contains("&lt;&quot;x&quot;&gt;"), "{svg}");
    }

    #[test]
    fn what_has_no_place_on_a_logarithmic_axis_is_left_out() {
        let all = [(1.0, 1.0), (2.0, 0.0), (-1.0, 1.0), (f64::NAN, 1.0), (3.0, f64::INFINITY), (4.0, 1e3)];
        let svg = figure(all.map(|(x, y)| Point::at(x, y)).into()).svg(Theme::Light);
        assert_eq!(svg.matches("<circle").count(), 2, "{svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn an_error_bar_that_reaches_zero_ends_at_the_axis() {
        let point = Point { error: Some(2.0), ..Point::at(1.0, 1.5) };
        let svg = figure(vec![point, Point::at(2.0, 1.0)]).svg(Theme::System);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert!(svg.contains("prefers-color-scheme"));
    }

    #[test]
    fn the_last_label_of_an_axis_ends_within_the_picture() {
        let svg = figure(vec![Point::at(50.0, 1.0), Point::at(950.0, 2.0)]).element();
        let label = svg.split(">1000<").next().unwrap().rsplit("x=\"").next().unwrap();
        let middle: f64 = label.split('"').next().unwrap().parse().unwrap();
        assert!(middle + 4.0 * draw::HALF_LETTER <= 340.0, "{middle}");
    }

    #[test]
    fn without_any_point_the_axes_still_have_a_range() {
        let svg = figure(Vec::new()).svg(Theme::Light);
        assert!(!svg.contains("NaN") && svg.ends_with("</svg>\n"), "{svg}");
    }
}
