//! The Pareto front as SVG: time against error, both logarithmic.

use super::knobs::Knob;
use super::report::{Report, Row};
use clap::ValueEnum;
use std::fmt::Write;

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 560.0;
/// Left, right, top, bottom of the axes.
const AXES: [f64; 4] = [70.0, 640.0, 60.0, 490.0];
/// One a knob: distinct for the colour-blind (Okabe and Ito, and two more), dark enough on white.
const COLOURS: [&str; 9] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d1f", "#6a3d9a"];

/// A point that can be drawn: a logarithm needs positive numbers.
struct Point<'a> {
    row: &'a Row,
    seconds: f64,
    error: f64,
}

/// A logarithmic axis from decade parts below the smallest to above the largest value.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64> + Clone, from: f64, to: f64) -> Self {
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.fold(0.0, f64::max);
        let (low, high) = if low <= high { (low / 1.25, high * 1.25) } else { (0.5, 2.0) };
        Self { low, high, from, to }
    }

    fn at(&self, value: f64) -> f64 {
        self.from + (self.to - self.from) * (value / self.low).ln() / (self.high / self.low).ln()
    }

    /// 1, 2 and 5 of every decade in range.
    fn ticks(&self) -> Vec<f64> {
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let all = decades.flat_map(|d| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(d)));
        all.filter(|t| (self.low..=self.high).contains(t)).collect()
    }
}

/// The plot; each point says in its title what it is.
pub(crate) fn svg(report: &Report) -> String {
    let point = |row| -> Option<Point<'_>> {
        let row: &Row = row;
        let positive = |v: Option<f64>| v.filter(|v| *v > 0.0 && v.is_finite());
        Some(Point { row, seconds: positive(row.seconds)?, error: positive(row.combined)? })
    };
    let points: Vec<Point<'_>> = report.rows.iter().filter_map(point).collect();
    let x = Axis::new(points.iter().map(|p| p.seconds), AXES[0], AXES[1]);
    let y = Axis::new(points.iter().map(|p| p.error), AXES[3], AXES[2]);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    let title = format!("{}: CPU time against error, {} seeds", report.scene, report.seeds.len());
    text(&mut svg, AXES[0], 28.0, "start", "font-size=\"15\"", &title);
    let below = "error: five observables over their scatter from seed to seed; 1 is as wrong as one packing is by chance";
    text(&mut svg, AXES[0], 46.0, "start", "fill=\"#555\"", below);
    axes(&mut svg, &x, &y);
    front_line(&mut svg, &points, &x, &y);
    // The default comes last, on top of its neighbours.
    for default in [false, true] {
        for p in points.iter().filter(|p| p.row.default == default) {
            marker(&mut svg, p, x.at(p.seconds), y.at(p.error));
        }
    }
    legend(&mut svg, &points);
    svg += "</svg>\n";
    svg
}

fn axes(svg: &mut String, x: &Axis, y: &Axis) {
    let [left, right, top, bottom] = AXES;
    for t in x.ticks() {
        let at = x.at(t);
        line(svg, [at, top, at, bottom], "#e4e4e4");
        text(svg, at, bottom + 18.0, "middle", "", &format!("{t}"));
    }
    for t in y.ticks() {
        let at = y.at(t);
        line(svg, [left, at, right, at], "#e4e4e4");
        text(svg, left - 8.0, at + 4.0, "end", "", &format!("{t}"));
    }
    line(svg, [left, bottom, right, bottom], "black");
    line(svg, [left, top, left, bottom], "black");
    text(svg, 0.5 * (left + right), bottom + 42.0, "middle", "", "CPU time of a run, s");
    let turned = format!("transform=\"rotate(-90 20 {:.1})\"", 0.5 * (top + bottom));
    text(svg, 20.0, 0.5 * (top + bottom), "middle", &turned, "combined error");
}

/// Steps along the front: between two of its points the faster one is the best there is.
fn front_line(svg: &mut String, points: &[Point<'_>], x: &Axis, y: &Axis) {
    let mut on: Vec<&Point<'_>> = points.iter().filter(|p| p.row.on_front).collect();
    on.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let Some(first) = on.first() else { return };
    let mut path = format!("M {:.1} {:.1}", x.at(first.seconds), y.at(first.error));
    for p in &on[1..] {
        let _ = write!(path, " H {:.1} V {:.1}", x.at(p.seconds), y.at(p.error));
    }
    let _ = writeln!(svg, "<path d=\"{path}\" fill=\"none\" stroke=\"#999\" stroke-width=\"1.5\"/>");
}

fn marker(svg: &mut String, p: &Point<'_>, x: f64, y: f64) {
    let row = p.row;
    let label = escaped(&format!("{} = {}", row.knob.name(), row.value));
    let title = format!("{label}: {:.2} s, error {:.2}", p.seconds, p.error);
    if row.default {
        // One star for all knobs: it is the same run.
        let corner = |k: usize| {
            let (angle, r) =
                (std::f64::consts::PI * k as f64 / 5.0, if k.is_multiple_of(2) { 11.0 } else { 4.5 });
            format!("{:.1},{:.1}", x + r * angle.sin(), y - r * angle.cos())
        };
        let corners: Vec<String> = (0..10).map(corner).collect();
        let _ = writeln!(
            svg,
            "<polygon points=\"{}\" fill=\"#e00\" stroke=\"white\"><title>default ({title})</title></polygon>",
            corners.join(" ")
        );
        return;
    }
    // Filled where an error is resolved; hollow where the point is but a bound.
    let known = row.resolved.array().contains(&Some(true));
    let colour = COLOURS[row.knob as usize % COLOURS.len()];
    let fill = if known { colour } else { "white" };
    let _ = writeln!(
        svg,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.8\"><title>{title}</title></circle>"
    );
    // Near the right edge a label goes to the left of its point, off the legend.
    let (beside, anchor) = if x < AXES[1] - 100.0 { (x + 8.0, "start") } else { (x - 8.0, "end") };
    text(
        svg,
        beside,
        y - 6.0,
        anchor,
        &format!("font-size=\"10\" fill=\"{colour}\""),
        &row.value.to_string(),
    );
}

fn legend(svg: &mut String, points: &[Point<'_>]) {
    let (x, mut y) = (AXES[1] + 30.0, AXES[2] + 10.0);
    for knob in Knob::value_variants().iter().filter(|k| points.iter().any(|p| p.row.knob == **k)) {
        let colour = COLOURS[*knob as usize % COLOURS.len()];
        let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"5\" fill=\"{colour}\"/>", y - 4.0);
        text(svg, x + 14.0, y, "start", "", &knob.name());
        y += 20.0;
    }
    let explained = [
        "red star: the default",
        "filled: an error is resolved",
        "hollow: no more than a bound",
        "grey line: Pareto front",
    ];
    for explanation in explained {
        y += 18.0;
        text(svg, x - 5.0, y, "start", "fill=\"#555\"", explanation);
    }
}

fn line(svg: &mut String, [x1, y1, x2, y2]: [f64; 4], colour: &str) {
    let _ = writeln!(
        svg,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{colour}\"/>"
    );
}

fn text(svg: &mut String, x: f64, y: f64, anchor: &str, more: &str, content: &str) {
    let content = escaped(content);
    let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" {more}>{content}</text>");
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_spans_its_values_and_a_factor_is_a_distance() {
        let axis = Axis::new([0.4, 3.0, 40.0].into_iter(), 100.0, 500.0);
        assert!(axis.at(0.4) > 100.0 && axis.at(40.0) < 500.0);
        assert!((axis.at(4.0) - axis.at(2.0) - (axis.at(20.0) - axis.at(10.0))).abs() < 1e-9);
        assert_eq!(axis.ticks(), [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0]);
    }

    #[test]
    fn every_knob_has_a_colour_of_its_own() {
        let mut colours: Vec<&str> =
            Knob::value_variants().iter().map(|k| COLOURS[*k as usize % COLOURS.len()]).collect();
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), Knob::value_variants().len());
    }

    #[test]
    fn what_is_written_into_the_svg_cannot_end_it() {
        assert_eq!(escaped("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
    }

    #[test]
    fn without_any_point_the_axes_still_have_a_range() {
        let axis = Axis::new(std::iter::empty(), 0.0, 1.0);
        assert!(axis.low < axis.high && axis.at(1.0).is_finite());
    }
}
