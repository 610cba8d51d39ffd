//! One comparison: their numbers, ours, and what follows.

use serde::Serialize;

/// One number of theirs and of ours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Position along the comparison: an angle, an overlap, a step. The row says which.
    pub at: f64,
    /// Number of the source.
    pub theirs: f64,
    /// Number of this program.
    pub ours: f64,
    /// Expected number of this program for the reason in the note of the row, where it should not be theirs.
    pub explained: Option<f64>,
    /// Expected number of the source for that reason, by a computation that is neither theirs nor ours.
    pub reproduced: Option<f64>,
}

impl Point {
    /// A number that should be theirs.
    pub fn new(at: f64, theirs: f64, ours: f64) -> Self {
        Self { at, theirs, ours, explained: None, reproduced: None }
    }

    /// A number that should be `own`, by the law of this program from elsewhere: that it is explains ours, and not theirs.
    pub fn by_own_law(at: f64, theirs: f64, ours: f64, own: f64) -> Self {
        Self { explained: Some(own), ..Self::new(at, theirs, ours) }
    }

    /// A number that should be `explained`, for the reason in the note of the row, for which theirs should be `reproduced`.
    pub fn explained(at: f64, theirs: f64, ours: f64, explained: f64, reproduced: f64) -> Self {
        Self { reproduced: Some(reproduced), ..Self::by_own_law(at, theirs, ours, explained) }
    }
}

/// Measure of the difference of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// The largest relative difference.
    Relative,
    /// The largest difference over the largest magnitude of theirs.
    OfLargest,
    /// The sum of the differences over the sum of the magnitudes of theirs, as Kratos judges the curves of Chung & Ooi.
    OfSum,
    /// The largest difference, in the unit of the row.
    Absolute,
}

impl Measure {
    /// The word in the table.
    pub fn word(self) -> &'static str {
        match self {
            Self::Relative => "relative",
            Self::OfLargest => "of largest",
            Self::OfSum => "of sum",
            Self::Absolute => "absolute",
        }
    }
}

/// The verdict on a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Within the tolerance.
    Passed,
    /// Not within the tolerance, for a known difference: with it, a computation of neither side gives their number, and without
    /// it ours, both within the tolerance.
    Explained,
    /// Not within the tolerance, for a reason that the note states. Either ours is what the law of this program gives, and nothing
    /// reproduces theirs; or the numbers of the source scatter more than their stated errors.
    Differs,
    /// The engine lacks what the comparison needs; the note says what.
    NotComparable,
    /// Outside the tolerance, without an explanation.
    Failed,
}

impl Verdict {
    /// The word in the table.
    pub fn word(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Explained => "explained",
            Self::Differs => "DIFFERS",
            Self::NotComparable => "not comparable",
            Self::Failed => "FAILED",
        }
    }
}

/// One comparison of numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The suite it belongs to, as in `--only`.
    pub suite: &'static str,
    /// The quantity that is compared.
    pub name: String,
    /// Source of their numbers.
    pub source: String,
    /// Unit of the numbers; empty for a pure number.
    pub unit: &'static str,
    /// The numbers; none if the engine lacks what is needed.
    pub points: Vec<Point>,
    /// Measure of the difference.
    pub measure: Measure,
    /// The largest difference that passes.
    pub tolerance: f64,
    /// Where the tolerance comes from. Empty for a bound on rounding, or on the error of a time step, that the difference is far below.
    pub tolerance_from: &'static str,
    /// The largest difference that the note explains without a computation; a larger one fails. `None` where there is no such note.
    pub known: Option<f64>,
    /// Known difference with its reason; empty where nothing differs.
    pub note: String,
}

impl Row {
    /// A row without a note.
    pub fn new(
        suite: &'static str,
        name: impl Into<String>,
        source: impl Into<String>,
        unit: &'static str,
        measure: Measure,
        tolerance: f64,
        points: Vec<Point>,
    ) -> Self {
        let (name, source, note) = (name.into(), source.into(), String::new());
        Self { suite, name, source, unit, points, measure, tolerance, tolerance_from: "", known: None, note }
    }

    /// A comparison that needs what the engine lacks: `note` says what.
    pub fn not_comparable(
        suite: &'static str,
        name: impl Into<String>,
        source: impl Into<String>,
        note: impl Into<String>,
    ) -> Self {
        Self::new(suite, name, source, "", Measure::Relative, 0.0, Vec::new()).with_note(note)
    }

    /// This row with a note.
    #[must_use]
    pub fn with_note(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }

    /// This row with the source of its tolerance.
    #[must_use]
    pub fn with_tolerance_from(self, tolerance_from: &'static str) -> Self {
        Self { tolerance_from, ..self }
    }

    /// This row with a note on numbers of the source that scatter more than the tolerance, up to a difference of `known`.
    #[must_use]
    pub fn with_known_difference(self, known: f64, note: impl Into<String>) -> Self {
        Self { known: Some(known), ..self }.with_note(note)
    }

    /// The difference from their numbers; `None` where nothing is compared.
    pub fn difference(&self) -> Option<f64> {
        self.against(|p| p.ours, |p| p.theirs)
    }

    /// The difference from the explained numbers; `None` where no number is explained.
    pub fn unexplained(&self) -> Option<f64> {
        let explained = self.points.iter().any(|p| p.explained.is_some());
        explained.then(|| self.against(|p| p.ours, |p| p.explained.unwrap_or(p.theirs))).flatten()
    }

    /// The difference of the reproduced numbers from theirs; `None` where a number that is explained is not reproduced.
    pub fn unreproduced(&self) -> Option<f64> {
        let mut explained = self.points.iter().filter(|p| p.explained.is_some()).peekable();
        let reproduced = explained.peek().is_some() && explained.all(|p| p.reproduced.is_some());
        reproduced.then(|| self.against(|p| p.reproduced.unwrap_or(p.theirs), |p| p.theirs)).flatten()
    }

    /// Verdict on the row.
    pub fn verdict(&self) -> Verdict {
        // A difference that is not a number is no pass.
        let within = |difference: f64| difference <= self.tolerance;
        match (self.difference(), self.unexplained()) {
            (None, _) => Verdict::NotComparable,
            (Some(d), _) if within(d) => Verdict::Passed,
            (_, Some(d)) if within(d) && self.unreproduced().is_some_and(within) => Verdict::Explained,
            (_, Some(d)) if within(d) => Verdict::Differs,
            (Some(d), _) if self.known.is_some_and(|known| d <= known) => Verdict::Differs,
            _ => Verdict::Failed,
        }
    }

    /// The point of the largest difference.
    pub fn worst(&self) -> Option<&Point> {
        let size = |p: &Point| {
            let difference = (p.ours - p.theirs).abs();
            if self.measure == Measure::Relative { difference / p.theirs.abs() } else { difference }
        };
        self.points.iter().max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// Ours minus theirs at the [worst](Self::worst) point, as the measure scales it: in the unit of the row for
    /// [`Measure::Absolute`], over the largest magnitude of theirs for [`Measure::OfLargest`], else over theirs at that point.
    /// `None` where nothing is compared.
    pub fn worst_residual(&self) -> Option<f64> {
        let worst = self.worst()?;
        let difference = worst.ours - worst.theirs;
        let scale = match self.measure {
            Measure::Absolute => return Some(difference),
            Measure::OfLargest => self.points.iter().map(|p| p.theirs.abs()).fold(0.0, f64::max),
            Measure::Relative | Measure::OfSum => worst.theirs.abs(),
        };
        Some(if difference == 0.0 { 0.0 } else { difference / scale })
    }

    fn against(&self, found: impl Fn(&Point) -> f64, wanted: impl Fn(&Point) -> f64) -> Option<f64> {
        if self.points.is_empty() {
            return None;
        }
        // `f64::max` would drop what is not a number.
        let largest = |of: &dyn Fn(&Point) -> f64| {
            self.points.iter().map(of).fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
        };
        let sum = |of: &dyn Fn(&Point) -> f64| self.points.iter().map(of).sum::<f64>();
        let difference = |p: &Point| (found(p) - wanted(p)).abs();
        let size = |p: &Point| wanted(p).abs();
        Some(match self.measure {
            Measure::Relative => {
                largest(&|p| if difference(p) == 0.0 { 0.0 } else { difference(p) / size(p) })
            }
            Measure::OfLargest => largest(&difference) / largest(&size),
            Measure::OfSum => sum(&difference) / sum(&size),
            Measure::Absolute => largest(&difference),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(measure: Measure, tolerance: f64, points: Vec<Point>) -> Row {
        Row::new("suite", "name", "source", "m", measure, tolerance, points)
    }

    #[test]
    fn each_measure_counts_the_difference_as_it_says() {
        let points = vec![Point::new(0.0, 1.0, 1.1), Point::new(1.0, -10.0, -9.5)];
        for (measure, expected) in [
            (Measure::Relative, 0.1),
            (Measure::OfLargest, 0.05),
            (Measure::OfSum, 0.6 / 11.0),
            (Measure::Absolute, 0.5),
        ] {
            let found = row(measure, 0.0, points.clone()).difference().unwrap();
            assert!((found - expected).abs() < 1e-12, "{measure:?}: {found}");
        }
    }

    /// The numbers of the beads whose speeds are compared: the difference of their sums is much smaller than the worst one.
    #[test]
    fn the_residual_of_the_worst_point_is_not_the_sum_over_all_points() {
        let points = vec![Point::new(0.0, 800.0, 840.0), Point::new(1.0, 1200.0, 1200.0)];
        let of = |measure| row(measure, 0.1, points.clone());
        assert_eq!(of(Measure::OfSum).difference(), Some(0.02));
        for (measure, expected) in [
            (Measure::OfSum, 0.05),
            (Measure::Relative, 0.05),
            (Measure::OfLargest, 40.0 / 1200.0),
            (Measure::Absolute, 40.0),
        ] {
            assert_eq!(of(measure).worst_residual(), Some(expected), "{measure:?}");
        }
        assert_eq!(Row::not_comparable("s", "n", "s", "no walls").worst_residual(), None);
    }

    #[test]
    fn a_known_difference_beyond_the_tolerance_differs_and_a_larger_one_fails() {
        let of = |ours| {
            row(Measure::Relative, 0.01, vec![Point::new(0.0, 1.0, ours)]).with_known_difference(0.03, "Why.")
        };
        assert_eq!(of(1.005).verdict(), Verdict::Passed);
        assert_eq!(of(1.02).verdict(), Verdict::Differs);
        assert_eq!(of(1.04).verdict(), Verdict::Failed);
        assert_eq!(of(f64::NAN).verdict(), Verdict::Failed);
    }

    #[test]
    fn a_row_passes_within_its_tolerance_and_else_only_by_its_explanation() {
        let of = |point| row(Measure::Relative, 0.01, vec![point]).verdict();
        assert_eq!(of(Point::new(0.0, 1.0, 1.005)), Verdict::Passed);
        assert_eq!(of(Point::new(0.0, 1.0, 1.5)), Verdict::Failed);
        assert_eq!(of(Point::explained(0.0, 1.0, 1.5, 1.501, 1.001)), Verdict::Explained);
        assert_eq!(of(Point::explained(0.0, 1.0, 1.6, 1.501, 1.001)), Verdict::Failed);
        // A number by our own law, or with a reason that does not give theirs, explains nothing.
        assert_eq!(of(Point::by_own_law(0.0, 1.0, 1.5, 1.501)), Verdict::Differs);
        assert_eq!(of(Point::explained(0.0, 1.0, 1.5, 1.501, 1.1)), Verdict::Differs);
        assert_eq!(of(Point::by_own_law(0.0, 1.0, 1.6, 1.501)), Verdict::Failed);
        assert_eq!(of(Point::new(0.0, 1.0, f64::NAN)), Verdict::Failed);
        assert_eq!(Row::not_comparable("s", "n", "s", "no walls").verdict(), Verdict::NotComparable);
    }
}
