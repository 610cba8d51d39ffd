//! Time against error: a colour for each family, a shape for each of its methods.

use super::report::{Report, time};
use super::row::{Family, Row};
use grainlab_page::plot::{Axis, Entry, Figure, Line, Marker, Point, Series};

/// Smaller errors are rounding, and drawn at this value.
const ROUNDING: f64 = 1e-15;

/// The plot; each point has a tooltip.
pub(super) fn figure(report: &Report) -> Figure {
    let families: Vec<Family> =
        Family::ALL.into_iter().filter(|f| report.rows.iter().any(|r| r.family == *f)).collect();
    Figure {
        title: "Every method: CPU time against error".into(),
        subtitle: "each colour is an error of another quantity; hollow: only an upper bound".into(),
        x: Axis::log("CPU time, s"),
        y: Axis::log("error"),
        series: families.iter().flat_map(|family| series(report, *family)).collect(),
        legend: families.iter().flat_map(|family| entries(*family)).collect(),
    }
}

fn series(report: &Report, family: Family) -> Vec<Series> {
    let rows: Vec<&Row> = report.rows.iter().filter(|r| r.family == family).collect();
    let mut methods: Vec<&str> = rows.iter().map(|r| r.method.as_str()).collect();
    methods.dedup();
    let of = |(n, method): (usize, &&str)| {
        let rows: Vec<&&Row> = rows.iter().filter(|r| r.method == **method).collect();
        let points = rows.iter().enumerate().map(|(k, row)| point(row, k == 0, rows.len()));
        Series {
            colour: Some(family as usize),
            marker: Some(Marker::of(n)),
            hollow: rows.iter().all(|r| r.upper_bound),
            line: Some(Line::Faint),
            points: points.collect(),
        }
    };
    methods.iter().enumerate().map(of).collect()
}

/// The first point of a method has its name, the others have only their settings.
fn point(row: &Row, first: bool, points: usize) -> Point {
    let setting = row.setting.split(' ').next().unwrap_or_default();
    let label = match (first, points) {
        (true, 1) => row.method.clone(),
        (true, _) => format!("{} {setting}", row.method),
        (false, _) => setting.to_owned(),
    };
    let bound = if row.upper_bound { "below " } else { "" };
    let tooltip = format!(
        "{}: {} {}: {}, error {bound}{:.1e}",
        row.family.name(),
        row.method,
        row.setting,
        time(row.seconds),
        row.error
    );
    Point { tooltip: Some(tooltip), label: Some(label), ..Point::at(row.seconds, row.error.max(ROUNDING)) }
}

/// The family, and below it what its time and its error are.
fn entries(family: Family) -> Vec<Entry> {
    let notes: [&str; 2] = match family {
        Family::InversionEps => ["one state", "rms of eps, 384 packings"],
        Family::InversionZ => ["one state", "rms of z, 384 packings"],
        Family::Stiffness => ["21 constants, 2,000 grains", "largest entry over C11"],
        Family::EngineEnergy => ["200 grains to 50 kPa", "energy created by steps"],
        Family::EnginePacking => ["200 grains to 50 kPa", "in seed-to-seed scatters"],
        Family::Waves => ["9 speeds, 500 grains", "rms of rho v^2"],
    };
    let notes = notes.map(|note| Entry::Note(format!("  {note}")));
    [Entry::Colour(family as usize, family.name().to_owned())]
        .into_iter()
        .chain(notes)
        .chain([Entry::Gap])
        .collect()
}
