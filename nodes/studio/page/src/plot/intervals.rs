//! Values by name with their intervals, beside a value to compare with.

use super::axis::Range;
use super::draw::{Drawing, HALF_LETTER, Key, class};
use super::figure::{Marker, Scale};
use crate::markup::Html;

const WIDTH: f64 = 300.0;

const SIDES: [f64; 2] = [8.0, WIDTH - 8.0];

const TOP: f64 = 62.0;

/// A value with its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimated {
    /// Name, written above the interval.
    pub name: String,
    /// Position of the point; `None` where there is no value.
    pub value: Option<f64>,
    /// Ends of the interval.
    pub interval: Option<[f64; 2]>,
    /// The value as text, written beside the name.
    pub text: String,
    /// Text below the interval; a row with one is larger, and coloured.
    pub below: String,
    /// True for a point drawn as an outline.
    pub hollow: bool,
}

/// Values of one quantity by name, from top to bottom.
#[derive(Clone, Debug, Default)]
pub struct Intervals {
    /// Symbol of the quantity.
    pub title: String,
    /// Meaning of the quantity.
    pub meaning: String,
    /// Values in their order.
    pub rows: Vec<Estimated>,
    /// A value to compare with, drawn as a line, and its name.
    pub reference: Option<(f64, String)>,
}

impl Intervals {
    /// The plot as an element of a page.
    pub fn svg(&self) -> Html {
        let heights = self.rows.iter().map(|row| if row.below.is_empty() { 32.0 } else { 60.0 });
        let bottom = TOP + heights.clone().sum::<f64>() + 6.0;
        let said: Vec<String> =
            self.rows.iter().map(|r| format!("{} {} {}", r.name, r.text, r.below)).collect();
        let about = format!("{}, {}: {}", self.title, self.meaning, said.join("; "));
        let frame = [SIDES[0], TOP, SIDES[1], bottom];
        let mut drawing = Drawing::small([WIDTH, bottom + 22.0], frame, &self.title, &about, "");
        drawing.text([8.0, 36.0], "start", "class=\"faint\"", &self.meaning);
        let ends = self.rows.iter().flat_map(|r| r.interval.into_iter().flatten().chain(r.value));
        let range = Range::of(ends.chain(self.reference.iter().map(|r| r.0)), Scale::Linear, SIDES);
        drawing.marks(&range);
        if let Some((value, name)) = &self.reference {
            let (at, half) = (range.at(*value), HALF_LETTER * name.chars().count() as f64);
            drawing.segment([at, TOP - 6.0, at, TOP], "axis");
            let middle = at.clamp(SIDES[0] + half, SIDES[1] - half);
            drawing.text([middle, TOP - 8.0], "middle", "class=\"ink\"", name);
        }
        let mut y = TOP;
        for ((row, height), words) in self.rows.iter().zip(heights).zip(&said) {
            let is_first = !row.below.is_empty();
            let (size, colour) = if is_first { ("14", Some(0)) } else { ("12", None) };
            let style = format!("class=\"ink\" font-size=\"{size}\"");
            drawing.text([SIDES[0], y + 16.0], "start", &style, &row.name);
            drawing.text([SIDES[1], y + 16.0], "end", &style, &row.text);
            drawing.text([SIDES[1], y + 50.0], "end", "class=\"faint\"", &row.below);
            let at = y + if is_first { 30.0 } else { 24.0 };
            if let Some([low, high]) = row.interval.map(|ends| ends.map(|end| range.at(end))) {
                drawing.add(format_args!(
                    "<path d=\"M {low:.1} {at:.1} H {high:.1}\" class=\"{}\" stroke=\"currentColor\" stroke-width=\"{}\"/>",
                    class(colour),
                    if is_first { 4 } else { 2 }
                ));
            }
            if let Some(counted) = self.reference.as_ref().map(|r| range.at(r.0)) {
                drawing.segment([counted, at - 9.0, counted, at + 9.0], "counted");
            }
            if let Some(value) = row.value {
                let key = Key { marker: Marker::Circle, colour, hollow: row.hollow };
                drawing.marker([range.at(value), at], key, "");
            }
            drawing.saying(words.trim(), |drawing| {
                drawing.add(format_args!(
                    "<rect y=\"{y:.1}\" width=\"{WIDTH}\" height=\"{height}\" fill=\"none\" pointer-events=\"all\"/>"
                ));
            });
            y += height;
        }
        drawing.element()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_says_its_values_and_without_one_has_no_point_and_the_reference_stays_within_the_plot() {
        let row = |value| Estimated { name: "a".into(), value, text: "text".into(), ..Estimated::default() };
        let rows = vec![row(Some(1.0)), row(None)];
        let svg =
            Intervals { rows, reference: Some((2.0, "counted 2.000".into())), ..Intervals::default() }.svg();
        assert_eq!((svg.matches("<circle").count(), svg.matches(">text<").count()), (1, 2));
        assert_eq!(svg.matches("data-said=\"a text\"").count(), 2);
        assert!(svg.contains("x=\"242.6\"") && !svg.contains("NaN"), "{svg:?}");
    }
}
