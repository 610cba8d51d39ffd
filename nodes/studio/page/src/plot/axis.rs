//! Positions of values, and the tick marks of an axis.

use super::figure::Scale;

/// Margin beyond the outermost values, fraction of the range.
const MARGIN: f64 = 0.03;

/// Relative difference up to which values are alike: their digits would fill the axis.
const ALIKE: f64 = 1e-5;

/// Least ratio of an end of a logarithmic axis to the outermost value.
const LEAST_FACTOR: f64 = 1.25;

/// An axis of less than a decade has a mark at every digit.
const ONE_DECADE: f64 = 1.0;

/// With more decades than this, only powers of ten are marked…
const FEW_DECADES: f64 = 3.5;

/// …and with more than this, every second one.
const MANY_DECADES: f64 = 10.0;

/// A logarithmic axis of less than this many decades is marked like a linear one: few digits are on it.
const NARROW: f64 = 0.5;

/// Number of marks below which an axis has no scale.
const LEAST_MARKS: usize = 3;

/// Approximate number of marks of a linear axis.
const MARKS: f64 = 6.0;

pub(super) struct Range {
    low: f64,
    high: f64,
    scale: Scale,
    from: f64,
    to: f64,
}

impl Range {
    /// An axis between these positions, slightly longer than the range of its values.
    pub(super) fn of(values: impl Iterator<Item = f64>, scale: Scale, [from, to]: [f64; 2]) -> Self {
        let fits = |v: &f64| v.is_finite() && (scale == Scale::Linear || *v > 0.0);
        let ends = values.filter(fits).fold(None, |ends: Option<(f64, f64)>, v| {
            Some(ends.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
        });
        let (low, high) = match (ends, scale) {
            (None, Scale::Linear) => (0.0, 1.0),
            (None, Scale::Log) => (0.5, 2.0),
            (Some((low, high)), Scale::Linear) => {
                let (span, size) = (high - low, low.abs().max(high.abs()));
                let margin = MARGIN * if span > ALIKE * size { span } else { size.max(1.0) };
                (low - margin, high + margin)
            }
            (Some((low, high)), Scale::Log) => {
                let margin = (high / low).powf(MARGIN).max(LEAST_FACTOR);
                (low / margin, high * margin)
            }
        };
        Self { low, high, scale, from, to }
    }

    pub(super) fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    pub(super) fn has(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    pub(super) fn at(&self, value: f64) -> f64 {
        let share = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
        };
        self.from + (self.to - self.from) * share
    }

    /// Marked values with their labels, which have a true minus sign.
    pub(super) fn marks(&self) -> Vec<(f64, String)> {
        let marks = match self.scale {
            Scale::Linear => self.linear_marks(),
            Scale::Log => self.log_marks(),
        };
        marks.into_iter().map(|(value, text)| (value, text.replace('-', "−"))).collect()
    }

    /// Multiples of 1, 2 or 5 times a power of ten.
    fn linear_marks(&self) -> Vec<(f64, String)> {
        let wanted = (self.high - self.low) / MARKS;
        let decade = 10f64.powf(wanted.log10().floor());
        let numbers = |step: f64| (self.low / step).ceil() as i64..=(self.high / step).floor() as i64;
        // The first step that is long enough, or the one before it where that one leaves fewer marks than a scale needs.
        let steps = [10.0, 5.0, 2.0, 1.0].map(|m| m * decade);
        let long = steps.iter().rposition(|s| *s >= wanted).unwrap_or(0);
        let enough = |step: &&f64| numbers(**step).count() >= LEAST_MARKS;
        let step = steps[long..].iter().find(enough).copied().unwrap_or(decade);
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let numbers = numbers(step);
        let mark = |n: i64| {
            let value = n as f64 * step;
            let text = if digits > 4 { format!("{value:e}") } else { format!("{value:.digits$}") };
            (value, text)
        };
        numbers.map(mark).collect()
    }

    /// 1, 2 and 5 of every decade in the range, more on a short axis and fewer on a long one.
    fn log_marks(&self) -> Vec<(f64, String)> {
        let span = (self.high / self.low).log10();
        if span < NARROW {
            return self.linear_marks();
        }
        let parts: &[f64] = match span {
            _ if span < ONE_DECADE => &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
            _ if span < FEW_DECADES => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let every = if span < MANY_DECADES { 1 } else { 2 };
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let wanted = decades.filter(|d| d.rem_euclid(every) == 0);
        let all = wanted.flat_map(|d| parts.iter().map(move |m| m * 10f64.powi(d)));
        all.filter(|v| self.has(*v)).map(|v| (v, power(v))).collect()
    }
}

/// A number with one significant digit.
fn power(value: f64) -> String {
    if (1e-3..1e5).contains(&value) {
        format!("{}", (value * 1e4).round() / 1e4)
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(values: &[f64]) -> Range {
        Range::of(values.iter().copied(), Scale::Log, [100.0, 500.0])
    }

    #[test]
    fn a_logarithmic_axis_spans_its_values_and_a_factor_is_a_distance() {
        let axis = log(&[0.4, 3.0, 40.0]);
        assert!(axis.at(0.4) > 100.0 && axis.at(40.0) < 500.0);
        assert!((axis.at(4.0) - axis.at(2.0) - (axis.at(20.0) - axis.at(10.0))).abs() < 1e-9);
        let marks: Vec<f64> = axis.marks().into_iter().map(|(v, _)| v).collect();
        assert_eq!(marks, [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0]);
    }

    #[test]
    fn many_decades_are_marked_by_every_second_one_and_written_as_people_write_them() {
        let marks: Vec<String> = log(&[2e-15, 0.5]).marks().into_iter().map(|(_, text)| text).collect();
        assert_eq!(marks, ["1e−14", "1e−12", "1e−10", "1e−8", "1e−6", "1e−4", "0.01", "1"]);
        assert_eq!([0.002, 0.1, 5.0, 2e4, 1e5].map(power), ["0.002", "0.1", "5", "20000", "1e5"]);
    }

    #[test]
    fn a_linear_axis_is_marked_at_round_values() {
        let texts = |low: f64, high: f64| -> Vec<String> {
            let axis = Range::of([low, high].into_iter(), Scale::Linear, [0.0, 1.0]);
            axis.marks().into_iter().map(|(_, text)| text).collect()
        };
        assert_eq!(texts(0.0, 1.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(-30.0, 100.0), ["0", "50", "100"]);
        assert!(texts(5.0, 5.0).len() > 2, "a single value has an axis, too");
        assert_eq!(texts(49.9999993, 50.0000002), ["49", "50", "51"], "values alike");
    }

    #[test]
    fn an_axis_of_any_range_has_at_least_three_marks() {
        for scale in [Scale::Linear, Scale::Log] {
            for low in [0.18, 0.31, 1.0, 4.67, 9.5, 123.0] {
                for i in 1..60 {
                    let high = low * (1.0 + 0.02 * f64::from(i));
                    let axis = Range::of([low, high].into_iter(), scale, [0.0, 1.0]);
                    let marks = axis.marks();
                    assert!((3..=16).contains(&marks.len()), "{low} to {high}: {marks:?}");
                    assert!(marks.iter().all(|(value, _)| axis.has(*value)));
                }
            }
        }
    }
}
