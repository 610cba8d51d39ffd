//! Impacts of Chung & Ooi's tests by LAMMPS, which has the same tangential law, and another one.

use crate::error::VerificationError;
use crate::reference::table;

const FILE: &str = "lammps_impacts.csv";

/// A tangential law of LAMMPS.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Law {
    /// `mindlin_rescale/force`: increments of force, scaled down on unloading, as in the engine.
    Incremental,
    /// `mindlin`: the present stiffness times the whole displacement.
    Secant,
}

/// Velocities (m/s) and spin about y (rad/s) of the smaller sphere after an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct After {
    pub(crate) v_x: f64,
    pub(crate) v_z: f64,
    pub(crate) spin: f64,
}

/// Table of all impacts.
pub(crate) struct Impacts(Vec<Vec<f64>>);

impl Impacts {
    pub(crate) fn new() -> Result<Self, VerificationError> {
        let rows = table(FILE, include_str!("../data/lammps_impacts.csv"))?;
        if let Some(n) = rows.iter().position(|r| r.len() != 8) {
            return Err(VerificationError::Data { file: FILE, why: format!("row {n} has not 8 columns") });
        }
        Ok(Self(rows))
    }

    /// The impact of a test at an abscissa of a curve of its `material`-th material; curves are numbered in the file.
    pub(crate) fn find(
        &self,
        [test, material, curve]: [usize; 3],
        abscissa: f64,
        law: Law,
    ) -> Result<After, VerificationError> {
        let key = [test, material, curve].map(|k| k as f64);
        let law = if law == Law::Incremental { 0.0 } else { 1.0 };
        let row = self.0.iter().find(|r| r[..3] == key && r[3] == abscissa && r[4] == law);
        let row = row.ok_or_else(|| VerificationError::Data {
            file: FILE,
            why: format!("no impact of test {test}, material {material}, curve {curve}, at {abscissa}"),
        })?;
        Ok(After { v_x: row[5], v_z: row[6], spin: row[7] })
    }
}
