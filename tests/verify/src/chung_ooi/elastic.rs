//! Tests 1 and 2: elastic normal impact of two spheres, and of a sphere upon a rigid plane.

use super::data::{Elastic, KRATOS, NAME, digitised};
use crate::error::VerificationError;
use crate::row::{Measure, Point, Row};
use crate::two_spheres::{PLANE, TwoSpheres};
use grainlab_core::Vec3;

/// Steps of a collision.
const STEPS: f64 = 4000.0;

pub(super) fn rows(case: &Elastic) -> Result<Vec<Row>, VerificationError> {
    let zero = Vec3::zeros();
    let spheres = match case.test {
        1 => {
            let pair = TwoSpheres::upon(case.solid.material(), 0.01, 1.0, Vec3::z() * -10.0, zero);
            TwoSpheres { velocities: [Vec3::z() * -10.0, Vec3::z() * 10.0], ..pair }
        }
        _ => TwoSpheres::upon(case.solid.upon_rigid(), 0.1, PLANE, Vec3::z() * -0.2, zero),
    };
    let spheres = spheres.in_steps(STEPS);
    let (hertz, found) = (spheres.hertz(), spheres.collide()?);
    let row = |what: &str, source: String, unit, measure, tolerance, points| {
        let name = format!("test {}, {}, {what}", case.test, case.solid.name);
        Row::new(NAME, name, source, unit, measure, tolerance, points)
    };
    let closed = || "Hertz (1881), closed form".to_owned();
    let one = |theirs, ours| vec![Point::new(0.0, theirs, ours)];
    // The duration is a whole number of steps.
    let mut rows = vec![
        row("deepest overlap", closed(), "m", Measure::Relative, 1e-5, one(hertz.overlap, found.deepest())),
        row("largest force", closed(), "N", Measure::Relative, 1e-5, one(hertz.force, found.largest_force())),
        row("duration", closed(), "s", Measure::Relative, 1e-3, one(hertz.duration, found.duration)),
    ];
    if !case.path.is_empty() {
        let point = |[overlap, force]: &[f64; 2]| {
            let overlap = 1e-6 * overlap;
            let closed = hertz.force * (overlap / hertz.overlap).min(1.0).powf(1.5);
            Point::by_own_law(overlap, 1e3 * force, found.force_at(overlap), closed)
        };
        let points = case.path.iter().map(point).collect();
        let row = row("force by overlap", digitised(case.test), "N", Measure::OfSum, 0.01, points);
        let row = row.with_tolerance_from(KRATOS);
        rows.push(row.with_note(
            "The digitised points scatter about Hertz's law by up to some percent. Ours is that law in closed form.",
        ));
    }
    Ok(rows)
}
