//! What every plot of a bench is made of: SVG with two logarithmic axes.

use std::fmt::Write;

/// Width and height of the picture.
pub(super) const PICTURE: [f64; 2] = [860.0, 560.0];

/// Left, right, top, bottom of the axes.
pub(super) const AXES: [f64; 4] = [70.0, 640.0, 60.0, 490.0];

/// Distinct for the colour-blind (Okabe and Ito, and two more), dark enough on white.
pub(super) const COLOURS: [&str; 9] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d1f", "#6a3d9a"];

/// Room beyond the outermost values, share of what lies between them.
const MARGIN: f64 = 0.03;

/// More decades than these are marked by their powers of ten alone…
const FEW_DECADES: f64 = 3.5;

/// …and more than these by every second one.
const MANY_DECADES: f64 = 10.0;

/// A logarithmic axis from decade parts below the smallest to above the largest value.
pub(super) struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// From left to right.
    pub(super) fn horizontal(values: impl Iterator<Item = f64> + Clone) -> Self {
        Self::new(values, AXES[0], AXES[1])
    }

    /// From bottom to top.
    pub(super) fn vertical(values: impl Iterator<Item = f64> + Clone) -> Self {
        Self::new(values, AXES[3], AXES[2])
    }

    fn new(values: impl Iterator<Item = f64> + Clone, from: f64, to: f64) -> Self {
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.fold(0.0, f64::max);
        let margin = (high / low).powf(MARGIN).max(1.25);
        let (low, high) = if low <= high { (low / margin, high * margin) } else { (0.5, 2.0) };
        Self { low, high, from, to }
    }

    pub(super) fn at(&self, value: f64) -> f64 {
        self.from + (self.to - self.from) * (value / self.low).ln() / (self.high / self.low).ln()
    }

    /// 1, 2 and 5 of every decade in range, or fewer where there are many decades.
    fn ticks(&self) -> Vec<f64> {
        let span = (self.high / self.low).log10();
        let parts: &[f64] = if span < FEW_DECADES { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let every = if span < MANY_DECADES { 1 } else { 2 };
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let wanted = decades.filter(|d| d.rem_euclid(every) == 0);
        let all = wanted.flat_map(|d| parts.iter().map(move |m| m * 10f64.powi(d)));
        all.filter(|t| (self.low..=self.high).contains(t)).collect()
    }
}

/// The head of a picture, with a title and a line that explains it.
pub(super) fn begin(title: &str, below: &str) -> String {
    let [width, height] = PICTURE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    text(&mut svg, AXES[0], 28.0, "start", "font-size=\"15\"", title);
    text(&mut svg, AXES[0], 46.0, "start", "fill=\"#555\"", below);
    svg
}

/// Both axes with their names and a grid.
pub(super) fn axes(svg: &mut String, (x, along): (&Axis, &str), (y, up): (&Axis, &str)) {
    let [left, right, top, bottom] = AXES;
    for t in x.ticks() {
        let at = x.at(t);
        line(svg, [at, top, at, bottom], "#e4e4e4");
        text(svg, at, bottom + 18.0, "middle", "", &tick(t));
    }
    for t in y.ticks() {
        let at = y.at(t);
        line(svg, [left, at, right, at], "#e4e4e4");
        text(svg, left - 8.0, at + 4.0, "end", "", &tick(t));
    }
    line(svg, [left, bottom, right, bottom], "black");
    line(svg, [left, top, left, bottom], "black");
    text(svg, 0.5 * (left + right), bottom + 42.0, "middle", "", along);
    let turned = format!("transform=\"rotate(-90 20 {:.1})\"", 0.5 * (top + bottom));
    text(svg, 20.0, 0.5 * (top + bottom), "middle", &turned, up);
}

/// One significant digit, as people write it.
fn tick(value: f64) -> String {
    if (1e-3..1e5).contains(&value) {
        format!("{}", (value * 1e4).round() / 1e4)
    } else {
        format!("{value:.0e}")
    }
}

pub(super) fn line(svg: &mut String, [x1, y1, x2, y2]: [f64; 4], colour: &str) {
    let _ = writeln!(
        svg,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{colour}\"/>"
    );
}

/// A point with a stroke and a fill, that says in its title what it is.
pub(super) fn circle(svg: &mut String, [x, y]: [f64; 2], (stroke, fill): (&str, &str), title: &str) {
    let style = format!("stroke=\"{stroke}\" fill=\"{fill}\" stroke-width=\"1.4\"");
    let title = escaped(title);
    let _ =
        writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" {style}><title>{title}</title></circle>");
}

pub(super) fn text(svg: &mut String, x: f64, y: f64, anchor: &str, more: &str, content: &str) {
    let content = escaped(content);
    let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" {more}>{content}</text>");
}

pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_spans_its_values_and_a_factor_is_a_distance() {
        let axis = Axis::new([0.4, 3.0, 40.0].into_iter(), 100.0, 500.0);
        assert!(axis.at(0.4) > 100.0 && axis.at(40.0) < 500.0);
        assert!((axis.at(4.0) - axis.at(2.0) - (axis.at(20.0) - axis.at(10.0))).abs() < 1e-9);
        assert_eq!(axis.ticks(), [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0]);
    }

    #[test]
    fn many_decades_are_marked_by_every_second_one_and_written_as_people_write_them() {
        let axis = Axis::new([2e-15, 0.5].into_iter(), 0.0, 1.0);
        let marks: Vec<String> = axis.ticks().into_iter().map(tick).collect();
        assert_eq!(marks, ["1e-14", "1e-12", "1e-10", "1e-8", "1e-6", "1e-4", "0.01", "1"]);
        assert_eq!([0.002, 0.1, 5.0, 2e4, 1e5].map(tick), ["0.002", "0.1", "5", "20000", "1e5"]);
    }

    #[test]
    fn what_is_written_into_the_svg_cannot_end_it() {
        assert_eq!(escaped("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
    }

    #[test]
    fn without_any_point_the_axes_still_have_a_range() {
        let axis = Axis::new(std::iter::empty(), 0.0, 1.0);
        assert!(axis.low < axis.high && axis.at(1.0).is_finite());
    }
}
