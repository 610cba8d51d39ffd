//! Time against error as SVG: a colour a method, a shape a size.

use super::args::Method;
use super::report::{Report, Row};
use crate::plot::{AXES, Axis, COLOURS, axes, begin, escaped, text};
use clap::ValueEnum;
use std::fmt::Write;

/// Errors below are rounding, and drawn here.
const ROUNDING: f64 = 1e-16;

/// Size of a marker, half its width.
const MARKER: f64 = 5.0;

struct Point<'a> {
    row: &'a Row,
    x: f64,
    y: f64,
}

/// The plot; each point says in its title what it is.
pub(super) fn svg(report: &Report) -> String {
    let drawn = |r: &'_ Row| Some((r.seconds, r.error.stiffness?.max(ROUNDING)));
    let values: Vec<(&Row, (f64, f64))> = report.rows.iter().filter_map(|r| Some((r, drawn(r)?))).collect();
    let x = Axis::horizontal(values.iter().map(|(_, v)| v.0));
    let y = Axis::vertical(values.iter().map(|(_, v)| v.1));
    let points: Vec<Point<'_>> =
        values.iter().map(|(row, v)| Point { row, x: x.at(v.0), y: y.at(v.1) }).collect();
    let mut svg = begin(
        "Stiffness of a packing: CPU time of one thread against error",
        "error: largest entry of the difference over C11, against the frozen network solved to a residual of 1e-13",
    );
    axes(&mut svg, (&x, "CPU time, s"), (&y, "error of the stiffness"));
    let sizes = sizes(report);
    for size in &sizes {
        for method in Method::value_variants() {
            let of = |p: &&Point<'_>| p.row.method == *method && key(p.row) == *size;
            path(&mut svg, *method, &points.iter().filter(of).collect::<Vec<_>>());
        }
    }
    for p in &points {
        let shape = sizes.iter().position(|s| *s == key(p.row)).unwrap_or(0);
        let r = p.row;
        let value = r.value.map_or(String::new(), |v| format!(" {v:e}"));
        let error = r.error.stiffness.unwrap_or(f64::NAN);
        let title = format!(
            "{}{value}, {} grains: {:.3e} s, error {error:.1e}",
            r.method.name(),
            r.grains,
            r.seconds
        );
        marker(&mut svg, [p.x, p.y], shape, COLOURS[r.method as usize], r.replicated, &title);
    }
    labels(&mut svg, &points, &sizes);
    legend(&mut svg, report, &sizes);
    svg += "</svg>\n";
    svg
}

/// What has a shape of its own.
fn key(row: &Row) -> (bool, usize) {
    (row.replicated, row.grains)
}

fn sizes(report: &Report) -> Vec<(bool, usize)> {
    let mut sizes: Vec<(bool, usize)> = report.rows.iter().map(key).collect();
    sizes.sort_unstable();
    sizes.dedup();
    sizes
}

/// A thin line through the values of one method on one packing.
fn path(svg: &mut String, method: Method, points: &[&Point<'_>]) {
    let corners: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
    let colour = COLOURS[method as usize];
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-opacity=\"0.35\"/>",
        corners.join(" ")
    );
}

/// Polygons of three corners and more, and a circle: one a size, hollow for copies.
fn marker(svg: &mut String, [x, y]: [f64; 2], shape: usize, colour: &str, hollow: bool, title: &str) {
    let fill = if hollow { "white" } else { colour };
    let style = format!("fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.4\"");
    let title = escaped(title);
    let (corners, turn) = [(0, 0.0), (4, 0.125), (3, 0.0), (4, 0.0), (3, 0.5), (5, 0.0), (6, 0.0)][shape % 7];
    if corners == 0 {
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{MARKER}\" {style}><title>{title}</title></circle>"
        );
        return;
    }
    let corner = |k: usize| {
        let angle = std::f64::consts::TAU * (k as f64 / f64::from(corners) + turn);
        format!("{:.1},{:.1}", x + 1.2 * MARKER * angle.sin(), y - 1.2 * MARKER * angle.cos())
    };
    let all: Vec<String> = (0..corners as usize).map(corner).collect();
    let _ = writeln!(svg, "<polygon points=\"{}\" {style}><title>{title}</title></polygon>", all.join(" "));
}

/// A rectangle: left, top, right, bottom.
type Place = [f64; 4];

fn overlap(a: &Place, b: &Place) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// The values of the smallest and the largest packing beside their points, where there is room: a label never lies on a
/// marker or on another label.
fn labels(svg: &mut String, points: &[Point<'_>], sizes: &[(bool, usize)]) {
    let around = |x: f64, y: f64, r: f64| [x - r, y - r, x + r, y + r];
    let mut taken: Vec<Place> = points.iter().map(|p| around(p.x, p.y, MARKER)).collect();
    let ends = [sizes.first(), sizes.last()];
    for p in points.iter().filter(|p| ends.contains(&Some(&key(p.row)))) {
        let Some(value) = p.row.value else { continue };
        let content = format!("{value:e}");
        let (width, height) = (6.0 * content.len() as f64, 10.0);
        let beside = |dx: f64, dy: f64| {
            let (left, bottom) = (p.x + dx - if dx < 0.0 { width } else { 0.0 }, p.y + dy);
            [left, bottom - height, left + width, bottom]
        };
        let candidates = [(8.0, 3.5), (-8.0, 3.5), (6.0, -6.0), (-6.0, -6.0), (6.0, 15.0), (-6.0, 15.0)];
        let fits = |place: &Place| {
            let [left, right, top, bottom] = AXES;
            let inside = place[0] > left && place[2] < right + 20.0 && place[1] > top && place[3] < bottom;
            inside && !taken.iter().any(|t| overlap(t, place))
        };
        if let Some(place) = candidates.map(|(dx, dy)| beside(dx, dy)).into_iter().find(fits) {
            let more = format!("font-size=\"10\" fill=\"{}\"", COLOURS[p.row.method as usize]);
            text(svg, place[0], place[3] - 1.0, "start", &more, &content);
            taken.push(place);
        }
    }
}

fn legend(svg: &mut String, report: &Report, sizes: &[(bool, usize)]) {
    let (x, mut y) = (AXES[1] + 36.0, AXES[2] + 10.0);
    for method in Method::value_variants().iter().filter(|m| report.rows.iter().any(|r| r.method == **m)) {
        let colour = COLOURS[*method as usize];
        let _ = writeln!(
            svg,
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{colour}\" stroke-width=\"3\"/>",
            x - 6.0,
            y - 4.0,
            x + 8.0,
            y - 4.0
        );
        text(svg, x + 14.0, y, "start", "", method.explained());
        y += 20.0;
    }
    y += 10.0;
    for (shape, (replicated, grains)) in sizes.iter().enumerate() {
        marker(svg, [x, y - 4.0], shape, "#555", *replicated, "");
        let copies = if *replicated { " (copies)" } else { "" };
        text(svg, x + 14.0, y, "start", "", &format!("{grains} grains{copies}"));
        y += 20.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stiffness::report::{Error, report};

    #[test]
    fn an_error_of_nothing_is_drawn_at_rounding_and_labels_keep_clear_of_each_other() {
        let row = |seconds: f64, error: f64| Row {
            method: Method::Cg,
            value: Some(1e-8),
            grains: 500,
            replicated: false,
            coordination: 5.0,
            seconds,
            iterations: Some(1),
            error: Error { stiffness: Some(error), against: "" },
            failure: None,
        };
        let crowd =
            report((0..40).map(|k| row(1.0 + 1e-3 * f64::from(k), 1e-3)).chain([row(9.0, 0.0)]).collect());
        let picture = svg(&crowd);
        assert!(!picture.contains("NaN") && !picture.contains("inf"), "{picture}");
        let shown = picture.matches(">1e-8<").count();
        assert!((1..10).contains(&shown), "{shown} labels on 41 points, 40 of them in a heap");
    }

    #[test]
    fn places_overlap_where_they_share_an_area() {
        assert!(overlap(&[0.0, 0.0, 2.0, 2.0], &[1.0, 1.0, 3.0, 3.0]));
        assert!(!overlap(&[0.0, 0.0, 2.0, 2.0], &[2.0, 0.0, 3.0, 2.0]));
    }
}
