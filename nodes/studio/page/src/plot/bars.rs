//! Values by name: bars from zero, or points with their intervals.

use super::axis::Range;
use super::draw::{Drawing, Key, class};
use super::figure::{Marker, Scale};
use crate::markup::Html;

/// Width of the plot.
const WIDTH: f64 = 560.0;

/// Right end of the axis.
const RIGHT: f64 = 540.0;

/// Width of a letter of a name.
const LETTER: f64 = 7.0;

/// Upper end of the axis.
const TOP: f64 = 50.0;

/// Height of a value.
const LINE: f64 = 17.0;

/// Room below the values of a name.
const GAP: f64 = 8.0;

/// One value with its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bar {
    /// Name; equal ones in a row are written once.
    pub name: String,
    /// Number of its colour.
    pub colour: usize,
    /// Length or position.
    pub value: f64,
    /// Interval of the value, low and high.
    pub interval: Option<[f64; 2]>,
    /// The value as text, with what belongs to it.
    pub text: String,
}

/// Values by name, from top to bottom.
#[derive(Clone, Debug, Default)]
pub struct Bars {
    /// Title of the plot.
    pub title: String,
    /// Bars that begin at zero, instead of points.
    pub from_zero: bool,
    /// Values in their order.
    pub bars: Vec<Bar>,
    /// A value to compare with, drawn as a line, and its name.
    pub reference: Option<(f64, String)>,
}

impl Bars {
    /// The plot as an element of a page.
    pub fn svg(&self) -> Html {
        let longest = self.bars.iter().map(|b| b.name.chars().count()).max().unwrap_or(0);
        let left = 24.0 + LETTER * longest as f64;
        let mut heights = Vec::with_capacity(self.bars.len());
        let mut y = TOP + 6.0;
        for (n, bar) in self.bars.iter().enumerate() {
            if n > 0 && self.bars[n - 1].name != bar.name {
                y += GAP;
            }
            heights.push(y);
            y += LINE;
        }
        let bottom = y + 4.0;
        let said: Vec<String> = self.bars.iter().map(|b| format!("{} {}", b.name, b.text)).collect();
        let about = format!("{}: {}", self.title, said.join("; "));
        let frame = [left, TOP, RIGHT, bottom];
        let mut drawing = Drawing::small([WIDTH, bottom + 26.0], frame, &self.title, &about, "");
        let ends =
            self.bars.iter().flat_map(|b| b.interval.unwrap_or([b.value; 2]).into_iter().chain([b.value]));
        let zero = self.from_zero.then_some(0.0);
        // Room for the texts beyond the largest value.
        let sides = [left, RIGHT - 92.0];
        let range =
            Range::of(ends.chain(zero).chain(self.reference.as_ref().map(|r| r.0)), Scale::Linear, sides);
        for (value, text) in range.marks() {
            let at = range.at(value);
            drawing.segment([at, TOP, at, bottom], "grid");
            drawing.text([at, bottom + 15.0], "middle", "class=\"ink\" font-size=\"11\"", &text);
        }
        if let Some((value, name)) = &self.reference {
            let at = range.at(*value);
            drawing.segment([at, TOP - 3.0, at, bottom], "axis");
            drawing.text([at, TOP - 8.0], "middle", "class=\"faint\" font-size=\"11\"", name);
        }
        for (n, (bar, y)) in self.bars.iter().zip(heights).enumerate() {
            if n == 0 || self.bars[n - 1].name != bar.name {
                drawing.text([left - 10.0, y + 9.0], "end", "class=\"ink\"", &bar.name);
            }
            let at = range.at(bar.value);
            let mut end = at;
            let colour = class(Some(bar.colour));
            if self.from_zero {
                let zero = range.at(0.0);
                drawing.add(format_args!(
                    "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"1.5\" class=\"{colour}\" \
                     fill=\"currentColor\"/>",
                    zero.min(at),
                    y,
                    (at - zero).abs(),
                    LINE - 5.0
                ));
            }
            if let Some([low, high]) = bar.interval {
                let [low, high] = [range.at(low), range.at(high)];
                end = end.max(high);
                drawing.add(format_args!(
                    "<path d=\"M {low:.1} {0:.1} H {high:.1}\" class=\"{colour}\" stroke=\"currentColor\" stroke-width=\"2.5\"/>",
                    y + 5.0
                ));
            }
            if !self.from_zero {
                drawing.marker(
                    [at, y + 5.0],
                    Key { marker: Marker::Circle, colour: Some(bar.colour), hollow: false },
                    "",
                );
            }
            drawing.text(
                [end.max(range.at(0.0)) + 9.0, y + 9.0],
                "start",
                "class=\"ink\" font-size=\"11\"",
                &bar.text,
            );
        }
        drawing.element()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_begin_at_zero_and_a_name_is_written_once() {
        let bar = |value: f64| Bar { name: "G12".into(), value, text: format!("{value}"), ..Bar::default() };
        let svg = Bars { from_zero: true, bars: vec![bar(2.0), bar(4.0)], ..Bars::default() }.svg();
        assert_eq!(svg.matches(">G12<").count(), 1);
        let bars = svg.split("<rect").skip(2).filter_map(|r| r.split("width=\"").nth(1));
        let widths: Vec<f64> = bars.filter_map(|t| t.split('"').next()?.parse().ok()).collect();
        let [first, second] = [widths[0], widths[1]];
        assert!((second - 2.0 * first).abs() < 0.2, "{widths:?}");
    }
}
