//! One of several plots over a common axis: small, with the legend beside its title, and bands for the stages of that axis.

use super::axis::Range;
use super::draw::{Drawing, TITLE_LINE, class, title_lines};
use super::figure::{Entry, Figure, Scale, Series};
use super::labels::spread;
use crate::markup::{Html, escaped};

/// Width: a column of a narrow screen, so that letters are never drawn smaller than written.
const WIDTH: f64 = 340.0;

const HEIGHT: f64 = 150.0;

/// Top of the axes below the title, and height of a row of the legend.
const TOP: [f64; 2] = [34.0, 16.0];

const LETTER: f64 = 6.4;

/// Most letters of a name beside the end of its line; longer ones are in a legend.
const BESIDE: usize = 9;

/// A stage of the horizontal axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// Begin and end, in the unit of the axis.
    pub range: [f64; 2],
    /// Number or short name, left out if there is no room.
    pub label: String,
    /// Text of its tooltip.
    pub tooltip: String,
}

/// A plot among others of a page.
#[derive(Clone, Debug, Default)]
pub struct Strip {
    /// Title, axes, series and legend; the subtitle is for readers who do not see the plot.
    pub figure: Figure,
    /// Drawn behind the series.
    pub bands: Vec<Band>,
    /// True for bands as the horizontal axis, which then has their labels instead of values.
    pub by_band: bool,
}

impl Strip {
    /// The plot as an element of a page. The attributes `data-frame` (left, top, right, bottom), `data-x` and `data-y` (values at the
    /// ends, and the spacing) are for scripts that read positions; so is `data-name` of a line.
    pub fn svg(&self) -> Html {
        let Figure { title, subtitle, x, y, series, legend } = &self.figure;
        let named: Vec<&Series> =
            series.iter().filter(|s| !s.name.is_empty() && !s.points.is_empty()).collect();
        let longest = named.iter().map(|s| s.name.chars().count()).max().unwrap_or(0);
        let is_beside = legend.is_empty() && longest <= BESIDE;
        let entries =
            if legend.is_empty() { named.iter().map(|s| s.entry()).collect() } else { legend.clone() };
        let rows = if is_beside { Vec::new() } else { rows(&entries) };
        let margin = if is_beside && longest > 0 { LETTER * longest as f64 + 10.0 } else { 12.0 };
        let about = format!("{title}. {subtitle}");
        let title = if y.name.is_empty() { title.clone() } else { format!("{title}: {}", y.name) };
        let below_title = TOP[0] + TITLE_LINE * (title_lines(&title, WIDTH).len() - 1) as f64;
        let top = below_title + TOP[1] * rows.len() as f64;
        let (right, bottom) = (WIDTH - margin, top + HEIGHT);
        let [_, up] = self.figure.ranges([0.0, top, right, bottom]);
        let digits = up.marks().iter().map(|(_, text)| text.chars().count()).max().unwrap_or(0);
        let frame = [14.0 + LETTER * digits as f64, top, right, bottom];
        let [across, up] = self.figure.ranges(frame);
        let of = |range: &Range, scale: Scale| {
            let [low, high] = range.ends();
            format!("{low} {high} {}", if scale == Scale::Log { "log" } else { "linear" })
        };
        let [left, ..] = frame;
        let attributes = format!(
            " data-along=\"{}\" data-frame=\"{left} {top} {right} {bottom}\" data-x=\"{}\" data-y=\"{}\"",
            escaped(&x.name),
            of(&across, x.scale),
            of(&up, y.scale)
        );
        let mut drawing = Drawing::small([WIDTH, bottom + 40.0], frame, &title, &about, &attributes);
        drawing.group("bands", |drawing| self.draw_bands(drawing, &across));
        if self.by_band {
            drawing.other_axes("", (&up, ""));
        } else {
            drawing.axes((&across, ""), (&up, ""));
        }
        drawing.text([right, bottom + 32.0], "end", "class=\"faint\"", &x.name);
        drawing.group("curves", |drawing| self.figure.draw(drawing, [&across, &up]));
        if is_beside {
            let ends =
                named.iter().filter_map(|s| s.points.iter().rfind(|p| up.has(p.y))).map(|p| up.at(p.y));
            drawing.group("ends", |drawing| {
                for (series, at) in named.iter().zip(spread(ends.collect(), [top, bottom])) {
                    let of = format!("class=\"{}\" fill=\"currentColor\"", class(series.colour));
                    drawing.text([right + 5.0, at + 4.0], "start", &of, &series.name);
                }
            });
        }
        for (n, row) in rows.iter().enumerate() {
            let mut at = 8.0;
            for (entry, width) in row {
                drawing.entry([at, below_title + TOP[1] * n as f64], entry);
                at += width;
            }
        }
        drawing.element()
    }

    fn draw_bands(&self, drawing: &mut Drawing, across: &Range) {
        let ([_, top, _, bottom], [low, high]) = (drawing.frame(), across.ends());
        let mut free = f64::NEG_INFINITY;
        for (n, band) in self.bands.iter().enumerate() {
            let [from, to] = band.range.map(|v| across.at(v.clamp(low, high)));
            let fill = if n % 2 == 0 { "band" } else { "paper" };
            drawing.add(format_args!(
                "<rect x=\"{from:.1}\" y=\"{top}\" width=\"{:.1}\" height=\"{:.1}\" class=\"{fill}\"><title>{}</title></rect>",
                to - from,
                bottom - top,
                escaped(&band.tooltip)
            ));
            let label_at = if self.by_band { bottom + 16.0 } else { top + 11.0 };
            let (middle, half) = (0.5 * (from + to), 0.5 * LETTER * band.label.chars().count() as f64);
            if to - from > 2.0 * half && middle - half > free {
                drawing.text([middle, label_at], "middle", "class=\"faint\"", &band.label);
                free = middle + half + LETTER;
            }
        }
    }
}

/// Entries of a legend in rows, each entry with its width.
fn rows(entries: &[Entry]) -> Vec<Vec<(&Entry, f64)>> {
    let (mut rows, mut room) = (Vec::new(), 0.0);
    for entry in entries {
        let width = match entry {
            Entry::Colour(_, text) | Entry::Shape(.., text) => 32.0 + LETTER * text.chars().count() as f64,
            Entry::Note(text) => 12.0 + LETTER * text.chars().count() as f64,
            Entry::Gap => continue,
        };
        if room < width {
            rows.push(Vec::new());
            room = WIDTH - 8.0;
        }
        room -= width;
        rows.last_mut().expect("a row").push((entry, width));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Axis, Line, Point, Series};

    #[test]
    fn a_title_is_in_as_many_lines_as_the_width_needs_and_the_axes_begin_below() {
        let of = |title: &str| {
            let figure = Figure { title: title.into(), ..Figure::default() };
            let svg = Strip { figure, ..Strip::default() }.svg();
            let top = svg.split("data-frame=\"").nth(1).unwrap().split(' ').nth(1).unwrap().to_owned();
            (svg.matches("font-weight=\"600\"").count(), top)
        };
        assert_eq!(of("coordination number z"), (1, "34".into()));
        assert_eq!(of("long beach sand from the Baltic sea: coordination number z"), (2, "50".into()));
        assert_eq!(of(&"x".repeat(100)), (3, "66".into()));
    }

    #[test]
    fn a_band_beyond_the_values_ends_at_the_frame_and_a_narrow_one_has_no_label() {
        let points = (0..5).map(|n| Point::at(f64::from(n), f64::from(n * n))).collect();
        let series = vec![Series { line: Some(Line::Straight), points, ..Series::default() }];
        let figure =
            Figure { title: "a & b".into(), x: Axis::linear("time, ms"), series, ..Figure::default() };
        let band = |range, label: &str| Band { range, label: label.into(), tooltip: String::new() };
        let svg = Strip {
            figure,
            bands: vec![band([-9.0, 3.98], "first"), band([3.98, 4.0], "second")],
            by_band: false,
        }
        .svg();
        assert!(svg.contains("aria-label=\"a &amp; b. \"") && svg.contains(">first<"), "{svg:?}");
        assert!(!svg.contains(">second<") && !svg.contains("NaN"), "{svg:?}");
        let left = svg.split("data-frame=\"").nth(1).unwrap().split(' ').next().unwrap();
        let left = format!("<rect x=\"{:.1}\"", left.parse::<f64>().unwrap());
        assert!(svg.contains(&left), "the band begins at the frame, {left}: {svg:?}");
    }
}
