//! Values by name, as bars from zero.

use super::axis::Range;
use super::draw::{Drawing, class};
use super::figure::Scale;
use crate::markup::Html;

const WIDTH: f64 = 340.0;

const RIGHT: f64 = 332.0;

const LETTER: f64 = 7.0;

const TOP: f64 = 34.0;

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
    /// Length of the bar.
    pub value: f64,
    /// The value as text, with what belongs to it.
    pub text: String,
}

/// Values by name, from top to bottom.
#[derive(Clone, Debug, Default)]
pub struct Bars {
    /// Title of the plot.
    pub title: String,
    /// Values in their order.
    pub bars: Vec<Bar>,
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
        // Room for the texts beyond the largest value.
        let most = self.bars.iter().map(|b| b.text.chars().count()).max().unwrap_or(0);
        let sides = [left, RIGHT - 10.0 - LETTER * most as f64];
        let range = Range::of(self.bars.iter().map(|b| b.value).chain([0.0]), Scale::Linear, sides);
        drawing.marks(&range);
        for (n, (bar, y)) in self.bars.iter().zip(heights).enumerate() {
            if n == 0 || self.bars[n - 1].name != bar.name {
                drawing.text([left - 10.0, y + 9.0], "end", "class=\"ink\"", &bar.name);
            }
            let (at, zero, colour) = (range.at(bar.value), range.at(0.0), class(Some(bar.colour)));
            drawing.saying(&format!("{} {}", bar.name, bar.text), |drawing| drawing.add(format_args!(
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"1.5\" class=\"{colour}\" fill=\"currentColor\"/>",
                zero.min(at),
                y,
                (at - zero).abs(),
                LINE - 5.0
            )));
            drawing.text([at.max(zero) + 6.0, y + 10.0], "start", "class=\"ink\"", &bar.text);
        }
        drawing.element()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_begin_at_zero_and_say_their_values_and_a_name_is_written_once() {
        let bar = |value: f64| Bar { name: "G12".into(), value, text: format!("{value}"), ..Bar::default() };
        let svg = Bars { bars: vec![bar(2.0), bar(4.0)], ..Bars::default() }.svg();
        assert_eq!((svg.matches(">G12<").count(), svg.matches("data-said=\"G12 ").count()), (1, 2));
        let bars = svg.split("<rect").skip(2).filter_map(|r| r.split("width=\"").nth(1));
        let widths: Vec<f64> = bars.filter_map(|t| t.split('"').next()?.parse().ok()).collect();
        let [first, second] = [widths[0], widths[1]];
        assert!((second - 2.0 * first).abs() < 0.2, "{widths:?}");
    }
}
