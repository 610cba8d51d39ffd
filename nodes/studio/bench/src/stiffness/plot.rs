//! Time against error: a colour for each method, a shape for each size.

use super::args::Method;
use super::report::{Report, Row};
use clap::ValueEnum;
use grainlab_page::plot::{Axis, Entry, Figure, Line, Marker, Point, Series};

/// Smaller errors are rounding, and drawn at this value.
const ROUNDING: f64 = 1e-16;

/// The plot; each point has a tooltip.
pub(super) fn figure(report: &Report) -> Figure {
    let sizes = sizes(report);
    let series = |size: &(bool, usize), method: &Method| {
        let rows = report.rows.iter().filter(|r| r.method == *method && key(r) == *size);
        // The values of the smallest and the largest packing are labelled.
        let labelled = [sizes.first(), sizes.last()].contains(&Some(size));
        Series {
            colour: Some(*method as usize),
            marker: Some(marker(&sizes, *size)),
            hollow: size.0,
            line: Some(Line::Faint),
            points: rows.filter_map(|row| point(row, labelled)).collect(),
        }
    };
    let methods = Method::value_variants();
    Figure {
        title: "Stiffness of a packing: CPU time of one thread against error".into(),
        subtitle: "error: largest entry of the difference over C11, against the frozen network solved to a residual of 1e-13"
            .into(),
        x: Axis::log("CPU time, s"),
        y: Axis::log("error of the stiffness"),
        series: sizes.iter().flat_map(|size| methods.iter().map(move |method| series(size, method))).collect(),
        legend: legend(report, &sizes),
    }
}

fn point(row: &Row, labelled: bool) -> Option<Point> {
    let error = row.error.stiffness?;
    let value = row.value.map(|v| format!("{v:e}"));
    let tooltip = format!(
        "{} {}, {} grains: {:.3e} s, error {error:.1e}",
        row.method.name(),
        value.as_deref().unwrap_or(""),
        row.grains,
        row.seconds
    );
    let label = value.filter(|_| labelled);
    Some(Point { tooltip: Some(tooltip), label, ..Point::at(row.seconds, error.max(ROUNDING)) })
}

/// Points with the same shape.
fn key(row: &Row) -> (bool, usize) {
    (row.replicated, row.grains)
}

fn sizes(report: &Report) -> Vec<(bool, usize)> {
    let mut sizes: Vec<(bool, usize)> = report.rows.iter().map(key).collect();
    sizes.sort_unstable();
    sizes.dedup();
    sizes
}

fn marker(sizes: &[(bool, usize)], size: (bool, usize)) -> Marker {
    Marker::of(sizes.iter().position(|s| *s == size).unwrap_or(0))
}

fn legend(report: &Report, sizes: &[(bool, usize)]) -> Vec<Entry> {
    let methods = Method::value_variants().iter().filter(|m| report.rows.iter().any(|r| r.method == **m));
    let methods = methods.map(|m| Entry::Colour(*m as usize, m.explained().to_owned()));
    let shapes = sizes.iter().map(|size| {
        let (replicated, grains) = *size;
        let copies = if replicated { " (copies)" } else { "" };
        Entry::Shape(marker(sizes, *size), None, replicated, format!("{grains} grains{copies}"))
    });
    methods.chain([Entry::Gap]).chain(shapes).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stiffness::report::{Error, report};
    use grainlab_page::plot::Theme;

    #[test]
    fn an_error_of_nothing_is_drawn_at_rounding() {
        let row = Row {
            method: Method::Cg,
            value: Some(1e-8),
            grains: 500,
            replicated: false,
            coordination: 5.0,
            seconds: 9.0,
            iterations: Some(1),
            error: Error { stiffness: Some(0.0), against: "" },
            failure: None,
        };
        let picture = figure(&report(vec![row])).svg(Theme::Light);
        assert!(
            picture.contains("<circle") && !picture.contains("NaN") && !picture.contains("inf"),
            "{picture}"
        );
    }
}
