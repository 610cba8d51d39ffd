//! Plots as text, for terminals: points as letters over two axes, and bars.

use super::axis::Range;
use super::bars::{Bar, Bars};
use super::figure::{Entry, Figure, Marker};
use std::fmt::Write;

/// Columns and rows between the axes.
const AREA: [usize; 2] = [58, 14];

/// Columns of the longest bar.
const BAR: f64 = 30.0;

/// Columns of a terminal.
const WIDTH: usize = 80;

/// Parts of a column from an eighth to seven eighths.
const PARTS: [&str; 8] = ["", "▏", "▎", "▍", "▌", "▋", "▊", "▉"];

/// Points of several colours at one place.
const SEVERAL: char = '#';

/// The reference point, on top of all others.
const REFERENCE: char = '*';

impl Figure {
    /// The plot as text, at most 80 columns wide: a letter for each colour, `#` where points of several coincide, `*` for the
    /// reference point. Points drawn as outlines are capitals, which mean `hollow`. Lines, error bars, labels and shapes are left
    /// out, and so is a plot of less than two points.
    pub fn text(&self, hollow: &str) -> String {
        let [columns, rows] = AREA;
        let sides = [[0.0, (columns - 1) as f64], [(rows - 1) as f64, 0.0]];
        let points = || self.series.iter().filter(|s| s.marker.is_some()).flat_map(|s| &s.points);
        let x = Range::of(points().map(|p| p.x), self.x.scale, sides[0]);
        let y = Range::of(points().map(|p| p.y), self.y.scale, sides[1]);
        let mut area = vec![vec![' '; columns]; rows];
        let (mut drawn, mut several) = (0, false);
        for series in &self.series {
            let Some(marker) = series.marker else { continue };
            let mark = if marker == Marker::Star { REFERENCE } else { letter(series.colour, series.hollow) };
            for point in series.points.iter().filter(|p| x.has(p.x) && y.has(p.y)) {
                let cell = &mut area[y.at(point.y).round() as usize][x.at(point.x).round() as usize];
                *cell = match *cell {
                    ' ' => mark,
                    same if same == mark => mark,
                    _ if mark == REFERENCE => mark,
                    _ => SEVERAL,
                };
                drawn += 1;
            }
        }
        if drawn < 2 {
            return String::new();
        }
        let mut labels = vec![String::new(); rows];
        for (value, text) in y.marks() {
            labels[y.at(value).round() as usize] = text;
        }
        let margin = labels.iter().map(|l| l.chars().count()).max().unwrap_or(0);
        let mut text = format!("{}\n{}\n", self.title, self.y.name);
        for (cells, label) in area.iter().zip(&labels) {
            several |= cells.contains(&SEVERAL);
            let tick = if label.is_empty() { '│' } else { '┤' };
            let cells: String = cells.iter().collect();
            let _ = writeln!(text, "{}", format!("{label:>margin$} {tick}{cells}").trim_end());
        }
        text + &below(&x, margin, &self.x.name) + &self.key(hollow, several)
    }

    /// The letters with what they stand for.
    fn key(&self, hollow: &str, several: bool) -> String {
        let named = self.legend.iter().filter_map(|entry| match entry {
            Entry::Colour(colour, text) | Entry::Shape(_, Some(colour), _, text) => {
                Some(format!("{} {text}", letter(Some(*colour), false)))
            }
            _ => None,
        });
        let reference = self.series.iter().any(|s| s.marker == Some(Marker::Star) && !s.points.is_empty());
        let outlines = self.series.iter().any(|s| s.marker.is_some() && s.hollow && !s.points.is_empty());
        let marks = [
            outlines.then(|| format!("capitals: {hollow}")),
            reference.then(|| format!("{REFERENCE} the default")),
            several.then(|| format!("{SEVERAL} several")),
        ];
        let mut text = String::new();
        let mut at = 0;
        for name in named.chain(marks.into_iter().flatten()) {
            let length = name.chars().count() + 3;
            if at > 0 && at + length > WIDTH {
                text.push('\n');
                at = 0;
            }
            text += if at > 0 { "   " } else { "" };
            text += &name;
            at += length;
        }
        text + "\n"
    }
}

/// The horizontal axis, its labels as far as they do not touch, and its name.
fn below(x: &Range, margin: usize, name: &str) -> String {
    let columns = AREA[0];
    let (mut line, mut labels) = (vec!['─'; columns], String::new());
    for (value, text) in x.marks() {
        let at = x.at(value).round() as usize;
        line[at] = '┬';
        // From the corner of the axes on; a label is centred below its mark.
        let length = text.chars().count();
        let from = (margin + 2 + at).saturating_sub(length / 2);
        let end = labels.chars().count();
        if (end == 0 || from > end) && from + length <= WIDTH {
            labels += &" ".repeat(from - end);
            labels += &text;
        }
    }
    let line: String = line.into_iter().collect();
    let blank = " ".repeat(margin);
    format!("{blank} └{line}\n{labels}\n{blank}  {name}\n")
}

/// The letter of a colour, a capital for points drawn as outlines; a dot for grey.
fn letter(colour: Option<usize>, hollow: bool) -> char {
    let letter = colour.and_then(|c| char::from_digit(10 + (c % 26) as u32, 36)).unwrap_or('.');
    if hollow { letter.to_ascii_uppercase() } else { letter }
}

impl Bars {
    /// Bars from zero as text: the length is the value over the largest one. Values that are not positive have none.
    pub fn text(&self) -> String {
        let largest = self.bars.iter().map(|b| b.value).filter(|v| v.is_finite()).fold(0.0, f64::max);
        let width = self.bars.iter().map(|b| b.name.chars().count()).max().unwrap_or(0);
        let mut text = format!("{}\n", self.title);
        let mut before = None;
        for Bar { name, value, text: said, .. } in &self.bars {
            let shown = if before == Some(name) { "" } else { name };
            before = Some(name);
            let share = if largest > 0.0 { (value / largest).clamp(0.0, 1.0) } else { 0.0 };
            let eighths = (8.0 * BAR * share).round() as usize;
            let bar = "█".repeat(eighths / 8) + PARTS[eighths % 8];
            let _ = writeln!(text, "{}", format!("{shown:width$}  {bar} {said}").trim_end());
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Axis, Point, Series};

    fn series(colour: usize, points: &[[f64; 2]]) -> Series {
        let points = points.iter().map(|[x, y]| Point::at(*x, *y)).collect();
        Series { colour: Some(colour), marker: Some(Marker::Circle), points, ..Series::default() }
    }

    fn figure(series: Vec<Series>) -> Figure {
        let legend = vec![Entry::Colour(0, "iterative".into()), Entry::Colour(1, "direct".into())];
        Figure {
            title: "cost".into(),
            x: Axis::log("time, s"),
            y: Axis::log("error"),
            series,
            legend,
            ..Figure::default()
        }
    }

    /// Rows and columns of a letter between the axes.
    fn places(text: &str, mark: char) -> Vec<(usize, usize)> {
        let rows = text.lines().skip(2).take(AREA[1]).enumerate();
        let within = |line: &str| line.split_once(['│', '┤']).map(|(_, cells)| cells.to_owned()).unwrap();
        rows.flat_map(|(n, line)| {
            let cells: Vec<char> = within(line).chars().collect();
            cells
                .into_iter()
                .enumerate()
                .filter(|(_, c)| *c == mark)
                .map(move |(at, _)| (n, at))
                .collect::<Vec<_>>()
        })
        .collect()
    }

    #[test]
    fn a_point_stands_where_its_values_are_and_equal_factors_are_equal_distances() {
        let text = figure(vec![series(0, &[[0.01, 1e-2], [0.1, 1e-4], [1.0, 1e-6]])]).text("");
        let [first, second, third] = places(&text, 'a')[..] else { panic!("three points: {text}") };
        assert!(first.0 < second.0 && second.0 < third.0, "larger errors are above: {text}");
        assert!((second.0 - first.0).abs_diff(third.0 - second.0) <= 1, "{text}");
        assert!((second.1 - first.1).abs_diff(third.1 - second.1) <= 1, "{text}");
        assert!(text.contains("a iterative   b direct") && !text.contains("several"), "{text}");
    }

    #[test]
    fn no_line_is_wider_than_a_terminal_and_coinciding_points_are_marked() {
        let both = [[0.012_345, 1e-15], [7.0, 3.0]];
        let text = figure(vec![series(0, &both), series(1, &both)]).text("");
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(places(&text, SEVERAL).len() == 2 && text.contains("# several"), "{text}");
        assert_eq!(figure(vec![series(0, &both[..1])]).text(""), "", "one point is no series");
    }

    #[test]
    fn points_drawn_as_outlines_are_capitals_and_the_legend_says_what_they_are() {
        let full = series(0, &[[0.01, 1e-2], [0.1, 1e-4]]);
        let hollow = Series { hollow: true, ..series(1, &[[1.0, 1e-6]]) };
        let text = figure(vec![full.clone(), hollow]).text("stated");
        assert!(places(&text, 'B').len() == 1 && text.contains("capitals: stated"), "{text}");
        assert!(!figure(vec![full]).text("stated").contains("stated"));
    }

    #[test]
    fn bars_are_as_long_as_their_values() {
        let bar =
            |name: &str, value: f64| Bar { name: name.into(), value, text: "x".into(), ..Bar::default() };
        let bars =
            Bars { bars: vec![bar("first", 1.0), bar("first", 0.5), bar("none", -1.0)], ..Bars::default() };
        let text = bars.text();
        let full: Vec<usize> = text.lines().skip(1).map(|l| l.matches('█').count()).collect();
        assert_eq!(full, [30, 15, 0]);
        assert_eq!(text.matches("first ").count(), 1, "a name is written once: {text}");
    }
}
