//! The Pareto front as SVG: time against error, both logarithmic.

use super::knobs::Knob;
use super::report::Report;
use super::row::Row;
use crate::plot::{AXES, Axis, COLOURS, axes, begin, escaped, text};
use clap::ValueEnum;
use std::fmt::Write;

/// A point that can be drawn: a logarithm needs positive numbers.
struct Point<'a> {
    row: &'a Row,
    seconds: f64,
    error: f64,
}

/// The plot; each point says in its title what it is.
pub(crate) fn svg(report: &Report) -> String {
    let point = |row| -> Option<Point<'_>> {
        let row: &Row = row;
        let positive = |v: Option<f64>| v.filter(|v| *v > 0.0 && v.is_finite());
        Some(Point { row, seconds: positive(row.seconds)?, error: positive(row.combined)? })
    };
    let points: Vec<Point<'_>> = report.rows.iter().filter_map(point).collect();
    let x = Axis::horizontal(points.iter().map(|p| p.seconds));
    let y = Axis::vertical(points.iter().map(|p| p.error));
    let mut svg = begin(
        &format!("{}: CPU time against error, {} seeds", report.scene, report.seeds.len()),
        "error: five observables over their scatter from seed to seed; 1 is as wrong as one packing is by chance",
    );
    axes(&mut svg, (&x, "CPU time of a run, s"), (&y, "combined error"));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_knob_has_a_colour_of_its_own() {
        let mut colours: Vec<&str> =
            Knob::value_variants().iter().map(|k| COLOURS[*k as usize % COLOURS.len()]).collect();
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), Knob::value_variants().len());
    }
}
