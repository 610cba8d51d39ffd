//! Test 3: the coefficient of restitution that comes out, for the one that is set.

use super::data::{NAME, PAPER, Solid};
use crate::error::VerificationError;
use crate::restitution::{Damped, Springs, damping_for};
use crate::row::{Measure, Point, Row};
use crate::two_spheres::{PLANE, TwoSpheres};
use grainlab_core::Vec3;

/// Speed of approach, m/s.
const SPEED: f64 = 3.9;

/// Coefficients of restitution that are set; lower ones take more than critical damping.
const SET: [f64; 9] = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];

pub(super) fn row(solid: &Solid) -> Result<Row, VerificationError> {
    let mut points = Vec::new();
    for e in SET {
        let velocity = Vec3::z() * -SPEED;
        let spheres = TwoSpheres::upon(solid.upon_rigid(), 0.0025, PLANE, velocity, Vec3::zeros());
        let found = TwoSpheres { damping: damping_for(e), ..spheres.in_steps(2000.0) }.collide()?;
        points.push(Point::new(e, e, found.velocities[0].z / SPEED));
    }
    let name = format!("test 3, {}, restitution", solid.name);
    let source = format!("{PAPER}, test 3: what is set comes out");
    Ok(Row::new(NAME, name, source, "", Measure::Relative, 0.01, points)
        .with_note("The damping for each restitution is that of the equation of motion of a Hertzian contact without attraction."))
}

/// The restitution that no damping gives.
pub(super) fn perfectly_plastic() -> Row {
    let least = Damped::new(Springs::Hertz, 1.0).restitution;
    let note = format!(
        "A dashpot always gives some speed back: at critical damping, the largest that scenes have, {least:.3} of it. There is no \
         plastic contact law."
    );
    Row::not_comparable(NAME, "test 3, restitution 0", format!("{PAPER}, test 3"), note)
}
