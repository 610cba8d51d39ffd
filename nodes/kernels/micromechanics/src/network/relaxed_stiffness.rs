//! C = A − ΞᵀK⁺Ξ/V and its checks.

use super::bounds::uniform_rotation_stiffness;
use super::direct;
use super::solve::{Solver, solve};
use super::spring_network::SpringNetwork;
use crate::error::MicroError;
use grainlab_core::Stiffness;

/// Eigenvalues of C and of A − C may be this far below zero, as a fraction of the largest entry of A:
/// rounding of a sum over contacts, far below any tolerance of the solve.
const BOUND_SLACK: f64 = 1e-11;

/// Standard error of an entry from rounding of the sum over contacts, as a fraction of the largest entry of
/// A.
const ROUNDING: f64 = 1e-15;

/// A network whose largest stiffness is below this fraction of its affine stiffness counts as having none (as
/// does one below the tolerance of the solve).
const FLOPPY: f64 = 1e-9;

/// Smallest relative residual that a solve can reach in double precision.
const FINEST: f64 = 1e-14;

/// Difference of the two evaluations, as a fraction of the largest entry of A, above which a solve counts as failed.
const COARSEST: f64 = 1e-4;

/// The stiffness of a spring network.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkStiffness {
    /// Grains relax under the strain.
    pub relaxed: Stiffness,
    /// Standard error of each entry of `relaxed`, Pa.
    pub stddev: Stiffness,
    /// Affine (Voigt) stiffness: every grain moves with the mean deformation.
    pub affine: Stiffness,
    /// The same with a uniform rotation of all grains: between relaxed and affine.
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
/// The relaxed stiffness is evaluated by energy, with an error of second order in the residual and from
/// above, and by stress, with an error of first order. Their agreement checks the solve; their difference is
/// an upper bound of the error and taken as the standard error. 0 ≤ C ≤ B ≤ A is checked by eigenvalues, with
/// the stiffness B of affine motion and a uniform rotation.
pub fn relaxed_stiffness(
    network: &SpringNetwork,
    solver: Solver,
    tolerance: f64,
    max_iterations: u32,
) -> Result<Option<NetworkStiffness>, MicroError> {
    let affine = network.affine_stiffness();
    let scale = affine.0.amax();
    let (loads, norms) = network.affine_loads();
    // The difference of the two is xᵀr/V; x grows with the softest modes, which takes the factor.
    let limit = 1e3 * tolerance;
    let at = |tolerance: f64| {
        let solution = match solver {
            Solver::Iterative => solve(network, &loads, &norms, tolerance, max_iterations),
            Solver::Direct => direct::solve(network, &loads, &norms, tolerance, max_iterations),
        }?;
        let (relaxed, by_stress) = network.stiffness_with(&solution.motion);
        let relative = (relaxed - by_stress).amax() / scale;
        Ok((solution, relaxed, by_stress, relative))
    };
    let mut found = at(tolerance)?;
    if found.1.amax() <= FLOPPY.max(tolerance) * scale {
        return Ok(None);
    }
    if found.3 > limit {
        // Near the isostatic point the modes are softer than that. A finer solve may be below the rounding of double
        // precision: then the difference stays, and is stated.
        let finer: Result<_, MicroError> = at((0.1 * tolerance * limit / found.3).max(FINEST));
        found = finer.unwrap_or(found);
    }
    let (solution, relaxed, by_stress, relative) = found;
    let limit = limit.max(COARSEST);
    if relative.is_nan() || relative > limit {
        return Err(MicroError::Inconsistent { relative, limit });
    }
    let uniform_rotation = uniform_rotation_stiffness(network, &affine);
    let bounds =
        [("C", relaxed), ("B - C", uniform_rotation.0 - relaxed), ("A - B", affine.0 - uniform_rotation.0)];
    for (what, matrix) in bounds {
        let eigenvalue = matrix.symmetric_eigenvalues().min();
        if eigenvalue.is_nan() || eigenvalue < -BOUND_SLACK * scale {
            return Err(MicroError::OutOfBounds { what, eigenvalue });
        }
    }
    Ok(Some(NetworkStiffness {
        relaxed: Stiffness(relaxed),
        stddev: Stiffness((relaxed - by_stress).map(|d| d.abs().max(ROUNDING * scale))),
        affine,
        uniform_rotation,
        residual: solution.residual,
        iterations: solution.iterations,
    }))
}
