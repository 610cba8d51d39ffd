//! Time against error: a colour for each family, or for each method of a single one, and a shape for each series of it.

use crate::row::{Family, Row, families};
use grainlab_page::plot::{Axis, Entry, Figure, Line, Marker, Point, Series};

/// Smaller errors are rounding, and drawn at this value.
const ROUNDING: f64 = 1e-16;

/// The plot; each point has a tooltip.
pub(crate) fn figure(rows: &[Row]) -> Figure {
    let families: Vec<Family> = families(rows).into_iter().collect();
    let mut methods: Vec<&str> = Vec::new();
    rows.iter().for_each(|r| {
        if !methods.contains(&r.method.as_str()) {
            methods.push(&r.method)
        }
    });
    let colour = |row: &Row| match families[..] {
        [_] => methods.iter().position(|m| *m == row.method).unwrap_or(0),
        _ => row.family as usize,
    };
    let mut keys: Vec<(Family, &str, Option<usize>)> = Vec::new();
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        let key = (row.family, row.method.as_str(), row.grains);
        let at = keys.iter().position(|k| *k == key).unwrap_or_else(|| {
            let of_colour = series.iter().filter(|s| s.colour == Some(colour(row))).count();
            keys.push(key);
            series.push(Series {
                name: String::new(),
                colour: Some(colour(row)),
                marker: Some(Marker::of(of_colour)),
                hollow: row.upper_bound,
                line: Some(Line::Faint),
                points: Vec::new(),
            });
            series.len() - 1
        });
        series[at].hollow &= row.upper_bound;
        let first = series[at].points.is_empty();
        series[at].points.extend(point(row, first));
    }
    let legend = match families[..] {
        [_] => methods.iter().enumerate().map(|(n, m)| Entry::Colour(n, (*m).to_owned())).collect(),
        _ => families.iter().flat_map(|family| entries(*family)).collect(),
    };
    Figure {
        title: "CPU time against error".into(),
        subtitle: match families[..] {
            [family] => family.words()[2].into(),
            _ => "each colour is an error of another quantity; hollow: only an upper bound".into(),
        },
        x: Axis::log("CPU time, s"),
        y: Axis::log("error"),
        series,
        legend,
    }
}

/// The first point of a series has its name, the others have only their settings.
fn point(row: &Row, first: bool) -> Option<Point> {
    let (seconds, error) = row.point()?;
    let setting = row.setting.split(' ').next().unwrap_or_default();
    let label = if first { format!("{} {setting}", row.method) } else { setting.to_owned() };
    let bound = if row.upper_bound { "below " } else { "" };
    let grains = row.grains.map_or_else(String::new, |n| format!(", {n} grains"));
    let (family, method, setting) = (row.family.name(), &row.method, &row.setting);
    let tooltip =
        format!("{family}: {method} {setting}{grains}: {}, error {bound}{error:.1e}", time(seconds));
    let label = Some(label.trim_end().to_owned());
    Some(Point { tooltip: Some(tooltip), label, ..Point::at(seconds, error.max(ROUNDING)) })
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

/// Two digits and a unit.
pub(crate) fn time(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-3 => (1e6 * s, "us"),
        s if s < 1.0 => (1e3 * s, "ms"),
        s => (s, "s"),
    };
    let digits = usize::from(value < 10.0);
    format!("{value:.digits$} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_page::plot::Theme;

    #[test]
    fn times_have_the_unit_that_leaves_few_digits() {
        assert_eq!(
            [1.23e-6, 4.56e-5, 0.0123, 1.66, 131.7].map(time),
            ["1.2 us", "46 us", "12 ms", "1.7 s", "132 s"]
        );
    }

    #[test]
    fn an_error_of_nothing_is_drawn_at_rounding() {
        let row = Row::new(Family::Stiffness, ("cg", "1e-8"), (9.0, 1), (Some(0.0), ""));
        let picture = figure(&[row]).svg(Theme::Light);
        assert!(
            picture.contains("<circle") && !picture.contains("NaN") && !picture.contains("inf"),
            "{picture}"
        );
    }
}
