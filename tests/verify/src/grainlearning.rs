//! The force curve of GrainLearning's tutorial on two spheres: what it fixes, and what it does not.

use crate::error::VerificationError;
use crate::lammps_pairs::material;
use crate::reference::table;
use crate::row::{Measure, Point, Row};
use grainlab_core::contact::ContactLaw;

/// The name of the suite.
pub const NAME: &str = "grainlearning";

const SOURCE: &str =
    "GrainLearning, tutorials/physics_based/two_particle_collision/collision_obs.txt (ab74934)";

/// log10 of Young's modulus, and Poisson's ratio, with which the tutorial made its data.
const TRUTH: [f64; 2] = [9.3, 0.2];

/// R* of two spheres of radius 1.
const EFFECTIVE_RADIUS: f64 = 0.5;

/// Rows of the suite.
pub fn rows() -> Result<Vec<Row>, VerificationError> {
    let data = table("grainlearning_collision.csv", include_str!("../data/grainlearning_collision.csv"))?;
    let force = |young: f64, poisson: f64, overlap: f64| {
        ContactLaw::default().normal_force(&material(young, poisson, 1.0), EFFECTIVE_RADIUS, overlap)
    };
    // The force is proportional to M = E/(1 - nu^2): least squares of that one number.
    let of_one = |overlap: f64| force(1.0, 0.0, overlap);
    let sum = |of: &dyn Fn(&Vec<f64>) -> f64| data.iter().map(of).sum::<f64>();
    let modulus = sum(&|r| r[1] * of_one(r[0])) / sum(&|r| of_one(r[0]).powi(2));
    let [young, poisson] = [10f64.powf(TRUTH[0]), TRUTH[1]];
    let row = |name: &str, unit, tolerance, points| {
        Row::new(NAME, name, SOURCE, unit, Measure::Relative, tolerance, points)
    };
    // Along the ridge: pairs of E and nu, each with the worst of its forces.
    let along = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5].map(|nu| {
        let e = modulus * (1.0 - nu * nu);
        let difference = |r: &Vec<f64>| (force(e, nu, r[0]) / r[1] - 1.0).abs();
        Point::new(nu, 1.0, 1.0 + data.iter().map(difference).fold(0.0, f64::max))
    });
    let ridge = format!(
        "Force depends on E/(1 - nu^2) alone: every nu of 0 to 0.5, with E of {:.4e} to {:.4e} Pa, fits as well. nu is undetermined.",
        modulus,
        0.75 * modulus
    );
    Ok(vec![
        row(
            "E/(1 - nu^2) from every force",
            "Pa",
            1e-10,
            vec![Point::new(0.0, young / (1.0 - poisson * poisson), modulus)],
        ),
        row(
            "E, were nu known to be 0.2",
            "Pa",
            1e-10,
            vec![Point::new(poisson, young, modulus * (1.0 - poisson * poisson))],
        ),
        row("forces along the ridge nu = 0 to 0.5, over theirs", "", 1e-10, along.to_vec())
            .with_note(ridge.clone()),
        Row::not_comparable(NAME, "nu", SOURCE, ridge),
    ])
}
