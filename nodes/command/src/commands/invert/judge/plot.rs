//! Inferred against true contact anisotropy, a colour for each model.

use crate::commands::invert::case::Case;
use grainlab_page::plot::{Axis, Entry, Figure, Line, Marker, Point, Series, Theme};

/// The plot as SVG. `points` has, for each case, the true and the inferred anisotropy of each row.
pub(super) fn svg(cases: &[Case], points: Vec<Vec<[f64; 2]>>) -> String {
    let truths = || points.iter().flatten().map(|[truth, _]| *truth);
    let ends = [truths().fold(f64::INFINITY, f64::min), truths().fold(f64::NEG_INFINITY, f64::max)];
    let rows = points.iter().map(Vec::len).max().unwrap_or(0);
    let exact = Series {
        line: Some(Line::Straight),
        points: ends.map(|e| Point::at(e, e)).into(),
        ..Series::default()
    };
    // The legend is short: a calibration is named only if a model has several.
    let name = |case: &Case| match cases.iter().filter(|w| w.model.name() == case.model.name()).count() {
        1 => case.model.name().to_owned(),
        _ => format!("{} ({})", case.model.name(), case.calibration.name()),
    };
    // A model that infers no anisotropy has no points.
    let with_points = cases.iter().zip(&points).enumerate().filter(|(_, (_, points))| !points.is_empty());
    let legend = with_points.map(|(n, (case, points))| {
        let rms = (points.iter().map(|[t, f]| (f - t).powi(2)).sum::<f64>() / points.len() as f64).sqrt();
        Entry::Colour(n, format!("{}: rms {rms:.4}", name(case)))
    });
    let legend = legend.collect();
    let drawn = points.into_iter().enumerate().map(|(n, points)| Series {
        colour: Some(n),
        marker: Some(Marker::of(n)),
        points: points.into_iter().map(|[truth, found]| Point::at(truth, found)).collect(),
        ..Series::default()
    });
    Figure {
        title: "Contact anisotropy inferred from moduli, against what was counted".into(),
        subtitle: format!(
            "{}; rms error of each model; the line is an inference without error",
            grainlab_console::count(rows, "state")
        ),
        x: Axis::linear("contact anisotropy counted"),
        y: Axis::linear("contact anisotropy inferred"),
        series: drawn.chain([exact]).collect(),
        legend,
    }
    .svg(Theme::Light)
}
