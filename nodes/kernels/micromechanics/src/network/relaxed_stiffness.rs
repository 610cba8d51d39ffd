//! C = A − ΞᵀK⁺Ξ/V and its checks.

use super::bounds::uniform_rotation_stiffness;
use super::solve::{Solution, Solver, left};
use super::spring_network::{GrainDofs, SpringNetwork};
use crate::error::MicroError;
use crate::tolerances::TOLERANCES;
use grainlab_core::Stiffness;
use nalgebra::Matrix6;

/// Eigenvalues of C and of A − C may be this far below zero, as a fraction of the largest entry of A:
/// rounding of a sum over contacts, far below any tolerance of the solve.
const BOUND_SLACK: f64 = 1e-11;

/// Standard error of an entry from rounding of the sum over contacts, as a fraction of the largest entry of
/// A.
const ROUNDING: f64 = 1e-15;

/// A network whose largest stiffness is below this fraction of its affine stiffness counts as having none (as
/// does one below the tolerance of the solve).
const FLOPPY: f64 = 1e-9;

/// Upper bound of the largest stiffness, over the affine one, below which a network has none although its motions were not found.
/// The forces of a packing at rest are a state of self-stress, which resists compression with tenths of the affine stiffness.
const FLOPPY_BOUND: f64 = 1e-6;

/// Smallest relative residual that a solve can reach in double precision.
const FINEST: f64 = 1e-14;

/// Difference of the two evaluations, as a fraction of the largest entry of A, above which a solve counts as failed.
const COARSEST: f64 = 1e-4;

/// Share of a tolerance that is tried where the two evaluations differ at it.
const LOWERED: f64 = 1e-3;

/// Share of its residual to which a solution is corrected, in order to measure its error.
const CORRECTED: f64 = 0.1;

/// The stiffness of a spring network.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkStiffness {
    /// Grains relax under the strain.
    pub relaxed: Stiffness,
    /// Error that the solver left in each entry of `relaxed`, Pa, as a standard deviation.
    pub stddev: Stiffness,
    /// Affine (Voigt) stiffness: every grain moves with the mean deformation.
    pub affine: Stiffness,
    /// Affine stiffness with a uniform rotation of all grains: between relaxed and affine.
    pub uniform_rotation: Stiffness,
    /// Relative residual of the solve, maximum over the six columns.
    pub residual: f64,
    /// Iterations of the solve.
    pub iterations: u32,
}

/// Relaxed and affine stiffness of `network`, solved to the relative residual `tolerance`, or to a smaller
/// one where the network is so soft that the two evaluations below differ by more than a thousand times that; `None` if the
/// network resists no strain.
///
/// The energy of any motion is an upper bound of the stiffness (minimum of potential energy). If the solve does not converge, and
/// that bound is below 1e-6 of the affine stiffness, the network resists no strain either.
///
/// The relaxed stiffness is evaluated by energy, with an error of second order in the residual and from
/// above, and by stress, with an error of first order. Their agreement checks the solve. 0 ≤ C ≤ B ≤ A is checked by
/// eigenvalues, with the stiffness B of affine motion and a uniform rotation.
///
/// The error of C is eᵀ K e/V, with e the error of the motion. Conjugate gradients leave a residual r at right angles to the
/// motion, so that both evaluations agree far better than either with the exact C. Therefore e is solved for, K e = r, to a
/// tenth of r.
///
/// # Errors
/// A solve that does not converge, or fails a check. The error names another tolerance only if the stiffness was found with it.
pub fn relaxed_stiffness(
    network: &SpringNetwork,
    tolerance: f64,
    max_iterations: u32,
) -> Result<Option<NetworkStiffness>, MicroError> {
    let is_enough =
        |other: &f64| TOLERANCES.contains(other) && checked(network, *other, max_iterations).is_ok();
    checked(network, tolerance, max_iterations).map_err(|error| match error {
        MicroError::NotConverged { residual, tolerance, iterations, .. } => {
            // With a margin, because another tolerance takes other rounds.
            let sufficient = Some(one_digit(2.0 * residual)).filter(is_enough);
            MicroError::NotConverged { residual, tolerance, iterations, sufficient }
        }
        MicroError::Inconsistent { relative, limit, .. } => {
            let sufficient = Some(one_digit(LOWERED * tolerance)).filter(is_enough);
            MicroError::Inconsistent { relative, limit, sufficient }
        }
        other => other,
    })
}

/// The next larger number with one digit.
fn one_digit(value: f64) -> f64 {
    let unit = value.log10().floor();
    format!("{}e{unit}", (value / 10f64.powf(unit)).ceil()).parse().unwrap_or(value)
}

fn checked(
    network: &SpringNetwork,
    tolerance: f64,
    max_iterations: u32,
) -> Result<Option<NetworkStiffness>, MicroError> {
    let affine = network.affine_stiffness();
    let scale = affine.0.amax();
    let (loads, norms) = network.affine_loads();
    let solver = Solver::new(network);
    // The difference of the two is xᵀr/V; x grows with the softest modes, which takes the factor.
    let limit = 1e3 * tolerance;
    let at = |tolerance: f64| {
        let solution = solver.closest(&loads, &norms, tolerance, max_iterations)?;
        let (relaxed, by_stress) = network.stiffness_with(&solution.motion);
        let relative = (relaxed - by_stress).amax() / scale;
        Ok::<_, MicroError>((solution, relaxed, relative))
    };
    let mut found = at(tolerance)?;
    let Solution { residual, iterations, .. } = found.0;
    let is_solved = residual <= tolerance;
    let least = if is_solved { FLOPPY.max(tolerance) } else { FLOPPY_BOUND };
    if (is_solved || !network.prestressed()) && found.1.amax() <= least * scale {
        return Ok(None);
    }
    if !is_solved {
        return Err(MicroError::NotConverged { residual, tolerance, iterations, sufficient: None });
    }
    if found.2 > limit {
        // Near the isostatic point the modes are softer than that. A finer solve may be below the rounding of double
        // precision: then the difference stays, and is stated.
        let finest = (0.1 * tolerance * limit / found.2).max(FINEST);
        if let Ok(finer) = at(finest)
            && finer.0.residual <= finest
        {
            found = finer;
        }
    }
    let (solution, relaxed, relative) = found;
    let limit = limit.max(COARSEST);
    if relative.is_nan() || relative > limit {
        return Err(MicroError::Inconsistent { relative, limit, sufficient: None });
    }
    let uniform_rotation = uniform_rotation_stiffness(network, &affine);
    let bounds =
        [("C", relaxed), ("B - C", uniform_rotation.0 - relaxed), ("A - B", affine.0 - uniform_rotation.0)];
    for (what, matrix) in bounds {
        let eigenvalue = matrix.symmetric_eigenvalues().min();
        if network.prestressed() && what == "C" && eigenvalue < -BOUND_SLACK * scale {
            return Err(MicroError::HeldOnly { eigenvalue });
        }
        if eigenvalue.is_nan() || eigenvalue < -BOUND_SLACK * scale {
            return Err(MicroError::OutOfBounds { what, eigenvalue });
        }
    }
    let error = error_left(network, &solver, &loads, &norms, &solution, max_iterations);
    let stddev = error.map(|error| error.max(ROUNDING * scale));
    Ok(Some(NetworkStiffness {
        relaxed: Stiffness(relaxed),
        stddev: Stiffness(stddev),
        affine,
        uniform_rotation,
        residual: solution.residual,
        iterations: solution.iterations,
    }))
}

/// Error of each entry of C by energy, Pa: √(e_aᵀ K e_a · e_bᵀ K e_b)/V with the errors e of the motions, at least |e_aᵀ K e_b|/V.
/// Errors that cannot be solved for are taken to be as large as the motions.
fn error_left(
    network: &SpringNetwork,
    solver: &Solver<'_>,
    loads: &[GrainDofs<6>],
    norms: &[f64; 6],
    solution: &Solution<6>,
    max_iterations: u32,
) -> Matrix6<f64> {
    let mut image = vec![[[0.0; 6]; 6]; loads.len()];
    network.apply(&solution.motion, &mut image);
    let rest = left(loads, &image, norms);
    let square = |x: &[GrainDofs<6>], y: &[GrainDofs<6>], l: usize| -> f64 {
        x.iter().zip(y).map(|(x, y)| (0..6).map(|k| x[k][l] * y[k][l]).sum::<f64>()).sum()
    };
    let tolerance = (CORRECTED * solution.residual).max(FINEST);
    let energies: [f64; 6] = match solver.solve(&rest, norms, tolerance, max_iterations) {
        Ok(error) => std::array::from_fn(|l| square(&error.motion, &rest, l).max(0.0)),
        Err(_) => std::array::from_fn(|l| {
            (square(&solution.motion, &solution.motion, l) * square(&rest, &rest, l)).sqrt()
        }),
    };
    Matrix6::from_fn(|a, b| (energies[a] * energies[b]).sqrt() / network.volume())
}
