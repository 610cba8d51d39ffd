//! Block-Jacobi conjugate gradients for several right-hand sides of one network.
//!
//! The operator is singular (uniform translation, rattlers, floppy grains), but loads made by contact forces lie in
//! its range, and there conjugate gradients converge to a solution; which one of them does not matter to any force.
//! Everything runs in one fixed order on one thread: the same input gives the same bits.

use crate::error::MicroError;
use crate::network::{Motion, Network};
use crate::preconditioner::{Block, generalised_inverse};

/// Motions that balance the loads.
#[derive(Clone, Debug)]
pub struct Solution<const L: usize> {
    /// One motion per grain.
    pub motion: Vec<Motion<L>>,
    /// Norm of what is left of each load, recomputed from the motion, over its scale; the worst of the columns.
    pub residual: f64,
    /// Iterations done.
    pub iterations: u32,
}

/// Solves K x = `load` (one entry per grain, N) for `L` columns at once until the norm of each residual is at most
/// `tolerance` times its entry in `scale` (N). Columns with a scale of zero are left at zero.
pub fn solve<const L: usize>(
    network: &Network,
    load: &[Motion<L>],
    scale: &[f64; L],
    tolerance: f64,
    max_iterations: u32,
) -> Result<Solution<L>, MicroError> {
    let inverse: Vec<Block> = network.diagonal_blocks().iter().map(generalised_inverse).collect();
    // The recurrence drifts from the true residual by rounding; half the tolerance leaves it room.
    let targets = scale.map(|s| (0.5 * tolerance * s).powi(2));
    let zero = vec![[[0.0; L]; 6]; load.len()];
    let mut state = State {
        motion: zero.clone(),
        rest: load.to_vec(),
        step: zero.clone(),
        image: zero.clone(),
        guess: zero,
    };
    let (mut iterations, mut previous) = (0, f64::INFINITY);
    loop {
        iterations += state.descend(network, &inverse, &targets, max_iterations - iterations);
        network.apply(&state.motion, &mut state.image);
        let mut squares = [0.0; L];
        for ((rest, image), load) in state.rest.iter_mut().zip(&state.image).zip(load) {
            for k in 0..6 {
                for l in 0..L {
                    rest[k][l] = load[k][l] - image[k][l];
                    squares[l] += rest[k][l] * rest[k][l];
                }
            }
        }
        let ratio = |l: usize| if scale[l] > 0.0 { squares[l].sqrt() / scale[l] } else { 0.0 };
        // Not f64::max, which would hide a NaN.
        let residual =
            (0..L).map(ratio).fold(0.0, |worst: f64, r| if worst.is_nan() || r <= worst { worst } else { r });
        if residual <= tolerance {
            return Ok(Solution { motion: state.motion, residual, iterations });
        }
        // Starting again from the true residual cures drift; once that no longer helps, rounding is the limit.
        let helped = residual < 0.5 * previous;
        if iterations >= max_iterations || !helped {
            return Err(MicroError::NotConverged { residual, tolerance, iterations });
        }
        previous = residual;
    }
}

struct State<const L: usize> {
    /// x.
    motion: Vec<Motion<L>>,
    /// r = load − K x, by recurrence.
    rest: Vec<Motion<L>>,
    /// Search direction p.
    step: Vec<Motion<L>>,
    /// K p.
    image: Vec<Motion<L>>,
    /// z = M r.
    guess: Vec<Motion<L>>,
}

impl<const L: usize> State<L> {
    /// Conjugate gradients from the present motion and residual until every column's squared residual is at most its
    /// target, or `limit` iterations are done. Returns the iterations done.
    fn descend(&mut self, network: &Network, inverse: &[Block], targets: &[f64; L], limit: u32) -> u32 {
        let (mut rho, mut squares) = self.advance(inverse, &[0.0; L]);
        self.step.copy_from_slice(&self.guess);
        for iteration in 0..limit {
            let active: [bool; L] = std::array::from_fn(|l| squares[l] > targets[l]);
            if active.iter().all(|a| !a) {
                return iteration;
            }
            let energy = network.apply(&self.step, &mut self.image);
            // A column that is done stands still, so that its last digits cannot blow up while others go on.
            let alpha =
                std::array::from_fn(|l| if active[l] && energy[l] > 0.0 { rho[l] / energy[l] } else { 0.0 });
            let before = rho;
            (rho, squares) = self.advance(inverse, &alpha);
            let beta: [f64; L] =
                std::array::from_fn(|l| if before[l] > 0.0 { rho[l] / before[l] } else { 0.0 });
            for (p, z) in self.step.iter_mut().zip(&self.guess) {
                for k in 0..6 {
                    for l in 0..L {
                        p[k][l] = z[k][l] + beta[l] * p[k][l];
                    }
                }
            }
        }
        limit
    }

    /// x += α p, r −= α K p, z = M r in one pass; returns rᵀz and rᵀr.
    fn advance(&mut self, inverse: &[Block], alpha: &[f64; L]) -> ([f64; L], [f64; L]) {
        let (mut rho, mut squares) = ([0.0; L], [0.0; L]);
        let grains = self.motion.iter_mut().zip(&mut self.rest).zip(&mut self.guess);
        for ((((x, r), z), (p, q)), m) in grains.zip(self.step.iter().zip(&self.image)).zip(inverse) {
            for k in 0..6 {
                for l in 0..L {
                    x[k][l] += alpha[l] * p[k][l];
                    r[k][l] -= alpha[l] * q[k][l];
                }
            }
            for k in 0..6 {
                let mut sum = [0.0; L];
                for c in 0..6 {
                    for l in 0..L {
                        sum[l] += m[k][c] * r[c][l];
                    }
                }
                for l in 0..L {
                    rho[l] += sum[l] * r[k][l];
                    squares[l] += r[k][l] * r[k][l];
                }
                z[k] = sum;
            }
        }
        (rho, squares)
    }
}
