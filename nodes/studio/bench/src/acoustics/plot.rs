//! Time against error: a colour for each method; hollow points are stated errors.

use super::args::Method;
use super::report::{Report, Row};
use clap::ValueEnum;
use grainlab_page::plot::{Axis, Entry, Figure, Marker, Point, Series};

/// The plot; each point has a tooltip.
pub(super) fn figure(report: &Report) -> Figure {
    let methods: Vec<Method> = (Method::value_variants().iter().copied())
        .filter(|m| report.rows.iter().any(|r| r.method == *m && errors(r).is_some()))
        .collect();
    let series = |method: &Method, stated: bool| {
        let rows = report.rows.iter().filter(|r| r.method == *method);
        Series {
            colour: Some(*method as usize),
            marker: Some(Marker::Circle),
            hollow: stated,
            line: None,
            points: rows.filter_map(|row| point(row, stated)).collect(),
        }
    };
    Figure {
        title: "Wave speeds of a packing: CPU time against error".into(),
        subtitle:
            "error of rho v^2 against the frozen network: found, root mean square (full), and stated (hollow)"
                .into(),
        x: Axis::log("CPU time of all speeds, s"),
        y: Axis::log("relative error of rho v^2"),
        series: methods.iter().flat_map(|m| [true, false].map(|stated| series(m, stated))).collect(),
        legend: (methods.iter())
            .map(|m| Entry::Shape(Marker::Circle, Some(*m as usize), false, m.name().to_owned()))
            .collect(),
    }
}

/// Found and stated error, if both are known.
fn errors(row: &Row) -> Option<(f64, f64)> {
    Some((row.error.rms?, row.error.stated?))
}

fn point(row: &Row, stated: bool) -> Option<Point> {
    let (rms, of_method) = errors(row)?;
    let (what, error) = if stated { ("stated", of_method) } else { ("found", rms) };
    let value = row.value.map_or(String::new(), |v| format!(" {v:e}"));
    let tooltip = format!(
        "{}{value}, {} speeds: {:.2} s, {what} {error:.1e}",
        row.method.name(),
        row.speeds,
        row.seconds
    );
    Some(Point { tooltip: Some(tooltip), ..Point::at(row.seconds, error) })
}
