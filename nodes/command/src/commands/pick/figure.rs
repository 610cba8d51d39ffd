//! A record with what was picked in it.

use super::list::Row;
use grainlab_acoustics::record::{Picks, Record};
use grainlab_console::{Failure, write_whole};
use grainlab_page::plot::{Axis, Entry, Figure, Line, Point, Series, Theme};
use std::path::Path;

/// Periods before and after the arrival that are shown.
const BEFORE: f64 = 8.0;
const AFTER: f64 = 4.0;

/// Draws a record into a folder, which is made.
pub(super) fn drawn(folder: &Path, row: &Row, record: &Record, picked: &Picks) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(Failure::at(folder))?;
    let stem = Path::new(&row.file).with_extension("").to_string_lossy().replace(['/', '\\'], "-");
    let wave: String = row.wave.iter().map(|word| format!("-{word}")).collect();
    let path = folder.join(format!("{:03}-{stem}{wave}.svg", row.line));
    write_whole(&path, figure(row, record, picked).svg(Theme::Light))
}

fn figure(row: &Row, record: &Record, picked: &Picks) -> Figure {
    let offset = record.source[record.quiet.clone()].iter().sum::<f64>() / record.quiet.len() as f64;
    let largest = record.source.iter().fold(0.0, |most: f64, s| most.max((s - offset).abs()));
    let start = record.source.iter().position(|s| (s - offset).abs() > 0.02 * largest).unwrap_or(0) as f64;
    // The arrival, and the source where the path is not many wavelengths long.
    let best = picked.picks[picked.recommended];
    let (period, arrival) = (1e6 / picked.frequency, 1e6 * (best.time + row.passage.delay));
    let window = (arrival - BEFORE * period).max(-period)..arrival + AFTER * period;
    let line = |colour: Option<usize>, rate: f64, values: &mut dyn Iterator<Item = f64>, up: f64| Series {
        colour,
        line: Some(Line::Straight),
        points: values
            .enumerate()
            .map(|(k, v)| {
                Point::at(1e6 * (k as f64 / rate - start / record.sample_rate), v.clamp(-2.0, 2.0) + up)
            })
            .filter(|point| window.contains(&point.x))
            .collect(),
        ..Series::default()
    };
    let source =
        line(None, record.sample_rate, &mut record.source.iter().map(|s| (s - offset) / largest), 1.2);
    let receiver = line(Some(0), picked.sample_rate, &mut picked.receiver.iter().copied(), -1.2);
    let mark = |(k, p): (usize, &grainlab_acoustics::record::Pick)| Series {
        colour: Some(k + 1),
        line: Some(Line::Straight),
        points: {
            let (at, low) = (p.time + row.passage.delay, -2.4 - 0.2 * k as f64);
            let wide = 1.96 * p.time_stddev;
            let corners = [(at, 0.0), (at, low), (at - wide, low), (at + wide, low)];
            corners.map(|(time, y)| Point::at(1e6 * time, y)).into()
        },
        ..Series::default()
    };
    let entries = |(k, p): (usize, &grainlab_acoustics::record::Pick)| {
        let star = if k == picked.recommended { " *" } else { "" };
        let speed = Entry::Note(format!("{:.1} +- {:.1} m/s{star}", p.speed, p.speed_stddev));
        [Entry::Colour(k + 1, p.method.word().into()), speed]
    };
    Figure {
        title: format!("{}: {:.1} +- {:.1} m/s by {}", row.name, best.speed, best.speed_stddev, best.method.word()),
        subtitle: "source above, receiver below (no offset, no crosstalk, sign of the source); lines: long waves by each pick, 95 %; *: least error".into(),
        x: Axis::linear("time after the start of the source, µs"),
        y: Axis::linear("signal over the largest of the source, of the arrival"),
        series: [source, receiver].into_iter().chain(picked.picks.iter().enumerate().map(mark)).collect(),
        legend: picked.picks.iter().enumerate().flat_map(entries).collect(),
    }
}
