//! Rows of time against error: one method at one setting.

use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Quantities whose errors are comparable: a front each. In the order of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Family {
    /// Contact anisotropy inferred from moduli.
    InversionEps,
    /// Coordination inferred from moduli.
    InversionZ,
    /// The stiffness of the contact network.
    Stiffness,
    /// Energy created by the time step of the engine.
    EngineEnergy,
    /// Packings prepared by the engine.
    EnginePacking,
    /// Wave speeds of packings.
    Waves,
}

impl Family {
    /// Name in tables and legends, the workload that is timed, and the quantity whose error is given.
    pub(crate) fn words(self) -> [&'static str; 3] {
        let (one, run) = ("one state, uncertainty included", "a run from a gas to 50 kPa");
        let created =
            "energy created by the time step, over the largest term of the balance, rms of the seeds";
        let packing = "k, eps, phi, G12 and Theta of the packing, over their scatter from seed to seed, rms";
        let speeds = "all speeds of a packing, its preparation included";
        match self {
            Self::InversionEps => ["inversion, eps", one, "contact anisotropy, rms"],
            Self::InversionZ => ["inversion, z", one, "coordination without rattlers, rms"],
            Self::Stiffness => ["stiffness", "all 21 constants, network included", "largest entry, over C11"],
            Self::EngineEnergy => ["engine, energy", run, created],
            Self::EnginePacking => ["engine, packing", run, packing],
            Self::Waves => ["waves", speeds, "rho v^2, relative, rms"],
        }
    }

    pub(crate) fn name(self) -> &'static str {
        self.words()[0]
    }
}

/// One method at one setting.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) family: Family,
    pub(crate) method: String,
    /// The value that is varied, or empty.
    pub(crate) setting: String,
    pub(crate) grains: Option<usize>,
    /// CPU time of all threads, median, s.
    pub(crate) seconds: f64,
    /// Measurements of the time.
    pub(crate) repetitions: usize,
    /// Pure number; `None` without a result.
    pub(crate) error: Option<f64>,
    /// True for an error only known to be less than that.
    pub(crate) upper_bound: bool,
    pub(crate) error_of: &'static str,
    pub(crate) time_of: &'static str,
    pub(crate) reference: &'static str,
    /// True if no other row of the family with as many grains is as fast and as accurate, and better in one of the two.
    pub(crate) on_front: bool,
    /// Why there is no result, or a part of it is missing.
    pub(crate) failure: Option<String>,
    /// Further numbers, by name.
    #[serde(flatten)]
    pub(crate) details: BTreeMap<&'static str, f64>,
}

impl Row {
    pub(crate) fn new(
        family: Family,
        (method, setting): (impl Into<String>, impl Into<String>),
        (seconds, repetitions): (f64, usize),
        (error, reference): (Option<f64>, &'static str),
    ) -> Self {
        let [_, time_of, error_of] = family.words();
        Self {
            family,
            method: method.into(),
            setting: setting.into(),
            grains: None,
            seconds,
            repetitions,
            error,
            upper_bound: false,
            error_of,
            time_of,
            reference,
            on_front: false,
            failure: None,
            details: BTreeMap::new(),
        }
    }

    /// Time and error; `None` without a result.
    pub(crate) fn point(&self) -> Option<(f64, f64)> {
        self.error.map(|error| (self.seconds, error)).filter(|p| p.0.is_finite() && p.1.is_finite())
    }
}

pub(crate) fn families(rows: &[Row]) -> BTreeSet<Family> {
    rows.iter().map(|row| row.family).collect()
}

/// Marks the rows that no comparable row beats in both time and error; equal rows share a place.
pub(crate) fn mark_fronts(rows: &mut [Row]) {
    let beats = |a: &Row, b: &Row| {
        (a.family, a.grains) == (b.family, b.grains)
            && a.point().zip(b.point()).is_some_and(|(a, b)| a.0 <= b.0 && a.1 <= b.1 && a != b)
    };
    let on = |row: &Row| row.point().is_some() && !rows.iter().any(|other| beats(other, row));
    let marks: Vec<bool> = rows.iter().map(on).collect();
    rows.iter_mut().zip(marks).for_each(|(row, on)| row.on_front = on);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marked(points: &[(Family, f64, f64)]) -> Vec<bool> {
        let row = |(family, seconds, error): &(Family, f64, f64)| {
            Row::new(*family, ("method", ""), (*seconds, 1), (Some(*error), "the truth"))
        };
        let mut rows: Vec<Row> = points.iter().map(row).collect();
        mark_fronts(&mut rows);
        rows.iter().map(|r| r.on_front).collect()
    }

    fn front(points: &[(f64, f64)]) -> Vec<bool> {
        marked(&points.iter().map(|p| (Family::Waves, p.0, p.1)).collect::<Vec<_>>())
    }

    #[test]
    fn a_point_is_off_the_front_once_another_is_faster_and_more_accurate() {
        let points = [(1.0, 4.0), (2.0, 2.0), (3.0, 3.0), (4.0, 1.0), (5.0, 1.0)];
        assert_eq!(front(&points), [true, true, false, true, false]);
    }

    #[test]
    fn equal_points_share_their_place() {
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0), (1.0, 2.0)]), [true, true, false]);
    }

    #[test]
    fn a_setting_without_a_result_is_not_on_the_front_and_excludes_no_other() {
        assert_eq!(front(&[(f64::NAN, 0.0), (1.0, f64::NAN), (2.0, 2.0)]), [false, false, true]);
        assert!(front(&[]).is_empty());
    }

    #[test]
    fn a_row_is_on_the_front_of_its_own_family_whatever_others_take() {
        let (waves, stiffness) = (Family::Waves, Family::Stiffness);
        let rows =
            [(waves, 1.0, 1e-3), (stiffness, 2.0, 1e-2), (stiffness, 3.0, 1e-1), (stiffness, 3.0, 1e-4)];
        assert_eq!(marked(&rows), [true, true, false, true]);
    }
}
