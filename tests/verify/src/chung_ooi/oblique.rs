//! Test 4: oblique impact of a sphere upon a rigid plane.

use super::data::{AS_CURVES, KRATOS, Measured, NAME, Oblique, PAPER, digitised};
use crate::error::VerificationError;
use crate::lammps_impacts::{After, Impacts, Law};
use crate::restitution::damping_for;
use crate::row::{Measure, Point, Row};
use crate::two_spheres::{PLANE, TwoSpheres};
use grainlab_core::Vec3;

const RADIUS: f64 = 0.0025;
const SPEED: f64 = 3.9;
const FRICTION: f64 = 0.092;
const RESTITUTION: f64 = 0.98;
const TOLERANCE: f64 = 0.02;

const NOTE: &str = "At small angles the sphere sticks for part of the contact, and the result depends on the tangential spring. The \
                    paper's is the present stiffness times the whole displacement: LAMMPS with that law (mindlin) gives its curve. \
                    Ours adds up increments of force, scaled down on unloading: LAMMPS with this law \
                    (mindlin_rescale/force) gives ours.";

/// A quantity of a rebound.
#[derive(Clone, Copy)]
enum Quantity {
    /// v_t after over v_t before.
    Restitution,
    /// rad/s, as the paper counts it.
    Spin,
    /// Angle of the rebounding surface, degrees.
    Angle,
}

impl Quantity {
    /// Name and unit.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Restitution => ("tangential restitution", ""),
            Self::Spin => ("spin", "rad/s"),
            Self::Angle => ("rebound angle", "deg"),
        }
    }

    /// Value after an impact at this angle of incidence, degrees. Spin about +y moves the lowest point towards -x; the paper
    /// counts it the other way.
    fn of(self, after: After, angle: f64) -> f64 {
        match self {
            Self::Restitution => after.v_x / (SPEED * angle.to_radians().sin()),
            Self::Spin => -after.spin,
            Self::Angle => ((after.v_x - after.spin * RADIUS) / after.v_z).atan().to_degrees(),
        }
    }
}

/// The impact at an angle of incidence, degrees.
fn impact(case: &Oblique, angle: f64) -> Result<After, VerificationError> {
    let (sine, cosine) = angle.to_radians().sin_cos();
    let velocity = Vec3::new(SPEED * sine, 0.0, -SPEED * cosine);
    let solid = case.solid.upon_rigid();
    let upon = TwoSpheres::upon(solid, RADIUS, PLANE, velocity, Vec3::zeros()).in_steps(1000.0);
    let after = TwoSpheres { friction: FRICTION, damping: damping_for(RESTITUTION), ..upon }.collide()?;
    Ok(After { v_x: after.velocities[0].x, v_z: after.velocities[0].z, spin: after.spins[0].y })
}

pub(super) fn rows(
    material: usize,
    case: &Oblique,
    measured: &Measured,
    impacts: &Impacts,
) -> Result<Vec<Row>, VerificationError> {
    // Curve 0 of the impacts by LAMMPS is that of the paper, 1 and 2 are those of the experiment.
    let points = |quantity: Quantity, curve: usize, data: &mut dyn Iterator<Item = (f64, f64)>| {
        data.map(|(angle, theirs)| {
            let ours = quantity.of(impact(case, angle)?, angle);
            let by =
                |law| impacts.find([4, material, curve], angle, law).map(|after| quantity.of(after, angle));
            Ok(Point::explained(angle, theirs, ours, by(Law::Incremental)?, by(Law::Secant)?))
        })
        .collect::<Result<Vec<_>, VerificationError>>()
    };
    let mut rows = Vec::new();
    for (quantity, theirs) in [
        (Quantity::Restitution, &case.tangential_restitution),
        (Quantity::Spin, &case.spin),
        (Quantity::Angle, &case.rebound_angle),
    ] {
        let (what, unit) = quantity.words();
        let name = format!("test 4, {}, {what}", case.solid.name);
        let mut data = case.angles.iter().copied().zip(theirs.iter().copied()).peekable();
        if data.peek().is_some() {
            let points = points(quantity, 0, &mut data)?;
            let row = Row::new(NAME, name, digitised(4), unit, Measure::OfSum, TOLERANCE, points);
            rows.push(row.with_tolerance_from(KRATOS).with_note(NOTE));
        }
    }
    if case.spin.is_empty() {
        return Ok(rows);
    }
    for (curve, quantity, data) in
        [(1, Quantity::Restitution, &measured.tangential_restitution), (2, Quantity::Spin, &measured.spin)]
    {
        let (what, unit) = quantity.words();
        let points = points(quantity, curve, &mut data.iter().map(|[angle, value]| (*angle, *value)))?;
        let row = Row::new(
            NAME,
            format!("test 4, experiment, {what}"),
            format!("{PAPER}, Fig. 4: measured, as digitised there"),
            unit,
            Measure::OfSum,
            TOLERANCE,
            points,
        );
        let row = row.with_tolerance_from(AS_CURVES);
        rows.push(row.with_note("No curve of the paper goes through the measured points at small angles; LAMMPS with the same law gives ours."));
    }
    Ok(rows)
}
