//! Tests 6, 7 and 8: a spinning sphere upon a plane and upon a larger sphere, and two that spin against each other.

use super::data::{CounterSpinning, KRATOS, NAME, PAPER, Spinning, digitised};
use crate::error::VerificationError;
use crate::lammps_impacts::{Impacts, Law};
use crate::restitution::{Damped, Springs, damping_for};
use crate::row::{Measure, Point, Row};
use crate::two_spheres::TwoSpheres;
use grainlab_core::Vec3;

const RADIUS: f64 = 0.1;
const SPEED: f64 = 0.2;
const FRICTION: f64 = 0.4;
const RESTITUTION: f64 = 0.5;

/// Up to this 3.5 μ (1 + e) v_n/v_t a sphere slides throughout.
const SLIDING: f64 = 1.0;

const HEAVY_NOTE: &str = " The larger sphere has 50 times the radius, not 5 times the radius and 1,000 times the density: all grains of a \
                          packing are of one density. The ratio of the masses is theirs.";

/// Tests 6 and 8: the rows of the `material`-th material of the test.
pub(super) fn rows(
    material: usize,
    case: &Spinning,
    impacts: &Impacts,
) -> Result<Vec<Row>, VerificationError> {
    let damping = damping_for(RESTITUTION);
    // A sliding surface changes its velocity by 3.5 μ times the impulse of the elastic force over the mass.
    let share = Damped::new(Springs::Hertz, damping).elastic_impulse / (1.0 + RESTITUTION);
    let (mut sliding, mut all, mut by_lammps) = (Vec::new(), Vec::new(), Vec::new());
    for [slip, theirs] in &case.beta {
        let surface = 3.5 * FRICTION * (1.0 + RESTITUTION) * SPEED / slip;
        let spin = Vec3::y() * (-surface / RADIUS);
        let solid = case.solid.upon_rigid();
        let upon = TwoSpheres::upon(solid, RADIUS, case.ratio, Vec3::z() * -SPEED, spin).in_steps(1000.0);
        let after = TwoSpheres { friction: FRICTION, damping, ..upon }.collide()?;
        let beta = -(after.velocities[0].x - after.spins[0].y * RADIUS) / surface;
        all.push(Point::new(*slip, *theirs, beta));
        let lammps = impacts.find([case.test as usize, material, 0], *slip, Law::Incremental)?;
        by_lammps.push(Point::new(*slip, *theirs, -(lammps.v_x - lammps.spin * RADIUS) / surface));
        if *slip < SLIDING {
            sliding.push(Point::explained(*slip, *theirs, beta, share * slip - 1.0, slip - 1.0));
        }
    }
    let name = |part: &str| format!("test {}, {}, surface restitution, {part}", case.test, case.solid.name);
    let row = |points| {
        let row = Row::new(NAME, name("sliding"), digitised(case.test), "", Measure::OfSum, 0.03, points);
        row.with_tolerance_from(KRATOS)
    };
    let heavy = if case.test == 8 { HEAVY_NOTE } else { "" };
    let percent = |points| 100.0 * row(points).difference().unwrap_or(f64::NAN);
    let sticking = format!(
        "Where the sphere sticks for part of the contact, the tangential dashpot counts, which the paper does not give, and Kratos judges \
         the sliding part alone. Over the whole curve ours differs by {:.0} % of the sum, LAMMPS with the same tangential spring by \
         {:.0} %.{heavy}",
        percent(all),
        percent(by_lammps)
    );
    let note = format!(
        "Our Coulomb limit is friction times the elastic normal force, without the dashpot: what slides transfers friction times the \
         impulse of that part, here {share:.3} of the whole impulse, which theirs has. Both are closed forms.{heavy}"
    );
    Ok(vec![
        row(sliding).with_note(note),
        Row::not_comparable(NAME, name("sticking"), digitised(case.test), sticking),
    ])
}

/// Rows of test 7.
pub(super) fn counter_spinning(case: &CounterSpinning) -> Result<Vec<Row>, VerificationError> {
    let (mut spins, mut tangential) = (Vec::new(), Vec::new());
    for spin in &case.spins {
        let spin_of = |sign: f64| Vec3::y() * (sign * spin);
        let pair = TwoSpheres::upon(case.solid.material(), RADIUS, 1.0, Vec3::z() * -SPEED, spin_of(1.0));
        let velocities = [Vec3::z() * -SPEED, Vec3::z() * SPEED];
        let pair = TwoSpheres { velocities, spins: [spin_of(1.0), spin_of(-1.0)], ..pair }.in_steps(1000.0);
        let pair = TwoSpheres { friction: FRICTION, damping: damping_for(RESTITUTION), ..pair };
        let after = pair.collide()?;
        spins.push(Point::new(*spin, *spin, after.spins[0].y));
        tangential.push(Point::new(*spin, 0.0, after.velocities[0].x));
    }
    let row = |what: &str, unit, measure, points| {
        let name = format!("test 7, {}, {what}", case.solid.name);
        let source = format!("{PAPER}, test 7: opposite spins have no slip");
        Row::new(NAME, name, source, unit, measure, 1e-12, points)
    };
    Ok(vec![
        row("spin after", "rad/s", Measure::Relative, spins),
        row("tangential velocity after", "m/s", Measure::Absolute, tangential),
    ])
}
