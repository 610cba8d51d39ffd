//! Linear springs under the prescribed motions of ON-DEM (COST action CA22132, working group 4).

use crate::error::VerificationError;
use crate::forced_contact::{ForcedContact, Move};
use crate::reference::table;
use crate::row::{Measure, Point, Row};
use grainlab_core::Vec3;
use grainlab_core::contact::{Linear, SpringDashpotSlider};
use nalgebra::{Rotation3, Unit};

/// The name of the suite.
pub const NAME: &str = "ondem";

/// R (m), distance of the centres (m), k_n (N/m), k_t/k_n, friction.
const RADIUS: f64 = 1.0;
const DISTANCE: f64 = 1.95;
const STIFFNESS: f64 = 1e7;
const RATIO: f64 = 0.5;
const FRICTION: f64 = 0.5;

/// Time step, s.
const STEP: f64 = 6.0 * std::f64::consts::PI / 200.0;

const SOURCE: &str = "ON-DEM WG4 (ON-DEM-WG4-testingInteractions 9299158)";

/// Rows of the suite.
pub fn rows() -> Result<Vec<Row>, VerificationError> {
    Ok([
        elastic()?,
        vec![plastic(), turned("out of the plane", Vec3::y()), turned("in the plane", Vec3::z())],
        missing(),
    ]
    .concat())
}

fn contact(steps_per_step: f64) -> ForcedContact<Linear> {
    let springs = Linear { normal_stiffness: STIFFNESS, stiffness_ratio: RATIO };
    let law = SpringDashpotSlider { springs, friction: FRICTION, damping: 0.0, kept: 0.0 };
    ForcedContact::new(law, 0.5 * RADIUS, 1.0, STEP / steps_per_step)
}

/// The pair along z with its surfaces sheared at `velocity` along x by equal spins, which is a spin of velocity/(2 R - overlap).
fn sheared(velocity: f64) -> Move {
    let spin = Vec3::y() * (2.0 * velocity / DISTANCE);
    Move {
        overlap: 2.0 * RADIUS - DISTANCE,
        normal: Vec3::z(),
        inverse_distance: 1.0 / DISTANCE,
        velocity: Vec3::zeros(),
        spin_velocity: 0.5 * DISTANCE * spin,
        spin_sum: spin,
    }
}

/// The force of these velocities, one a step: −k_t v dt summed, and limited at each step.
fn summed(velocities: impl Iterator<Item = f64>) -> f64 {
    let limit = FRICTION * STIFFNESS * (2.0 * RADIUS - DISTANCE);
    velocities.fold(0.0, |f: f64, v| (f - STIFFNESS * RATIO * v * STEP).clamp(-limit, limit))
}

/// The velocity of the shear at a step, m/s.
fn oscillation(amplitude: f64) -> impl Fn(u32) -> f64 {
    move |step| -amplitude * (STEP * f64::from(step)).sin()
}

/// The forces on the first sphere along x after each step, beginning with step 1.
fn forces(velocity: impl Fn(u32) -> f64) -> Vec<f64> {
    let mut contact = contact(1.0);
    (1..=200).map(|n| contact.step(&sheared(velocity(n))).tangential.x).collect()
}

fn elastic() -> Result<Vec<Row>, VerificationError> {
    let gold = table("ondem_test_01.csv", include_str!("../data/ondem_test_01.csv"))?;
    let row = |what: &str, points| {
        let name = format!("test 1, tangential elastic, {what}");
        let source = format!("{SOURCE}, theoretical_output_test_01.csv");
        Row::new(NAME, name, source, "N", Measure::OfLargest, 1e-9, points)
    };
    // Row n of the file has the force after step n + 1.
    let stated = forces(oscillation(0.02));
    let points = gold.iter().map(|r| Point::new(r[0], r[2], stated[r[0] as usize])).collect();
    let sent = forces(oscillation(0.02 * DISTANCE));
    let points_sent = gold.iter().map(|r| {
        let steps = 1..=(r[0] as u32 + 1);
        let own = summed(steps.map(oscillation(0.02 * DISTANCE)));
        Point::by_own_law(r[0], r[2], sent[r[0] as usize], own)
    });
    Ok(vec![
        row("at the stated shear velocity", points),
        row("by the spins sent to codes", points_sent.collect()).with_note(
            "Their spins in 1/s equal their shear velocity in m/s, so that the surfaces move (2 R - overlap)/1 m = 1.95 times as fast, and slide. Ours \
             is the sum of our law over that motion; theirs is that of the row above.",
        ),
    ])
}

fn plastic() -> Row {
    let found = forces(oscillation(0.08));
    let point = |n: u32| {
        let sum = summed((1..=n).map(oscillation(0.08)));
        Point::new(f64::from(n), sum, found[n as usize - 1])
    };
    let points = (10..=200).step_by(10).map(point).collect();
    let source = format!("{SOURCE}, F_run_test.py: motion 2; closed form");
    Row::new(NAME, "test 2, tangential plastic", source, "N", Measure::OfLargest, 1e-9, points).with_note(
        "Their repository has the motion, not its result: the closed form is the sum of k_t v dt, limited at each step by friction.",
    )
}

/// A pair sheared at a constant velocity while it turns as a rigid body at 1 rad/s about `axis`: the force turns with it.
fn turned(what: &str, axis: Vec3) -> Row {
    const VELOCITY: f64 = 0.02;
    // A step of ON-DEM turns the pair by 0.094 rad; our law is second order in that angle.
    const PARTS: u32 = 16;
    let mut contact = contact(f64::from(PARTS));
    let dt = STEP / f64::from(PARTS);
    let turn = |v: Vec3, angle: f64| Rotation3::from_axis_angle(&Unit::new_unchecked(axis), angle) * v;
    let mut points = Vec::new();
    let limit = FRICTION * STIFFNESS * (2.0 * RADIUS - DISTANCE);
    for n in 1..=200 * PARTS {
        let angle = dt * f64::from(n);
        let normal = turn(Vec3::z(), angle);
        let shear = turn(Vec3::y() * (2.0 * VELOCITY / DISTANCE), angle);
        // The chord of the step, so that the distance of the centres stays.
        let chord = (normal - turn(Vec3::z(), angle - dt)) * (DISTANCE / dt);
        let forces = contact.step(&Move {
            velocity: chord,
            normal,
            spin_velocity: DISTANCE * axis + 0.5 * DISTANCE * shear,
            spin_sum: 2.0 * axis + shear,
            ..sheared(0.0)
        });
        if n.is_multiple_of(10 * PARTS) {
            let magnitude = (STIFFNESS * RATIO * VELOCITY * angle).min(limit);
            let wanted = turn(-Vec3::x(), angle) * magnitude;
            points.extend((0..3).map(|k| Point::new(f64::from(n / PARTS), wanted[k], forces.tangential[k])));
        }
    }
    let source = format!(
        "{SOURCE}, F_run_test.py: motion {}; closed form",
        if what.starts_with("out") { 3 } else { 4 }
    );
    let name = format!("test {}, shear turned {what}", if what.starts_with("out") { 3 } else { 4 });
    Row::new(NAME, name, source, "N", Measure::OfLargest, 1e-3, points).with_note(
        "In 16 parts of their step, which turns the pair by 0.094 rad: our rotation of the history is second order in the angle of a step.",
    )
}

fn missing() -> Vec<Row> {
    vec![Row::not_comparable(
        NAME,
        "test 5, repulsive viscous",
        format!("{SOURCE}, F_run_test.py: motion 5"),
        "Their law has the normal stiffness for a dashpot and gives no result; our dashpot is a fraction of critical, and never attracts.",
    )]
}
