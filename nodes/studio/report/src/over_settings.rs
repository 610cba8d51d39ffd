//! Quantities of many runs over the settings in which they differ: means with standard errors.

use crate::run::Run;
use crate::settings::differing;
use grainlab_page::plot::{Axis, Entry, Figure, Line, Marker, Point, Series, Strip};
use grainlab_page::{Html, Mean, csv, figure, grid, html, paragraph, six_digits};
use std::collections::BTreeSet;

/// Ratio of the ends from which an axis is logarithmic.
const DECADE: f64 = 10.0;

/// Most curves: what a legend has room for.
const CURVES: usize = 20;

/// Most letters of the legend of a small plot, and those that the symbol of a curve takes.
const LEGEND: usize = 52;
const SYMBOL: usize = 5;

/// A run, and its quantities by name.
pub(crate) type Quantities<'a> = (&'a Run, Vec<(String, Option<f64>)>);

/// A figure for each quantity, over the setting with most numbers, with a curve for each value of the other one; nothing if
/// no setting differs.
pub(crate) fn figures(all: &[Quantities<'_>]) -> Option<Html> {
    let is_whole = |run: &Run| run.summary.exit == Some(0) && !run.is_incomplete() && run.last().is_some();
    let whole: Vec<&Quantities<'_>> = all.iter().filter(|(run, _)| is_whole(run)).collect();
    let mut settings = differing(&whole.iter().map(|(run, _)| *run).collect::<Vec<_>>());
    settings.sort_by_key(|s| std::cmp::Reverse(s.numbers().map_or(0, |_| s.different())));
    let is_drawn = settings.len() <= 2 && settings.get(1).is_none_or(|s| s.different() <= CURVES);
    let Some(x) = settings.first()?.numbers().filter(|_| is_drawn) else {
        let names: Vec<&str> = settings.iter().map(|s| s.name.as_str()).collect();
        return Some(paragraph(format!(
            "There are figures of runs that differ in one setting or two, of which one is a number and the other has few values. These differ in: {}.",
            names.join(", ")
        )));
    };
    let (along, by) = (&settings[0].name, settings.get(1));
    let mut places = x.clone();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let curve = |n: usize| by.map_or("", |s| s.values[n].as_str());
    let mut curves: Vec<&str> = (0..whole.len()).map(curve).collect();
    let number = |text: &str| text.parse().unwrap_or(f64::INFINITY);
    curves.sort_by(|a, b| number(a).total_cmp(&number(b)).then(a.cmp(b)));
    curves.dedup();
    let is_small = curves.iter().map(|c| c.chars().count() + SYMBOL).sum::<usize>() <= LEGEND;
    // A run that repeats another one adds nothing to a mean.
    let mut seen = BTreeSet::new();
    let is_new = |n: &usize| seen.insert((curve(*n), x[*n].to_bits(), whole[*n].0.seed()));
    let kept: Vec<usize> = (0..whole.len()).filter(is_new).collect();
    let is_log = places[0] > 0.0 && places[places.len() - 1] >= DECADE * places[0];
    let axis = if is_log { Axis::log(along) } else { Axis::linear(along) };
    let by_name = by.map_or("", |s| &s.name);
    let draw = |(q, (name, _)): (usize, &(String, Option<f64>))| {
        let (mut rows, mut series, mut legend) =
            (Vec::new(), Vec::new(), vec![Entry::Note(by_name.to_owned())]);
        for (c, of) in curves.iter().enumerate() {
            let mut points = Vec::new();
            for at in &places {
                let here = kept.iter().filter(|n| curve(**n) == *of && x[**n] == *at);
                let Some(m) = Mean::of(here.filter_map(|n| whole[*n].1[q].1)) else { continue };
                let error = m.error.map(six_digits).unwrap_or_default();
                let (mean, n) = (six_digits(m.value), m.count.to_string());
                let tooltip =
                    Some(format!("{along} {at} {by_name} {of}: {mean}, standard error {error}, n {n}"));
                points.push(Point { error: m.error, tooltip, ..Point::at(*at, m.value) });
                rows.push([at.to_string(), (*of).to_owned(), n, mean, error]);
            }
            let marker = Marker::of(c);
            let (colour, line) = (Some(c), Some(Line::Straight));
            series.push(Series { colour, marker: Some(marker), line, points, ..Series::default() });
            if by.is_some() {
                legend.push(Entry::Shape(marker, colour, false, (*of).to_owned()));
            }
        }
        let (title, x, y) = (name.clone(), axis.clone(), Axis::default());
        let drawn = Figure { title, x, y, series, legend, ..Figure::default() };
        let data = csv([along.as_str(), by_name, "n", "mean", "standard_error"], rows);
        let plot = if is_small { Strip { figure: drawn, ..Strip::default() }.svg() } else { drawn.element() };
        figure(&format!("over-settings-{}", q + 1), plot, "", &data)
    };
    let quantities = whole[0].1.iter().enumerate();
    let has_value = |(q, _): &(usize, _)| whole.iter().any(|(_, values)| values[*q].1.is_some());
    let drawn: Html = quantities.filter(has_value).map(draw).collect();
    let curves = if by.is_some() { format!(", with a curve for each {by_name}") } else { String::new() };
    let mut about = format!("Mean and standard error over seeds, over {along}{curves}.");
    if all.len() > kept.len() {
        let runs = grainlab_console::count(all.len() - kept.len(), "run");
        about += &format!(" Left out: {runs}, not complete or repeated.");
    }
    let drawn = if is_small { grid(drawn) } else { drawn };
    Some(html!("{{ about }}{{ drawn }}", about => paragraph(about), drawn))
}
