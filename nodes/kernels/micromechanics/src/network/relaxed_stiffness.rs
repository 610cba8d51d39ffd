//! C = A − ΞᵀK⁺Ξ/V, and the checks that every result must pass.

use super::bounds::uniform_rotation_stiffness;
use super::direct;
use super::solve::{Solver, solve};
use super::spring_network::SpringNetwork;
use crate::error::MicroError;
use grainlab_core::Stiffness;

/// Eigenvalues of C and of A − C may be this far below zero, as a share of the largest entry of A: rounding of a sum
/// over contacts, far below any tolerance of the solve.
const BOUND_SLACK: f64 = 1e-11;

/// Standard error of an entry by rounding alone, as a share of the largest entry of A: the sum over contacts.
const ROUNDING: f64 = 1e-15;

/// A network whose stiffest response is below this share of its affine stiffness resists nothing (nor does one below
/// the tolerance of the solve).
const FLOPPY: f64 = 1e-9;

/// The stiffness of a spring network.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkStiffness {
    /// Grains relax under the strain.
    pub relaxed: Stiffness,
    /// Standard error of each entry of it, Pa.
    pub stddev: Stiffness,
    /// Affine (Voigt) stiffness: every grain moves with the mean deformation.
    pub affine: Stiffness,
    /// The same where all grains also rotate alike: between relaxed and affine.
    pub uniform_rotation: Stiffness,
    /// Relative residual of the solve, the worst of the six columns.
    pub residual: f64,
    /// Iterations of the solve.
    pub iterations: u32,
}

/// Relaxed and affine stiffness of `network`, solved to the relative residual `tolerance`; `None` if the network resists no
/// strain at all.
///
/// The relaxed stiffness is evaluated by energy, so that its error is second order in the residual and from above, and
/// again by stress, whose error is first order; that the two agree checks the solve, and their difference is stated as
/// the standard error, which it exceeds. 0 ≤ C ≤ A is checked by eigenvalues, with the stiffness B of affine motion and a
/// uniform rotation between the two.
pub fn relaxed_stiffness(
    network: &SpringNetwork,
    solver: Solver,
    tolerance: f64,
    max_iterations: u32,
) -> Result<Option<NetworkStiffness>, MicroError> {
    let affine = network.affine_stiffness();
    let scale = affine.0.amax();
    let (loads, norms) = network.affine_loads();
    let solution = match solver {
        Solver::Iterative => solve(network, &loads, &norms, tolerance, max_iterations)?,
        Solver::Direct => direct::solve(network, &loads, &norms, tolerance, max_iterations)?,
    };
    let (relaxed, by_stress) = network.stiffness_with(&solution.motion);
    if relaxed.amax() <= FLOPPY.max(tolerance) * scale {
        return Ok(None);
    }
    let relative = (relaxed - by_stress).amax() / scale;
    // The difference is xᵀr/V; x grows with the softest modes, which takes the factor.
    let limit = 1e3 * tolerance;
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
