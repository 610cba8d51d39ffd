//! The stiffness of smooth spheres compared with matscipy, which derives it from a pair potential.

use crate::error::VerificationError;
use crate::reference::table;
use crate::row::{Measure, Point, Row};
use grainlab_core::{Packing, Stiffness};
use grainlab_micromechanics::network::Springs;
use grainlab_micromechanics::{Settings, analyze};

/// The name of the suite.
pub const NAME: &str = "smooth-moduli";

/// The rows of a packing of equal smooth spheres. `matscipy`: twelve rows of six moduli, Pa, as `tests/tools/matscipy_moduli.py` writes
/// them.
pub fn rows(packing: &Packing, matscipy: &str) -> Result<Vec<Row>, VerificationError> {
    let theirs = table("smooth_500_matscipy.csv", matscipy)?;
    let cases = [
        ("springs alone", Springs::Normal),
        ("with the term of the normal forces", Springs::PrestressedNormal),
    ];
    let mut rows = Vec::new();
    for ((what, springs), theirs) in cases.into_iter().zip(theirs.chunks(6)) {
        let settings = Settings { springs, ..Settings::default() };
        let report =
            analyze(packing, &settings).map_err(|e| VerificationError::Measurement(e.to_string()))?.report;
        let found = report.elasticity;
        let found = found.map_err(|why| VerificationError::Measurement(format!("smooth spheres: {why}")))?;
        let theirs: Vec<f64> = theirs.iter().flatten().copied().collect();
        let energy = theirs.first_chunk().map(Stiffness::from_row_major);
        let energy = energy.ok_or_else(|| VerificationError::Measurement("fewer than 36 moduli".into()))?;
        // Theirs are second derivatives of the energy, ours derivatives of the Cauchy stress.
        let theirs = match springs {
            Springs::PrestressedNormal => energy.of_cauchy_stress(&report.stress.tensor),
            _ => energy,
        };
        let points = theirs.row_major().into_iter().zip(found.tensor.row_major()).enumerate();
        let points = points.map(|(n, (t, o))| Point::new(n as f64, t, o)).collect();
        let name = format!("500 smooth spheres, 36 moduli, {what}");
        let source = "matscipy 1.3.1, by tests/tools/matscipy_moduli.py";
        rows.push(Row::new(NAME, name, source, "Pa", Measure::OfLargest, 1e-8, points));
    }
    Ok(rows)
}
