//! A long series with few points, made while the series is read.

type TimedValue = (f64, f64);

/// A series as the extremes of bins of equal width in time, with at most four points each: first, least, greatest and last.
/// The width doubles when the series becomes too long for the bins.
#[derive(Clone, Debug)]
pub(crate) struct Decimated {
    /// Most bins. One is about a pixel of a plot.
    most: usize,
    /// Time of the left end of the first bin.
    start: f64,
    /// Width of a bin; 0 until a second time is known.
    width: f64,
    bins: Vec<Option<Bin>>,
    count: usize,
}

#[derive(Clone, Copy, Debug)]
struct Bin {
    first: TimedValue,
    least: TimedValue,
    greatest: TimedValue,
    last: TimedValue,
}

impl Bin {
    fn of(at: TimedValue) -> Self {
        Self { first: at, least: at, greatest: at, last: at }
    }

    fn and(self, later: Self) -> Self {
        let least = if later.least.1 < self.least.1 { later.least } else { self.least };
        let greatest = if later.greatest.1 > self.greatest.1 { later.greatest } else { self.greatest };
        Self { first: self.first, least, greatest, last: later.last }
    }
}

impl Decimated {
    /// Without values, for at most this number of bins, two or more.
    pub(crate) fn new(most: usize) -> Self {
        Self { most: most.max(2), start: 0.0, width: 0.0, bins: Vec::new(), count: 0 }
    }

    /// Adds a value. Times do not decrease; values that are not finite, and earlier times, are left out.
    pub(crate) fn push(&mut self, time: f64, value: f64) {
        let newest = self.bins.iter().rev().find_map(|b| b.as_ref()).map(|b| b.last.0);
        if !time.is_finite() || !value.is_finite() || newest.is_some_and(|t| time < t) {
            return;
        }
        self.count += 1;
        let one = Bin::of((time, value));
        if self.bins.is_empty() {
            self.start = time;
            self.bins.push(Some(one));
            return;
        }
        if self.width == 0.0 && time > self.start {
            // The second time is in the last bin: however long the first interval, later ones have bins of their own.
            self.width = (time - self.start) / (self.most - 1) as f64;
        }
        while self.place(time) >= self.most {
            self.halve();
        }
        let place = self.place(time);
        if self.bins.len() <= place {
            self.bins.resize(place + 1, None);
        }
        self.bins[place] = Some(self.bins[place].map_or(one, |known| known.and(one)));
    }

    fn place(&self, time: f64) -> usize {
        if self.width > 0.0 { ((time - self.start) / self.width) as usize } else { 0 }
    }

    fn halve(&mut self) {
        let join = |pair: &[Option<Bin>]| match *pair {
            [Some(a), Some(b)] => Some(a.and(b)),
            [a, b] => a.or(b),
            [a] => a,
            _ => None,
        };
        self.bins = self.bins.chunks(2).map(join).collect();
        self.width *= 2.0;
    }

    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The points in order of time.
    pub(crate) fn points(&self) -> Vec<TimedValue> {
        let mut points = Vec::with_capacity(4 * self.bins.len());
        for bin in self.bins.iter().flatten() {
            let (early, late) = if bin.least.0 <= bin.greatest.0 {
                (bin.least, bin.greatest)
            } else {
                (bin.greatest, bin.least)
            };
            for at in [bin.first, early, late, bin.last] {
                if points.last() != Some(&at) {
                    points.push(at);
                }
            }
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: impl Iterator<Item = TimedValue>) -> Decimated {
        let mut series = Decimated::new(500);
        values.for_each(|(t, v)| series.push(t, v));
        series
    }

    #[test]
    fn a_long_series_keeps_its_ends_and_its_extremes_at_their_times() {
        let value = |n: u32| match n {
            70_001 => 9.0,
            31_337 => -9.0,
            n => f64::from(n).sin(),
        };
        let points = of((0..100_000).map(|n| (1e-6 * f64::from(n), value(n)))).points();
        assert!((500..=2000).contains(&points.len()), "{}", points.len());
        assert_eq!((points[0], points[points.len() - 1]), ((0.0, 0.0), (1e-6 * 99_999.0, value(99_999))));
        assert!(points.contains(&(1e-6 * 70_001.0, 9.0)) && points.contains(&(1e-6 * 31_337.0, -9.0)));
        assert!(points.windows(2).all(|pair| pair[0].0 <= pair[1].0), "in order of time");
    }

    #[test]
    fn a_short_series_is_kept_whole() {
        let all: Vec<TimedValue> = (0..40).map(|n| (f64::from(n), f64::from(n * n))).collect();
        assert_eq!(of(all.iter().copied()).points(), all);
    }

    #[test]
    fn numbers_that_are_not_finite_and_times_that_go_back_are_left_out() {
        let series =
            of([(0.0, 1.0), (f64::NAN, 2.0), (1.0, f64::INFINITY), (2.0, 3.0), (1.5, 4.0), (2.0, 5.0)]
                .into_iter());
        assert_eq!(series.points(), [(0.0, 1.0), (2.0, 3.0), (2.0, 5.0)]);
        assert_eq!(series.count(), 3);
    }

    #[test]
    fn a_long_first_interval_does_not_coarsen_what_follows() {
        let dense = (0..100_000).map(|n| (1.0 + 1e-5 * f64::from(n), f64::from(n % 7)));
        let series = of(std::iter::once((0.0, 0.0)).chain(dense));
        assert!(series.points().len() > 500, "{}", series.points().len());
    }

    #[test]
    fn a_pause_of_any_length_fits() {
        let points = of([(0.0, 1.0), (1e-9, 2.0), (1e9, 3.0), (2e9, 4.0)].into_iter()).points();
        assert_eq!((points[0], points[points.len() - 1]), ((0.0, 1.0), (2e9, 4.0)));
    }
}
