//! The contact law under the prescribed motions of MercuryDPM's self tests of its Mindlin law.

use crate::error::VerificationError;
use crate::forced_contact::{ForcedContact, Forces, Move};
use crate::reference::table;
use crate::restitution::damping_for;
use crate::row::{Measure, Point, Row};
use crate::two_spheres::TwoSpheres;
use grainlab_core::contact::{HertzMindlin, SpringDashpotSlider};
use grainlab_core::{Mat3, Material, Vec3};
use nalgebra::{Rotation3, Unit};

/// The name of the suite.
pub const NAME: &str = "mercury";

/// Spheres of MercuryDPM: radius (m), E* (Pa), Poisson's ratio, friction, mass (kg, of a density of 6/π kg/m³).
const RADIUS: f64 = 0.25;
const YOUNG: f64 = 1e5;
const POISSON: f64 = 0.3;
const FRICTION: f64 = 0.1;
const MASS: f64 = 8.0 * RADIUS * RADIUS * RADIUS;

/// Dashpot of MercuryDPM over √(m* F/δ).
const DISSIPATION: f64 = 2.0;

/// Speed of the motions, m/s.
const SPEED: f64 = 0.01;

/// Rows of the suite.
pub fn rows() -> Result<Vec<Row>, VerificationError> {
    Ok([loading()?, tangential()?, frames()?, vec![restitution()?]].concat())
}

fn source(file: &str) -> String {
    format!("MercuryDPM (kuwt/MercuryDPM_fork fb0ebf1), {file}")
}

/// The law with two bodies of `material` at rest: E* as theirs.
fn law(material: Material, damping: f64) -> SpringDashpotSlider<HertzMindlin> {
    SpringDashpotSlider { springs: HertzMindlin::new(&material), friction: FRICTION, damping, kept: 0.0 }
}

/// Two bodies of this material have E* = [`YOUNG`].
fn material() -> Material {
    Material { shear_modulus: YOUNG * (1.0 - POISSON), poisson_ratio: POISSON, density: 1.0 }
}

fn upon_plane(overlap: f64, velocity: Vec3) -> Move {
    let zero = Vec3::zeros();
    let normal = -Vec3::z();
    Move { overlap, normal, inverse_distance: 0.0, velocity, spin_velocity: zero, spin_sum: zero }
}

/// A sphere pushed into a plane and drawn back. The normal velocity that is set is that of a sphere which leaves while it is pushed
/// in, and the reverse.
fn loading() -> Result<Vec<Row>, VerificationError> {
    let file = "mercury_loading.csv";
    // c = γ √(m F/δ), and F/δ = (2/3) k_n.
    let damping = 0.5 * DISSIPATION * (2.0f64 / 3.0).sqrt();
    let points = table(file, include_str!("../data/mercury_loading.csv"))?.into_iter().map(|row| {
        let (time, overlap, theirs) = (row[0], row[1], row[2]);
        // Velocity of the plane relative to the sphere.
        let leaving = if time <= 1.5 + 1e-9 { SPEED } else { -SPEED };
        let mut contact = ForcedContact::new(law(material(), damping), RADIUS, MASS, 0.006);
        let forces = contact.step(&upon_plane(overlap, -Vec3::z() * leaving));
        Point::new(overlap, theirs, forces.normal)
    });
    let points: Vec<Point> = points.collect();
    let name = "normal force upon a plane, loading and unloading";
    let row = Row::new(NAME, name, source("MindlinSelfTestLoading"), "N", Measure::Relative, 1e-8, points);
    Ok(vec![row.with_note(
        "A contact with a plane: R* = R. The test sets velocities against the motion of the sphere, and so do we, with its dashpot.",
    )])
}

/// A sphere moved to and fro along a plane, under Mercury's tangential stiffness and under that of Mindlin.
fn tangential() -> Result<Vec<Row>, VerificationError> {
    const OVERLAP: f64 = 0.015;
    const STEP: f64 = 4e-4;
    let file = "mercury_tangential.csv";
    let rows = table(file, include_str!("../data/mercury_tangential.csv"))?;
    // At constant overlap the law depends on E* and k_t/k_n alone: this Poisson's ratio, of no material, gives theirs, (2/3) 8 G*
    // with G* = E* (1 + ν)/2.
    let ratio = 8.0 / 3.0 * 0.5 * (1.0 + POISSON);
    let poisson = (2.0 * ratio - 2.0) / (ratio - 2.0);
    let as_theirs = Material { shear_modulus: YOUNG * (1.0 - poisson), poisson_ratio: poisson, density: 1.0 };
    let path = |material: Material| {
        let mut contact = ForcedContact::new(law(material, 0.0), RADIUS, MASS, STEP);
        let force = |step: usize| {
            let velocity = Vec3::x() * to_and_fro(step);
            // Theirs is the force on the plane.
            -contact.step(&upon_plane(OVERLAP, -velocity)).tangential.x
        };
        (0..2500).map(force).collect::<Vec<f64>>()
    };
    let at = |forces: &[f64], step: f64| forces[step as usize - 1];
    let (same, mindlin) = (path(as_theirs), path(material()));
    let name = "tangential force to and fro";
    let row = |what: &str, tolerance, points| {
        let source = source("MindlinSelfTestNormalAndTangentialLoading");
        Row::new(NAME, format!("{name}, {what}"), source, "N", Measure::OfLargest, tolerance, points)
    };
    let points = rows.iter().map(|r| Point::new(r[0], r[3], at(&same, r[0]))).collect();
    let sums = rows.iter().map(|r| {
        let own = clamped(&material(), r[0] as usize, STEP, OVERLAP);
        Point::by_own_law(r[0], r[3], at(&mindlin, r[0]), own)
    });
    Ok(vec![
        row("their stiffness", 1e-8, points),
        row("Mindlin's stiffness", 1e-8, sums.collect()).with_note(
            "Mercury's stiffness is (2/3) 8 G* a with G* = E* (1 + nu)/2, ours Mindlin's 8 G* a with G* = E* (1 - nu)/(2 (2 - nu)): less than \
             half of it at nu = 0.3. Ours is Mindlin's, added up by hand; theirs is that of the row above.",
        ),
    ])
}

/// The velocity of the sphere along x in a step, m/s. It turns at 0.25 s and at 0.75 s; their clock, a sum of time steps, passes
/// the second of these one step late.
fn to_and_fro(step: usize) -> f64 {
    if (625..1876).contains(&step) { SPEED } else { -SPEED }
}

/// The sum of k_t v dt, limited at each step, of the motion to and fro.
fn clamped(material: &Material, steps: usize, step: f64, overlap: f64) -> f64 {
    let stiffness = material.tangential_stiffness(RADIUS, overlap);
    let limit = FRICTION * material.normal_force(RADIUS, overlap);
    (0..steps).fold(0.0, |f: f64, n| (f + stiffness * to_and_fro(n) * step).clamp(-limit, limit))
}

/// Two spheres sheared against each other, then turned about each other by 1.67 rad. `turn` turns the whole test.
fn turned_pair(turn: &Mat3) -> Vec<(Vec3, Forces)> {
    const OVERLAP: f64 = 0.03;
    const SHEAR: f64 = 0.0025;
    let half = RADIUS - 0.5 * OVERLAP;
    let end = (SHEAR + 0.5 * std::f64::consts::PI * RADIUS) / SPEED;
    let step = 1e-4 * end;
    // Position, velocity and spin of the first sphere; the second has the opposite ones.
    let pose = |time: f64| {
        if time <= SHEAR / SPEED {
            let at = Vec3::new(SPEED * time - SHEAR, half, 0.0);
            return (at, Vec3::x() * SPEED, 0.0);
        }
        let angle = SPEED / half * (time - SHEAR / SPEED);
        let (s, c) = angle.sin_cos();
        (Vec3::new(s, c, 0.0) * half, Vec3::new(c, -s, 0.0) * SPEED, -SPEED / half)
    };
    let effective = 0.5 * RADIUS;
    let mut contact = ForcedContact::new(law(material(), 0.0), effective, 0.5 * MASS, step);
    (0..10_000)
        .map(|n| {
            let (at, velocity, spin) = pose(step * f64::from(n));
            let branch = turn * (-2.0 * at);
            let distance = branch.norm();
            let overlap = 2.0 * RADIUS - distance;
            // The second sphere has the opposite spin: their surfaces slide all the time.
            let lever = RADIUS - 0.5 * overlap;
            let spins = [Vec3::z() * spin, Vec3::z() * -spin];
            let normal = branch / distance;
            let forces = contact.step(&Move {
                overlap,
                normal,
                inverse_distance: 1.0 / distance,
                velocity: turn * (-2.0 * velocity),
                spin_velocity: turn * (lever * (spins[0] + spins[1])),
                spin_sum: turn * (spins[0] + spins[1]),
            });
            (normal, forces)
        })
        .collect()
}

fn frames() -> Result<Vec<Row>, VerificationError> {
    let gold = table("mercury_frame.csv", include_str!("../data/mercury_frame.csv"))?;
    let upright = turned_pair(&Mat3::identity());
    let (mut normal, mut tangential, mut direction) = (Vec::new(), Vec::new(), Vec::new());
    for row in &gold {
        // Row n is the state after n steps, of which the last began at step n - 1.
        let (_, forces) = upright[row[0] as usize - 1];
        normal.push(Point::new(row[0], row[1], forces.normal));
        tangential.push(Point::new(row[0], row[2], forces.tangential.norm()));
        let along = forces.tangential / forces.tangential.norm();
        direction.extend((0..3).map(|k| Point::new(row[0], row[3 + k], along[k])));
    }
    // Test in a frame that is turned: the forces turn with it.
    let axis = Vec3::new(1.0, -2.0, 0.5);
    let turn = Rotation3::from_axis_angle(&Unit::new_normalize(axis), 1.1).into_inner();
    let turned = turned_pair(&turn);
    let mut frame = Vec::new();
    for n in (0..upright.len()).step_by(500) {
        let ([a, b], scale) = ([upright[n].1, turned[n].1], upright[n].1.normal);
        frame.push(Point::new(n as f64, a.normal / scale, b.normal / scale));
        let (wanted, found) = (turn * a.tangential / scale, b.tangential / scale);
        frame.extend((0..3).map(|k| Point::new(n as f64, wanted[k], found[k])));
    }
    let row = |what: &str, unit, measure, tolerance, points| {
        let name = format!("pair turned by 96 degrees, {what}");
        Row::new(NAME, name, source("MindlinSelfTestFrameIndependence"), unit, measure, tolerance, points)
    };
    Ok(vec![
        row("normal force", "N", Measure::Relative, 1e-8, normal),
        row("tangential force", "N", Measure::Relative, 1e-8, tangential),
        row("direction of the tangential force", "", Measure::Absolute, 1e-8, direction),
        Row::new(
            NAME,
            "the same test in a turned frame, all forces",
            "frame independence: the forces turn with the frame",
            "",
            Measure::Absolute,
            1e-12,
            frame,
        ),
    ])
}

/// Two spheres of restitution 0.8.
fn restitution() -> Result<Row, VerificationError> {
    let material = Material { shear_modulus: 2e4, poisson_ratio: 0.0, density: 1.0 };
    let pair = TwoSpheres::upon(material, 1.0, 1.0, -Vec3::z(), Vec3::zeros());
    let pair = TwoSpheres { velocities: [-Vec3::z(), Vec3::z()], ..pair }.in_steps(1000.0);
    let after = TwoSpheres { damping: damping_for(0.8), ..pair }.collide()?;
    let points =
        vec![Point::new(0.0, 0.8, after.velocities[0].z), Point::new(1.0, -0.8, after.velocities[1].z)];
    let source = source("HertzContactRestitutionUnitTest");
    Ok(Row::new(NAME, "velocities after, restitution 0.8", source, "m/s", Measure::Absolute, 0.01, points))
}
