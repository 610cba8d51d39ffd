//! The Pareto front: time against error, both logarithmic.

use super::knobs::Knob;
use super::report::Report;
use super::row::Row;
use clap::ValueEnum;
use grainlab_page::plot::{Axis, Entry, Figure, Line, Marker, Point, Series};

/// The legend.
const NOTES: [&str; 4] = [
    "red star: the default",
    "filled: an error is resolved",
    "hollow: only an upper bound",
    "grey line: Pareto front",
];

/// The plot; each point has a tooltip.
pub(crate) fn figure(report: &Report) -> Figure {
    let drawn = |row: &&Row| point(row).is_some();
    let knobs: Vec<Knob> = (Knob::value_variants().iter().copied())
        .filter(|knob| report.rows.iter().filter(drawn).any(|r| r.knob == *knob))
        .collect();
    // The default is drawn last, on top of its neighbours; one star for all knobs, since it is the same run.
    let (defaults, others): (Vec<&Row>, Vec<&Row>) = report.rows.iter().partition(|r| r.default);
    let one = |row: &Row, marker: Marker| Series {
        colour: Some(row.knob as usize),
        marker: Some(marker),
        // Filled if an error is resolved; hollow if the point is only an upper bound.
        hollow: marker == Marker::Circle && !row.resolved.array().contains(&Some(true)),
        line: None,
        points: point(row).into_iter().collect(),
    };
    let mut series = vec![front(report)];
    series.extend(others.into_iter().map(|row| one(row, Marker::Circle)));
    series.extend(defaults.into_iter().map(|row| one(row, Marker::Star)));
    let colour = |knob: &Knob| Entry::Shape(Marker::Circle, Some(*knob as usize), false, knob.name());
    let notes = NOTES.map(|note| Entry::Note(note.to_owned()));
    Figure {
        title: format!("{}: CPU time against error, {} seeds", report.scene, report.seeds.len()),
        subtitle: "error: five observables over their scatter from seed to seed; 1 is the random error of one packing"
            .into(),
        x: Axis::log("CPU time of a run, s"),
        y: Axis::log("combined error"),
        series,
        legend: knobs.iter().map(colour).chain([Entry::Gap]).chain(notes).collect(),
    }
}

/// `None` without a time and an error.
fn point(row: &Row) -> Option<Point> {
    let positive = |v: Option<f64>| v.filter(|v| *v > 0.0 && v.is_finite());
    let (seconds, error) = (positive(row.seconds)?, positive(row.combined)?);
    let what = format!("{} = {}: {seconds:.2} s, error {error:.2}", row.knob.name(), row.value);
    let (tooltip, label) =
        if row.default { (format!("default ({what})"), None) } else { (what, Some(row.value.to_string())) };
    Some(Point { tooltip: Some(tooltip), label, ..Point::at(seconds, error) })
}

/// Steps along the front: between two of its points the faster one is the best available.
fn front(report: &Report) -> Series {
    let on = report.rows.iter().filter(|r| r.on_front).filter_map(point);
    let mut points: Vec<Point> = on.map(|p| Point::at(p.x, p.y)).collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    Series { line: Some(Line::Steps), points, ..Series::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_knob_has_a_colour_of_its_own() {
        assert!(Knob::value_variants().len() <= Series::COLOURS);
    }
}
