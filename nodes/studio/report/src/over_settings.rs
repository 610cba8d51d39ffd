//! Quantities of many runs over the settings in which they differ: means with standard errors.

use crate::run::Run;
use crate::settings::{Setting, differing};
use grainlab_core::results::{InferredQuantity, QUANTITIES};
use grainlab_page::plot::{Axis, Figure, Line, Marker, Point, Series};
use grainlab_page::{Html, Mean, csv, figure, grid, paragraph, six_digits, slug};
use std::collections::BTreeSet;

/// Ratio of the ends from which an axis is logarithmic.
const DECADE: f64 = 10.0;

/// Most curves: what a legend has room for.
const CURVES: usize = 20;

/// Relative difference up to which values count as equal.
const ALIKE: f64 = 1e-3;

/// A run, and its quantities by name.
pub(crate) type Quantities<'a> = (&'a Run, Vec<(String, Option<f64>)>);

/// Runs over the setting with most numbers, with a curve for each value of the other one.
pub(crate) struct OverSettings<'a> {
    along: Setting,
    by: Option<Setting>,
    /// The complete runs, with their quantities.
    whole: Vec<&'a Quantities<'a>>,
    /// Value of the setting of each of them.
    x: Vec<f64>,
    /// Those that do not repeat another one, which would add nothing to a mean.
    kept: Vec<usize>,
    places: Vec<f64>,
    curves: Vec<String>,
    /// Number of runs that are left out.
    left_out: usize,
}

impl<'a> OverSettings<'a> {
    /// The runs, if they differ in one setting or two, of which one is a number and the other has few values.
    pub(crate) fn of(all: &'a [Quantities<'a>]) -> Option<Self> {
        let is_whole =
            |run: &Run| run.summary.exit == Some(0) && !run.is_incomplete() && run.last().is_some();
        let whole: Vec<&Quantities<'_>> = all.iter().filter(|(run, _)| is_whole(run)).collect();
        let mut settings = differing(&whole.iter().map(|(run, _)| *run).collect::<Vec<_>>());
        settings.sort_by_key(|s| std::cmp::Reverse(s.numbers().map_or(0, |_| s.different())));
        let is_drawn = settings.len() <= 2 && settings.get(1).is_none_or(|s| s.different() <= CURVES);
        let x = settings.first()?.numbers().filter(|_| is_drawn)?;
        let mut settings = settings.into_iter();
        let (along, by) = (settings.next()?, settings.next());
        let mut places = x.clone();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let curve = |n: usize| by.as_ref().map_or("", |s| s.values[n].as_str());
        let mut curves: Vec<String> = (0..whole.len()).map(|n| curve(n).to_owned()).collect();
        let number = |text: &str| text.parse().unwrap_or(f64::INFINITY);
        curves.sort_by(|a, b| number(a).total_cmp(&number(b)).then(a.cmp(b)));
        curves.dedup();
        let mut seen = BTreeSet::new();
        let is_new = |n: &usize| seen.insert((curve(*n), x[*n].to_bits(), whole[*n].0.seed()));
        let kept: Vec<usize> = (0..whole.len()).filter(is_new).collect();
        let left_out = all.len() - kept.len();
        Some(Self { along, by, whole, x, kept, places, curves, left_out })
    }

    /// True if runs differ in the seed alone, so that there is something to average.
    fn has_seeds(&self) -> bool {
        let place = |n: &usize| (self.by.as_ref().map_or("", |s| &s.values[*n]), self.x[*n].to_bits());
        self.kept.iter().map(place).collect::<BTreeSet<_>>().len() < self.kept.len()
    }

    /// Means of a quantity over seeds along a curve.
    fn means(&self, quantity: usize, curve: &str) -> Vec<(f64, Mean)> {
        let of_curve = |n: &&usize| self.by.as_ref().map_or("", |s| &s.values[**n]) == curve;
        let values = |at: f64| {
            let here = self.kept.iter().filter(of_curve).filter(move |n| self.x[**n] == at);
            here.filter_map(|n| self.whole[*n].1[quantity].1)
        };
        self.places.iter().filter_map(|at| Some((*at, Mean::of(values(*at))?))).collect()
    }

    /// A figure for each quantity: means with standard errors.
    pub(crate) fn figures(&self) -> Html {
        let (along, by) = (self.along.header(), self.by.as_ref().map_or_else(String::new, Setting::header));
        let is_log = self.places[0] > 0.0 && self.places[self.places.len() - 1] >= DECADE * self.places[0];
        let axis = if is_log { Axis::log(&along) } else { Axis::linear(&along) };
        let draw = |(q, (name, _)): (usize, &(String, Option<f64>))| {
            let (mut rows, mut series) = (Vec::new(), Vec::new());
            for (c, of) in self.curves.iter().enumerate() {
                let means = self.means(q, of);
                let points = means.iter().map(|(at, m)| {
                    let error = m.error.map(six_digits).unwrap_or_default();
                    let (mean, n) = (six_digits(m.value), m.count.to_string());
                    let tooltip = format!("{along} {at} {by} {of}: {mean}, standard error {error}, n {n}");
                    rows.push([at.to_string(), of.clone(), n, mean, error]);
                    Point { error: m.error, tooltip: Some(tooltip), ..Point::at(*at, m.value) }
                });
                let points = points.collect();
                let (colour, marker, line) = (Some(c), Some(Marker::of(c)), Some(Line::Straight));
                series.push(Series { name: of.clone(), colour, marker, line, points, ..Series::default() });
            }
            let (title, x) = (titled(name), axis.clone());
            let drawn = Figure { title, x, series, ..Figure::default() };
            let data = match by.as_str() {
                "" => csv(
                    [along.as_str(), "n", "mean", "standard_error"],
                    rows.into_iter().map(|[at, _, n, m, e]| [at, n, m, e]),
                ),
                by => csv([along.as_str(), by, "n", "mean", "standard_error"], rows),
            };
            figure(&format!("over-{}-{}", slug(&self.along.name), file(name)), drawn.element(), "", &data)
        };
        // Equal values, such as those of a target, need no figure.
        let has_value = |(q, _): &(usize, _)| {
            let of_runs = self.whole.iter().filter_map(|(_, values)| values[*q].1);
            let ends = of_runs.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
            ends[1] - ends[0] > ALIKE * ends[1].abs()
        };
        let drawn: Html = self.whole[0].1.iter().enumerate().filter(has_value).map(draw).collect();
        let curves = if by.is_empty() { String::new() } else { format!(", with a curve for each {by}") };
        let mut about = match self.has_seeds() {
            true => format!("Points: means over seeds; bars: their standard errors{curves}."),
            false => format!("Points: single runs{curves}."),
        };
        if self.left_out > 0 {
            let runs = grainlab_console::count(self.left_out, "run");
            about += &format!(" Left out: {runs}, not complete or repeated.");
        }
        paragraph(about) + grid(drawn)
    }
}

/// Name of a quantity with its meaning, where its symbol is all that a column has.
fn titled(name: &str) -> String {
    let mut inferred = InferredQuantity::countable().map(|q| (q.symbol(), q.meaning()));
    let known = inferred.find(|(symbol, _)| *symbol == name);
    let known = known.or_else(|| QUANTITIES.iter().map(|q| (q.symbol, q.meaning)).find(|q| q.0 == name));
    known.map_or_else(|| name.to_owned(), |(_, meaning)| format!("{name}: {meaning}"))
}

/// Part of the name of a file for a quantity, without its unit.
fn file(name: &str) -> String {
    slug(name.split(", ").next().unwrap_or(name))
}
