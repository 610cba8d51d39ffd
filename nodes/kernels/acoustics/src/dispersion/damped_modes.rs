//! Modes of the contact network with its dashpots: λ² M u + λ C u + K u = 0 at one wave vector.
//!
//! K and C have the same form, with k_n, k_t and c_n, c_t of each contact. Of λ = −γ + iω, 1/Q = 2γ/ω. To first order in
//! C, 1/Q = u*C u/(ω u*M u) with the undamped mode u. The quadratic problem is projected on a few motions: the undamped
//! modes, and K⁻¹ r with the residuals r of the projected solutions, which are the largest part of what is missing. Each
//! round reduces it by the larger of ωc/k of a contact and (ω/ω')², where ω' is the next mode. Quadratic eigenproblems of
//! damped packings: Hu, Makse, Valenza and Johnson, arXiv:1410.5484; Kruyt, J. Mech. Mater. Struct. 7, 347 (2012).

use crate::dispersion::bloch::Bloch;
use crate::dispersion::error::SolveError;
use crate::dispersion::solve::Solve;
use crate::dispersion::subspace::{combined, product};
use crate::dispersion::waves::{Amplitude, Block, Row, WAVES};
use nalgebra::{Complex, DMatrix, DVector, SymmetricEigen};

type C = Complex<f64>;

/// Maximum number of rounds, and the relative change of 1/Q at which they end.
const ROUNDS: usize = 10;
const CONVERGED: f64 = 1e-4;

/// Residual of a solve over its load: a correction need not be exact.
const RESIDUAL: f64 = 1e-2;

/// Squared norm of a combination of unit motions below which it is rounding.
const DEPENDENT: f64 = 1e-12;

/// Iterations for one eigenvalue of the projected problem.
const NEWTON: usize = 20;

/// One damped mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DampedMode {
    /// ω, rad/s.
    pub(super) omega: f64,
    /// 1/Q = 2γ/ω.
    pub(super) loss: f64,
    /// The same to first order in the dashpots.
    pub(super) first_order: f64,
    /// Relative change of 1/Q in the last round.
    pub(super) change: f64,
}

/// A motion of all waves with its images.
struct Held {
    x: Block,
    stiffness: Block,
    damping: Block,
    mass: Block,
}

/// The damped modes that belong to the first `count` waves of the first block of `modes`; the other blocks hold softer
/// modes. `None` for a mode that does not oscillate.
pub(super) fn damped_modes(
    bloch: &Bloch<'_>,
    dashpots: &Bloch<'_>,
    modes: &[Block],
    count: usize,
    max_iterations: u32,
) -> Result<Vec<Option<DampedMode>>, SolveError> {
    let mut held: Vec<Held> = modes.iter().map(|x| Held::new(bloch, dashpots, x.clone())).collect();
    let mut budget = max_iterations;
    let mut before = [f64::INFINITY; WAVES];
    let mut first = [0.0; WAVES];
    for round in 0..ROUNDS {
        let projected = Projected::new(&held);
        let found: Vec<(C, DVector<C>)> = (0..count).map(|wave| projected.near(wave)).collect();
        if round == 0 {
            for (wave, first) in first.iter_mut().enumerate().take(count) {
                let square = product(&held[0].x, wave, &held[0].stiffness, wave).re;
                let mass = product(&held[0].x, wave, &held[0].mass, wave).re;
                *first = product(&held[0].x, wave, &held[0].damping, wave).re / (square * mass).sqrt();
            }
        }
        let loss = |lambda: C| -2.0 * lambda.re / lambda.im;
        let change = |wave: usize| match loss(found[wave].0) {
            0.0 => 0.0,
            now => (now / before[wave] - 1.0).abs(),
        };
        let settled = (0..count).all(|wave| change(wave) <= CONVERGED);
        if settled || round + 1 == ROUNDS {
            let mode = |wave: usize| {
                let lambda = found[wave].0;
                let (omega, loss) = (lambda.im, loss(lambda));
                let oscillates = omega > 0.0 && loss.is_finite() && loss >= 0.0;
                let mode = DampedMode { omega, loss, first_order: first[wave], change: change(wave) };
                oscillates.then_some(mode)
            };
            return Ok((0..count).map(mode).collect());
        }
        for (wave, (lambda, _)) in found.iter().enumerate() {
            before[wave] = loss(*lambda);
        }
        let load = projected.residual(&held, &found);
        let start = vec![Amplitude::STILL; load.len()];
        let solve = Solve { bloch, load, start, tolerance: RESIDUAL, budget: &mut budget };
        let correction = pulp::Arch::new().dispatch(solve)?;
        held.push(Held::new(bloch, dashpots, correction));
    }
    Err(SolveError::Unsettled { change: f64::NAN, rounds: ROUNDS as u32 })
}

impl Held {
    /// Each wave normalised to unit kinetic energy; a zero wave stays zero.
    fn new(bloch: &Bloch<'_>, dashpots: &Bloch<'_>, mut x: Block) -> Self {
        let still = || vec![Amplitude::STILL; x.len()];
        let (mut stiffness, mut damping, mut mass) = (still(), still(), still());
        bloch.apply_mass(&x, &mut mass);
        let inverse = |k: usize| {
            let share = 1.0 / product(&x, k, &mass, k).re.sqrt();
            if share.is_finite() { share } else { 0.0 }
        };
        let share = Row::of([inverse(0), inverse(1), inverse(2)]);
        for row in x.iter_mut().chain(&mut mass).flat_map(|x| x.re.iter_mut().chain(&mut x.im)) {
            *row = share * *row;
        }
        bloch.apply(&x, &mut stiffness);
        dashpots.apply(&x, &mut damping);
        Self { x, stiffness, damping, mass }
    }
}

/// The problem in the span of the held motions, with M = 1.
struct Projected {
    /// Orthonormal motions as combinations of the held ones.
    basis: DMatrix<C>,
    stiffness: DMatrix<C>,
    damping: DMatrix<C>,
    /// The first held motions in the basis.
    first: DMatrix<C>,
}

impl Projected {
    fn new(held: &[Held]) -> Self {
        let size = WAVES * held.len();
        let at = |k: usize| (&held[k / WAVES], k % WAVES);
        let matrix = |of: fn(&Held) -> &Block| {
            let full = DMatrix::from_fn(size, size, |a, b| {
                let ((one, wave), (other, next)) = (at(a), at(b));
                product(&one.x, wave, of(other), next)
            });
            (&full + full.adjoint()) * C::from(0.5)
        };
        let mass = matrix(|h| &h.mass);
        let gram = SymmetricEigen::new(mass.clone());
        let kept: Vec<usize> = (0..size).filter(|k| gram.eigenvalues[*k] > DEPENDENT).collect();
        let basis = DMatrix::from_fn(size, kept.len(), |i, k| {
            gram.eigenvectors[(i, kept[k])] / C::from(gram.eigenvalues[kept[k]].sqrt())
        });
        let inside = |full: DMatrix<C>| basis.adjoint() * full * &basis;
        let (stiffness, damping) = (inside(matrix(|h| &h.stiffness)), inside(matrix(|h| &h.damping)));
        let first = basis.adjoint() * mass.columns(0, WAVES);
        Self { basis, stiffness, damping, first }
    }

    /// λ and the motion of the solution nearest to a wave of the first held motion, by nonlinear inverse iteration.
    fn near(&self, wave: usize) -> (C, DVector<C>) {
        let mut x: DVector<C> = self.first.column(wave).normalize();
        let mut lambda = self.rayleigh(&x);
        let one = DMatrix::<C>::identity(x.len(), x.len());
        for _ in 0..NEWTON {
            let problem = &self.stiffness + &self.damping * lambda + &one * (lambda * lambda);
            let slope = &self.damping * &x + &x * (lambda * 2.0);
            let Some(next) = problem.lu().solve(&slope) else { break };
            if !next.norm().is_finite() {
                break;
            }
            x = next.normalize();
            let next = self.rayleigh(&x);
            let moved = (next - lambda).norm();
            lambda = next;
            if moved < 1e-14 * lambda.norm() {
                break;
            }
        }
        (lambda, x)
    }

    /// The root of λ² + λ x*C x + x*K x that oscillates forwards, for a unit x.
    fn rayleigh(&self, x: &DVector<C>) -> C {
        let damping = x.dotc(&(&self.damping * x)).re;
        let stiffness = x.dotc(&(&self.stiffness * x)).re;
        -C::from(0.5 * damping) + C::from(0.25 * damping * damping - stiffness).sqrt()
    }

    /// λ² M u + λ C u + K u of each solution.
    fn residual(&self, held: &[Held], found: &[(C, DVector<C>)]) -> Block {
        let weighted = |power: i32| {
            let mut full = DMatrix::<C>::zeros(self.basis.nrows(), found.len());
            for (column, (lambda, x)) in found.iter().enumerate() {
                full.set_column(column, &(&self.basis * x * lambda.powi(power)));
            }
            full
        };
        let chosen: Vec<usize> = (0..found.len()).collect();
        let sum = |of: fn(&Held) -> &Block, power: i32| {
            let blocks: Vec<&Block> = held.iter().map(of).collect();
            combined(&blocks, WAVES, &weighted(power), &chosen)
        };
        let mut residual = sum(|h| &h.stiffness, 0);
        let one = Row::of([1.0; WAVES]);
        for other in [sum(|h| &h.damping, 1), sum(|h| &h.mass, 2)] {
            residual.iter_mut().zip(&other).for_each(|(r, x)| r.add(one, x));
        }
        residual
    }
}
