//! Tests 4 and 5: oblique impact of a sphere upon a rigid plane.

use super::data::{Measured, Microscopic, Oblique, Solid};
use super::{NAME, PAPER, digitised};
use crate::error::VerificationError;
use crate::restitution::damping_for;
use crate::row::{Measure, Point, Row};
use crate::two_spheres::{Collision, PLANE, TwoSpheres};
use grainlab_core::Vec3;

/// Test 4: radius (m), speed (m/s), friction, restitution.
const OBLIQUE: Impact = Impact { radius: 0.0025, friction: 0.092, restitution: 0.98 };
const SPEED: f64 = 3.9;

/// Test 5, with the normal speed, m/s.
const MICROSCOPIC: Impact = Impact { radius: 1e-5, friction: 0.3, restitution: 1.0 };
const NORMAL_SPEED: f64 = 5.0;

/// From this v_t/(μ v_n) on, a sphere of restitution 1 slides throughout.
const SLIDING: f64 = 7.0;

struct Impact {
    radius: f64,
    friction: f64,
    restitution: f64,
}

impl Impact {
    fn upon_plane(&self, solid: &Solid, velocity: Vec3) -> Result<Collision, VerificationError> {
        let spheres = TwoSpheres::upon(solid.upon_rigid(), self.radius, PLANE, velocity, Vec3::zeros());
        let spheres = spheres.in_steps(1000.0);
        TwoSpheres { friction: self.friction, damping: damping_for(self.restitution), ..spheres }.collide()
    }
}

/// e_t, spin (rad/s) and rebound angle of the surface (degrees) of test 4, for an angle of incidence in degrees.
fn rebound(solid: &Solid, angle: f64) -> Result<[f64; 3], VerificationError> {
    let (sine, cosine) = angle.to_radians().sin_cos();
    let after = OBLIQUE.upon_plane(solid, Vec3::new(SPEED * sine, 0.0, -SPEED * cosine))?;
    // Spin about +y moves the lowest point towards -x; the paper counts it the other way.
    let (v, w) = (after.velocities[0], after.spins[0].y);
    let surface = v.x - w * OBLIQUE.radius;
    Ok([v.x / (SPEED * sine), -w, (surface / v.z).atan().to_degrees()])
}

pub(super) fn rows(case: &Oblique, measured: &Measured) -> Result<Vec<Row>, VerificationError> {
    let found = case.angles.iter().map(|a| rebound(&case.solid, *a)).collect::<Result<Vec<_>, _>>()?;
    let row = |what: &str, unit, theirs: &[f64], quantity: usize| {
        let points = case.angles.iter().zip(theirs).zip(&found);
        let points = points.map(|((angle, theirs), ours)| Point::new(*angle, *theirs, ours[quantity])).collect();
        let name = format!("test 4, {}, {what}", case.solid.name);
        Row::new(NAME, name, digitised(4), unit, Measure::OfSum, 0.02, points)
    };
    let mut rows = vec![row("tangential restitution", "", &case.tangential_restitution, 0)];
    if case.spin.is_empty() {
        return Ok(rows);
    }
    rows.push(row("spin", "rad/s", &case.spin, 1));
    rows.push(row("rebound angle", "degrees", &case.rebound_angle, 2));
    for (what, unit, quantity, curve) in
        [("tangential restitution", "", 0, &measured.tangential_restitution), ("spin", "rad/s", 1, &measured.spin)]
    {
        let mut points = Vec::new();
        for [angle, theirs] in curve {
            points.push(Point::new(*angle, *theirs, rebound(&case.solid, *angle)?[quantity]));
        }
        let name = format!("test 4, experiment, {what}");
        let source = format!("{PAPER}, Fig. 4: measured");
        let row = Row::new(NAME, name, source, unit, Measure::OfSum, 0.06, points);
        rows.push(row.with_note("The experiment scatters by some percent around every curve of the paper."));
    }
    Ok(rows)
}

/// Test 5.
pub(super) fn microscopic(case: &Microscopic) -> Result<Vec<Row>, VerificationError> {
    let unit = MICROSCOPIC.friction * NORMAL_SPEED;
    // Of the surface, and R times the spin, over μ v_n.
    let found = |incidence: f64| -> Result<[f64; 2], VerificationError> {
        let velocity = Vec3::new(incidence * unit, 0.0, -NORMAL_SPEED);
        let after = MICROSCOPIC.upon_plane(&case.solid, velocity)?;
        let turning = after.spins[0].y * MICROSCOPIC.radius;
        Ok([(after.velocities[0].x - turning) / (MICROSCOPIC.friction * after.velocities[0].z), -turning / unit])
    };
    let mut rows = Vec::new();
    for (what, curve, quantity) in [("surface after", &case.surface, 0), ("spin after", &case.spin, 1)] {
        let (mut sliding, mut all) = (Vec::new(), Vec::new());
        for [incidence, theirs] in curve {
            let point = Point::new(*incidence, *theirs, found(*incidence)?[quantity]);
            all.push(point);
            if *incidence > SLIDING {
                sliding.push(point);
            }
        }
        for (part, tolerance, points) in [("sliding", 0.02, sliding), ("all", 0.08, all)] {
            let name = format!("test 5, {}, {what}, {part}", case.solid.name);
            rows.push(Row::new(NAME, name, digitised(5), "", Measure::OfSum, tolerance, points));
        }
    }
    Ok(rows)
}
