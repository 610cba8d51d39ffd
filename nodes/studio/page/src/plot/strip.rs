//! One of several plots over a common axis: small, with the legend beside its title, and bands for the stages of that axis.

use super::draw::{Drawing, class};
use super::figure::{Entry, Figure, Scale};
use super::labels::Area;
use crate::markup::{Html, escaped};

/// Width and height.
const PICTURE: [f64; 2] = [500.0, 226.0];

/// Left, top, right and bottom of the axes.
const FRAME: Area = [54.0, 34.0, 488.0, 184.0];

/// Mean width of a letter.
const LETTER: f64 = 6.4;

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
    /// The plot as an element of a page. The attributes `data-frame` (left, top, right, bottom) `data-x` (values at left and right) and
    /// `data-y` (values at bottom and top, and the spacing) are for scripts that read positions.
    pub fn svg(&self) -> Html {
        let Figure { title, subtitle, x, y, legend, .. } = &self.figure;
        let [left, top, right, bottom] = FRAME;
        let [across, up] = self.figure.ranges(FRAME);
        let [low, high] = across.ends();
        let [lowest, highest] = up.ends();
        let spacing = if y.scale == Scale::Log { "log" } else { "linear" };
        let attributes = format!(
            " data-frame=\"{left} {top} {right} {bottom}\" data-x=\"{low} {high}\" data-y=\"{lowest} {highest} {spacing}\""
        );
        let about = format!("{title}. {subtitle}");
        let mut drawing = Drawing::small(PICTURE, FRAME, title, &about, &attributes);
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
            if to - from > LETTER * band.label.chars().count() as f64 {
                let at = [0.5 * (from + to), label_at];
                drawing.text(at, "middle", "class=\"faint\" font-size=\"9\"", &band.label);
            }
        }
        if self.by_band {
            drawing.other_axes("", (&up, &y.name));
        } else {
            drawing.axes((&across, ""), (&up, &y.name));
        }
        drawing.text([right, bottom + 34.0], "end", "class=\"faint\" font-size=\"11\"", &x.name);
        self.figure.draw(&mut drawing, [&across, &up]);
        row(&mut drawing, legend);
        drawing.element()
    }
}

/// A legend of colours in one row that ends at the right.
fn row(drawing: &mut Drawing, entries: &[Entry]) {
    let mut right = FRAME[2];
    for entry in entries.iter().rev() {
        let (colour, text) = match entry {
            Entry::Colour(colour, text) => (Some(*colour), text),
            Entry::Shape(_, colour, _, text) => (*colour, text),
            Entry::Note(_) | Entry::Gap => continue,
        };
        right -= LETTER * text.chars().count() as f64;
        drawing.text([right, 20.0], "start", "class=\"ink\" font-size=\"11\"", text);
        right -= 5.0;
        drawing.add(format_args!(
            "<path d=\"M {:.1} 16 h 12\" class=\"{}\" stroke=\"currentColor\" stroke-width=\"2.5\" fill=\"none\"/>",
            right - 12.0,
            class(colour)
        ));
        right -= 24.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Axis, Line, Point, Series};

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
        let left = svg.split("<rect x=\"").nth(1).unwrap();
        assert!(left.starts_with("54.0\""), "the band begins at the frame: {left}");
    }
}
