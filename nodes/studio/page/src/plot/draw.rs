//! The elements of a plot. Colours are classes, so that one style sheet contains those of a theme.

use super::axis::Range;
use super::figure::{Entry, Line, Marker, Series, Theme};
use super::labels::Area;
use super::style::style;
use crate::elements::true_minus;
use crate::markup::{Html, escaped};
use std::f64::consts::TAU;
use std::fmt::Write;

const PICTURE: [f64; 2] = [860.0, 560.0];

const FRAME: Area = [70.0, 60.0, 640.0, 490.0];

/// Half the width of a digit.
pub(super) const HALF_LETTER: f64 = 3.8;

pub(super) const TITLE_LINE: f64 = 16.0;

const TITLE_LETTER: f64 = 7.3;

const LEGEND_LINE: f64 = 20.0;

/// Left end of the legend.
const LEGEND: f64 = FRAME[2] + 29.0;

#[derive(Clone, Copy)]
pub(super) struct Key {
    pub(super) marker: Marker,
    pub(super) colour: Option<usize>,
    pub(super) hollow: bool,
}

pub(super) struct Drawing {
    text: String,
    width: f64,
    frame: Area,
}

impl Drawing {
    pub(super) fn begin(theme: Theme, title: &str, subtitle: &str) -> Self {
        let sheet = format!("<style>{}</style>\n", style(theme));
        let mut drawing = Self::blank(PICTURE, FRAME, "", &sheet);
        drawing.text([FRAME[0], 28.0], "start", "class=\"ink\" font-size=\"15\"", title);
        drawing.text([FRAME[0], 46.0], "start", "class=\"faint\"", subtitle);
        drawing
    }

    /// A small plot of a page, with axes at `frame`. The text `about` is for readers who do not see it.
    pub(super) fn small(size: [f64; 2], frame: Area, title: &str, about: &str, attributes: &str) -> Self {
        let mut drawing = Self::blank(size, frame, &(of_page(about) + attributes), "");
        for (n, line) in title_lines(title, size[0]).iter().enumerate() {
            let at = [8.0, 20.0 + TITLE_LINE * n as f64];
            drawing.text(at, "start", "class=\"ink\" font-size=\"13\" font-weight=\"600\"", line);
        }
        drawing
    }

    /// Without titles, with axes at `frame`; `attributes` and the text `first` are those of the SVG.
    fn blank([width, height]: [f64; 2], frame: Area, attributes: &str, first: &str) -> Self {
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
             font-size=\"12\"{attributes}>\n{first}<rect width=\"{width}\" height=\"{height}\" class=\"paper\"/>\n"
        );
        Self { text, width, frame }
    }

    pub(super) fn end(mut self) -> String {
        self.text += "</svg>\n";
        self.text
    }

    pub(super) fn element(self) -> Html {
        Html::drawn(self.end())
    }

    pub(super) fn frame(&self) -> Area {
        self.frame
    }

    pub(super) fn group(&mut self, class: &str, draw: impl FnOnce(&mut Self)) {
        self.add(format_args!("<g class=\"{class}\">"));
        draw(self);
        self.add(format_args!("</g>"));
    }

    /// Adds the elements of a series, whose name scripts show.
    pub(super) fn series(&mut self, name: &str, draw: impl FnOnce(&mut Self)) {
        self.add(format_args!("<g class=\"series\" data-name=\"{}\">", escaped(name)));
        draw(self);
        self.add(format_args!("</g>"));
    }

    /// Adds elements over which scripts show these words.
    pub(super) fn saying(&mut self, words: &str, draw: impl FnOnce(&mut Self)) {
        self.add(format_args!("<g data-said=\"{}\">", escaped(&true_minus(words))));
        draw(self);
        self.add(format_args!("</g>"));
    }

    pub(super) fn add(&mut self, element: std::fmt::Arguments<'_>) {
        let _ = writeln!(self.text, "{element}");
    }

    /// Lines and labels of the horizontal axis. A label that has no room is left out, and the last one ends within the picture.
    pub(super) fn marks(&mut self, x: &Range) {
        let [_, top, _, bottom] = self.frame;
        let mut free = f64::NEG_INFINITY;
        self.group("marks", |drawing| {
            for (value, text) in x.marks() {
                let (at, half) = (x.at(value), HALF_LETTER * text.chars().count() as f64);
                drawing.segment([at, top, at, bottom], "grid");
                let middle = at.min(drawing.width - half);
                if middle - half > free {
                    drawing.text([middle, bottom + 16.0], "middle", "class=\"ink\"", &text);
                    free = middle + half + HALF_LETTER;
                }
            }
        });
    }

    pub(super) fn axes(&mut self, (x, along): (&Range, &str), (y, up): (&Range, &str)) {
        self.marks(x);
        self.other_axes(along, (y, up));
    }

    /// Both axes without the marks of the horizontal one.
    pub(super) fn other_axes(&mut self, along: &str, (y, up): (&Range, &str)) {
        let [left, top, right, bottom] = self.frame;
        self.group("marks-up", |drawing| {
            for (value, text) in y.marks() {
                let at = y.at(value);
                drawing.segment([left, at, right, at], "grid");
                drawing.text([left - 8.0, at + 4.0], "end", "class=\"ink\"", &text);
            }
        });
        self.segment([left, bottom, right, bottom], "axis");
        self.segment([left, top, left, bottom], "axis");
        if !along.is_empty() {
            self.text([0.5 * (left + right), bottom + 42.0], "middle", "class=\"ink\"", along);
        }
        if !up.is_empty() {
            let middle = 0.5 * (top + bottom);
            let turned = format!("class=\"ink\" transform=\"rotate(-90 20 {middle:.1})\"");
            self.text([20.0, middle], "middle", &turned, up);
        }
    }

    pub(super) fn line(&mut self, series: &Series, places: &[[f64; 2]]) {
        let (Some(line), Some((first, rest))) = (series.line, places.split_first()) else { return };
        let mut path = format!("M {:.1} {:.1}", first[0], first[1]);
        for [x, y] in rest {
            let _ = write!(path, " L {x:.1} {y:.1}");
        }
        let opacity = match line {
            Line::Straight => "",
            Line::Faint => " stroke-opacity=\"0.35\"",
        };
        let class = class(series.colour);
        let _ = writeln!(
            self.text,
            "<path d=\"{path}\" class=\"{class}\" fill=\"none\" stroke=\"currentColor\"{opacity}/>"
        );
    }

    pub(super) fn error_bar(&mut self, colour: Option<usize>, x: f64, [low, high]: [f64; 2]) {
        let (left, right, class) = (x - 3.0, x + 3.0, class(colour));
        let _ = writeln!(
            self.text,
            "<path d=\"M {left:.1} {low:.1} H {right:.1} M {x:.1} {low:.1} V {high:.1} M {left:.1} {high:.1} H {right:.1}\" \
             class=\"{class}\" fill=\"none\" stroke=\"currentColor\"/>"
        );
    }

    pub(super) fn marker(&mut self, [x, y]: [f64; 2], key: Key, tooltip: &str) {
        let class = format!("{} {}", class(key.colour), if key.hollow { "hollow" } else { "full" });
        let title = if tooltip.is_empty() {
            String::new()
        } else {
            format!("<title>{}</title>", escaped(&true_minus(tooltip)))
        };
        let (element, shape) = match corners(key.marker) {
            None => ("circle", format!("cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\"")),
            Some(corners) => {
                let at = |[dx, dy]: &[f64; 2]| format!("{:.1},{:.1}", x + dx, y + dy);
                let all: Vec<String> = corners.iter().map(at).collect();
                ("polygon", format!("points=\"{}\"", all.join(" ")))
            }
        };
        let _ = writeln!(self.text, "<{element} {shape} class=\"{class}\">{title}</{element}>");
    }

    /// A small text with its lower left corner.
    pub(super) fn label(&mut self, at: [f64; 2], text: &str, colour: Option<usize>) {
        let more = format!("class=\"{}\" fill=\"currentColor\" font-size=\"11\"", class(colour));
        self.text(at, "start", &more, text);
    }

    pub(super) fn legend(&mut self, entries: &[Entry]) {
        let mut y = FRAME[1] + 10.0;
        for entry in entries {
            self.entry([LEGEND, y], entry);
            y += if matches!(entry, Entry::Gap) { 0.5 * LEGEND_LINE } else { LEGEND_LINE };
        }
    }

    /// One entry of a legend, from its left end on the line of its letters.
    pub(super) fn entry(&mut self, [x, y]: [f64; 2], entry: &Entry) {
        match entry {
            Entry::Colour(colour, text) => {
                let class = class(Some(*colour));
                let _ = writeln!(
                    self.text,
                    "<path d=\"M {x:.1} {:.1} h 14\" class=\"{class}\" stroke=\"currentColor\" stroke-width=\"3\"/>",
                    y - 4.0
                );
                self.text([x + 20.0, y], "start", "class=\"ink\"", text);
            }
            Entry::Shape(marker, colour, hollow, text) => {
                let key = Key { marker: *marker, colour: *colour, hollow: *hollow };
                self.marker([x + 7.0, y - 4.0], key, "");
                self.text([x + 20.0, y], "start", "class=\"ink\"", text);
            }
            Entry::Note(text) => self.text([x, y], "start", "class=\"faint\"", text),
            Entry::Gap => {}
        }
    }

    pub(super) fn segment(&mut self, [x1, y1, x2, y2]: [f64; 4], class: &str) {
        let _ = writeln!(
            self.text,
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" class=\"{class}\"/>"
        );
    }

    pub(super) fn text(&mut self, [x, y]: [f64; 2], anchor: &str, more: &str, content: &str) {
        let content = escaped(&true_minus(content));
        let _ = writeln!(
            self.text,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" {more}>{content}</text>"
        );
    }
}

/// Lines of the title of a small plot of this width: whole words, and parts of one that is longer than a line.
pub(super) fn title_lines(title: &str, width: f64) -> Vec<String> {
    let most = ((width - 16.0) / TITLE_LETTER) as usize;
    let mut lines = vec![String::new()];
    for word in title.split_whitespace() {
        for part in word.chars().collect::<Vec<_>>().chunks(most) {
            let last = lines.len() - 1;
            let gap = if lines[last].is_empty() { "" } else { " " };
            if lines[last].chars().count() + gap.len() + part.len() > most {
                lines.push(part.iter().collect());
            } else {
                lines[last] += gap;
                lines[last].extend(part);
            }
        }
    }
    lines
}

/// Attributes of a plot whose colours are those of its page.
fn of_page(about: &str) -> String {
    format!(" class=\"plot\" role=\"img\" aria-label=\"{}\"", escaped(about))
}

/// Corners of a marker from its centre; `None` for a circle.
fn corners(marker: Marker) -> Option<Vec<[f64; 2]>> {
    let polygon = |corners: u32, turn: f64| -> Vec<[f64; 2]> {
        let angle = |k: u32| TAU * (f64::from(k) / f64::from(corners) + turn);
        (0..corners).map(|k| [6.0 * angle(k).sin(), -6.0 * angle(k).cos()]).collect()
    };
    Some(match marker {
        Marker::Circle => return None,
        Marker::Square => polygon(4, 0.125),
        Marker::Triangle => polygon(3, 0.0),
        Marker::Diamond => polygon(4, 0.0),
        Marker::TriangleDown => polygon(3, 0.5),
        Marker::Pentagon => polygon(5, 0.0),
        Marker::Hexagon => polygon(6, 0.0),
    })
}

pub(super) fn class(colour: Option<usize>) -> String {
    colour.map_or_else(|| "grey".to_owned(), |n| format!("c{}", n % Series::COLOURS))
}
