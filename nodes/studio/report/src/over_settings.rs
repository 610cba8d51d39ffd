//! Quantities of many runs over the settings in which they differ: means with standard errors.

use crate::run::Run;
use crate::settings::{Setting, differing};
use grainlab_core::results::{InferredQuantity, QUANTITIES};
use grainlab_page::plot::{Axis, Figure, Line, Marker, Point, Series};
use grainlab_page::{Html, Mean, csv, figure, fixed, grid, paragraph, plus_minus, six_digits, slug};
use std::collections::{BTreeMap, BTreeSet};

/// Ratio of the ends from which an axis is logarithmic.
const DECADE: f64 = 10.0;

/// Most curves: what a legend has room for.
const CURVES: usize = 20;

/// Relative difference up to which values count as equal.
const ALIKE: f64 = 1e-3;

/// Standard errors between means above which it is said that they are far apart, though a test cannot tell.
const MUCH: f64 = 3.0;

/// Most curves that are described in sentences.
const DESCRIBED: usize = 3;

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
    left_out: usize,
}

impl<'a> OverSettings<'a> {
    /// The runs, if they differ in one setting or two, of which one is a number and the other has few values.
    pub(crate) fn of(all: &'a [Quantities<'a>]) -> Option<Self> {
        let is_whole = |run: &Run| run.is_complete() && run.last().is_some();
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

    /// Seed and value of a quantity of each run of a curve at a value of the setting.
    fn values(&self, quantity: usize, curve: &str, at: f64) -> impl Iterator<Item = (Option<u64>, f64)> {
        let of_curve = move |n: &&usize| self.by.as_ref().map_or("", |s| &s.values[**n]) == curve;
        let here = self.kept.iter().filter(of_curve).filter(move |n| self.x[**n] == at);
        here.filter_map(move |n| Some((self.whole[*n].0.seed(), self.whole[*n].1[quantity].1?)))
    }

    fn means(&self, quantity: usize, curve: &str) -> Vec<(f64, Mean)> {
        let mean =
            |at: &f64| Some((*at, Mean::of(self.values(quantity, curve, *at).map(|(_, value)| value))?));
        self.places.iter().filter_map(mean).collect()
    }

    /// Mean difference of a quantity between two values of the setting, of the same seeds; `None` where both have others.
    fn paired(&self, quantity: usize, curve: &str, ends: [f64; 2]) -> Option<Mean> {
        let [from, to] = ends.map(|at| self.values(quantity, curve, at).collect::<BTreeMap<_, _>>());
        from.keys().eq(to.keys()).then(|| Mean::of(to.iter().map(|(seed, value)| value - from[seed])))?
    }

    /// The change of a quantity between the ends of the setting, in a sentence for each curve.
    pub(crate) fn sentences(&self, symbol: &str) -> Vec<String> {
        let Some(quantity) = self.whole[0].1.iter().position(|(name, _)| name == symbol) else {
            return Vec::new();
        };
        let sentence = |curve: &String| {
            let means = self.means(quantity, curve);
            let [from, .., to] = means.as_slice() else { return None };
            let of = match &self.by {
                Some(by) => format!("For {} {}, the counted {symbol}", by.name, by.of(curve)),
                None => format!("The counted {symbol}"),
            };
            let mut text =
                change(&of, &self.along, [*from, *to], self.paired(quantity, curve, [from.0, to.0]));
            if let Some((at, between)) = beyond(&means) {
                text.truncate(text.trim_end_matches('.').len());
                text +=
                    &format!("; between them it is {} at {}.", six_digits(between.value), self.along.of(at));
            }
            Some(text)
        };
        self.curves.iter().take(DESCRIBED).filter_map(sentence).collect()
    }

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

/// The mean that is farthest outside of those at both ends, if its error tells it from them.
fn beyond(means: &[(f64, Mean)]) -> Option<(f64, Mean)> {
    let [(_, from), between @ .., (_, to)] = means else { return None };
    let outside = |m: &Mean| (m.value - from.value.max(to.value)).max(from.value.min(to.value) - m.value);
    let far = between.iter().filter(|(_, m)| m.error.is_some_and(|e| outside(m) > MUCH * e));
    far.max_by(|a, b| outside(&a.1).total_cmp(&outside(&b.1))).copied()
}

/// The change of a mean between two values of a setting, with that of the same seeds, if both have the same.
fn change(of: &str, along: &Setting, [(from, a), (to, b)]: [(f64, Mean); 2], paired: Option<Mean>) -> String {
    let value = |m: &Mean| {
        let digits = digits(m.error.unwrap_or(0.1 * m.value));
        fixed(m.value, digits) + &plus_minus(m.error, digits)
    };
    let first = format!("{} at {} {}", value(&a), along.name, along.of(from));
    let second = format!("{} at {}", value(&b), along.of(to));
    let paired = paired.filter(|d| d.error.is_some());
    let of_means = (a.differs_from(&b), a.standard_errors_from(&b));
    let (differs, apart) = paired.map_or(of_means, |d| {
        let none = Mean { value: 0.0, error: Some(0.0), count: d.count };
        (d.half_width().map(|half| d.value.abs() > half), d.standard_errors_from(&none))
    });
    let by = |d: &Mean| format!(", by {} for the same seeds", value(&Mean { value: d.value.abs(), ..*d }));
    let second = second + &paired.as_ref().filter(|_| differs == Some(true)).map_or_else(String::new, by);
    match (differs, apart.filter(|apart| *apart > MUCH)) {
        (None, _) => {
            let single = if a.count == b.count { "each" } else { "one of them" };
            format!("{of} is {first} and {second}, with a single run at {single}: the scatter is not known.")
        }
        (Some(true), _) if b.value > a.value => format!("{of} rises from {first} to {second}."),
        (Some(true), _) => format!("{of} falls from {first} to {second}."),
        (Some(false), Some(apart)) => format!(
            "{of} is {first} and {second}: {apart:.0} standard errors apart, but {} and {} runs are too few to exclude chance.",
            a.count, b.count
        ),
        (Some(false), None) => {
            format!("{of} is not shown to change: it is {first} and {second}.")
        }
    }
}

/// A figure for each quantity: a point for each run, over its number in the table.
pub(crate) fn strips(all: &[Quantities<'_>]) -> Html {
    let draw = |(q, (name, _)): (usize, &(String, Option<f64>))| {
        let values =
            || all.iter().enumerate().filter_map(|(n, (run, values))| Some((n + 1, run, values[q].1?)));
        let points = values().map(|(n, run, value)| Point {
            tooltip: Some(format!("{n} {}: {}", run.name(), six_digits(value))),
            ..Point::at(n as f64, value)
        });
        let series = vec![Series {
            colour: Some(0),
            marker: Some(Marker::Circle),
            points: points.collect(),
            ..Series::default()
        }];
        let drawn = Figure {
            title: titled(name),
            x: Axis::linear("number of the run in the table"),
            series,
            ..Figure::default()
        };
        let rows = values().map(|(n, run, value)| [n.to_string(), run.name(), six_digits(value)]);
        let data = csv(["no", "run", "value"], rows);
        (values().next().is_some())
            .then(|| figure(&format!("by-run-{}", file(name)), drawn.element(), "", &data))
    };
    grid(all[0].1.iter().enumerate().filter_map(draw).collect())
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

/// Decimal places that give a standard error two digits.
fn digits(error: f64) -> usize {
    if error == 0.0 { 3 } else { (1.0 - error.abs().log10().floor()).clamp(0.0, 6.0) as usize }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_said_if_runs_show_it_and_too_few_runs_are_said_to_be_too_few() {
        let mean = |values: &[f64]| Mean::of(values.iter().copied()).unwrap();
        let of = |name: &str, unit| Setting { name: name.into(), unit, ..Setting::default() };
        let friction = of("friction", "");
        let said = |a: &[f64], b: &[f64]| change("z", &friction, [(0.1, mean(a)), (0.4, mean(b))], None);
        let many = said(&[5.3, 5.4, 5.35, 5.32], &[4.5, 4.55, 4.48, 4.5]);
        assert!(many.starts_with("z falls from 5.34") && many.contains(" at friction 0.1 to 4.5"), "{many}");
        let two = said(&[5.269, 5.413], &[4.488, 4.528]);
        assert!(
            two.ends_with("11 standard errors apart, but 2 and 2 runs are too few to exclude chance."),
            "{two}"
        );
        assert!(said(&[5.0, 5.2, 5.1], &[5.1, 5.0, 5.2]).contains("is not shown to change"));
        assert!(said(&[5.0], &[4.0]).ends_with("with a single run at each: the scatter is not known."));
        let ends = [(1.0, mean(&[6.5, 5.0, 5.6])), (29.0, mean(&[5.9, 4.4, 5.02]))];
        let same = change("z", &of("G", ""), ends, Some(mean(&[-0.6, -0.6, -0.58])));
        assert!(
            same.contains("z falls from 5.7") && same.ends_with(", by 0.5933 ± 0.0067 for the same seeds."),
            "{same}"
        );
        let stress = change("z", &of("stress", "kPa"), [(20.0, mean(&[5.0])), (40.0, mean(&[5.5]))], None);
        assert!(stress.contains(" at stress 20 kPa and ") && stress.contains(" at 40 kPa,"), "{stress}");
        assert!(said(&[5.0], &[4.0, 4.1]).contains("with a single run at one of them"));
    }
}
