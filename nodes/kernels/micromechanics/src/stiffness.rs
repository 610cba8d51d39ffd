//! C = A − ΞᵀK⁺Ξ/V, and the checks that every result must pass.

use crate::bounds::mean_spin;
use crate::direct;
use crate::error::{MicroError, NoNetwork};
use crate::network::Network;
use crate::solve::{Solver, solve};
use grainlab_core::{Method, Moduli, Stiffness};

/// Eigenvalues of C and of A − C may be this far below zero, as a share of the largest entry of A: rounding of a sum
/// over contacts, far below any tolerance of the solve.
const BOUND_SLACK: f64 = 1e-11;

/// Standard error of an entry by rounding alone, as a share of the largest entry of A: the sum over contacts.
const ROUNDING: f64 = 1e-15;

/// A network whose stiffest response is below this share of its affine stiffness resists nothing (nor does one below
/// the tolerance of the solve).
const FLOPPY: f64 = 1e-9;

/// Relaxed and affine stiffness of `network`, solved to the relative residual `tolerance`.
///
/// The relaxed stiffness is evaluated by energy, so that its error is second order in the residual and from above, and
/// again by stress, whose error is first order; that the two agree checks the solve, and their difference is stated as
/// the standard error, which it exceeds. 0 ≤ C ≤ A is checked by
/// eigenvalues, with the stiffness B of affine motion and a mean spin between the two. The inner result is `Err` where the network resists no strain at all.
pub fn moduli(
    network: &Network,
    solver: Solver,
    tolerance: f64,
    max_iterations: u32,
) -> Result<Result<Moduli, NoNetwork>, MicroError> {
    let (affine, _) = network.stiffness(None);
    let scale = affine.amax();
    let (loads, norms) = network.strain_loads();
    let solution = match solver {
        Solver::Iterative => solve(network, &loads, &norms, tolerance, max_iterations)?,
        Solver::Direct => direct::solve(network, &loads, &norms, tolerance, max_iterations)?,
    };
    let (relaxed, by_stress) = network.stiffness(Some(&solution.motion));
    if relaxed.amax() <= FLOPPY.max(tolerance) * scale {
        return Ok(Err(NoNetwork::Floppy { contacts: network.contacts() }));
    }
    let relative = (relaxed - by_stress).amax() / scale;
    // The difference is xᵀr/V; x grows with the softest modes, which takes the factor.
    let limit = 1e3 * tolerance;
    if relative.is_nan() || relative > limit {
        return Err(MicroError::Inconsistent { relative, limit });
    }
    let mean_spin = mean_spin(network);
    let bounds = [("C", relaxed), ("B - C", mean_spin.0 - relaxed), ("A - B", affine - mean_spin.0)];
    for (what, matrix) in bounds {
        let eigenvalue = matrix.symmetric_eigenvalues().min();
        if eigenvalue.is_nan() || eigenvalue < -BOUND_SLACK * scale {
            return Err(MicroError::OutOfBounds { what, eigenvalue });
        }
    }
    Ok(Ok(Moduli {
        method: if network.prestressed() { Method::PrestressedNetwork } else { Method::FrozenNetwork },
        stiffness: Stiffness(relaxed),
        stddev: Stiffness((relaxed - by_stress).map(|d| d.abs().max(ROUNDING * scale))),
        affine: Stiffness(affine),
        mean_spin,
        reuss_bound: None,
        residual: solution.residual,
        iterations: solution.iterations,
    }))
}
