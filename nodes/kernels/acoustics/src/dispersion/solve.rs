//! K y = f by conjugate gradients, compiled for each instruction set. No operation is contracted or reordered, so
//! that all instruction sets give the same bits.

use crate::dispersion::bloch::Bloch;
use crate::dispersion::error::SolveError;
use crate::dispersion::waves::{Amplitude, Block, Row, WAVES, products};
use grainlab_core::instruction_sets::Work;

/// Growth of a residual that only a motion without stiffness causes.
const DIVERGED: f64 = 1e6;

/// K y = M x, for each wave with its ω², starting at y = x/ω²: conjugate gradients with a block Jacobi preconditioner.
pub(crate) struct InverseIteration<'a> {
    pub(crate) bloch: &'a Bloch<'a>,
    pub(crate) x: &'a [Amplitude],
    /// ω² of each wave, 1/s².
    pub(crate) squares: &'a [f64; WAVES],
    /// Residual over the load.
    pub(crate) tolerance: f64,
    /// Number of iterations left.
    pub(crate) budget: &'a mut u32,
}

impl Work for InverseIteration<'_> {
    type Output = Result<Block, SolveError>;

    #[inline(always)]
    fn run(self) -> Result<Block, SolveError> {
        let Self { bloch, x, squares, tolerance, budget } = self;
        let (mut y, mut load) = (x.to_vec(), vec![Amplitude::STILL; x.len()]);
        let softness = Row::of(squares.map(|s| if s > 0.0 { 1.0 / s } else { 0.0 }));
        for row in y.iter_mut().flat_map(|y| y.re.iter_mut().chain(&mut y.im)) {
            *row = softness * *row;
        }
        bloch.apply_mass(x, &mut load);
        let zero = || vec![Amplitude::STILL; load.len()];
        let (mut rest, mut image) = (load.clone(), zero());
        let loads = products(&rest, &rest);
        bloch.apply(&y, &mut image);
        advance(Row::of([-1.0; WAVES]), &image, &mut rest);
        let (mut search, mut better) = (zero(), zero());
        bloch.precondition(&rest, &mut better);
        search.copy_from_slice(&better);
        let mut rho = products(&rest, &better);
        let start = *budget;
        let mut first = None;
        loop {
            let left = products(&rest, &rest);
            let ratio = |k: usize| if loads[k] > 0.0 { (left[k] / loads[k]).sqrt() } else { 0.0 };
            let residual = (0..WAVES)
                .map(ratio)
                .fold(0.0, |worst: f64, r| if r.is_nan() || r > worst { r } else { worst });
            if residual <= tolerance {
                break;
            }
            if residual > DIVERGED * *first.get_or_insert(residual) {
                return Err(SolveError::Floppy);
            }
            if *budget == 0 || residual.is_nan() {
                return Err(SolveError::NotConverged { residual, iterations: start - *budget });
            }
            *budget -= 1;
            bloch.apply(&search, &mut image);
            let energy = products(&search, &image);
            let mut alpha = [0.0; WAVES];
            for k in 0..WAVES {
                // A wave that has converged is left unchanged.
                if ratio(k) > 0.5 * tolerance && rho[k] > 0.0 {
                    if energy[k] <= 0.0 {
                        return Err(SolveError::Floppy);
                    }
                    alpha[k] = rho[k] / energy[k];
                }
            }
            let alpha = Row::of(alpha);
            advance(alpha, &search, &mut y);
            advance(Row::ZERO - alpha, &image, &mut rest);
            bloch.precondition(&rest, &mut better);
            let next = products(&rest, &better);
            let grown = |k: usize| if rho[k] > 0.0 { next[k] / rho[k] } else { 0.0 };
            let beta = Row::of([grown(0), grown(1), grown(2)]);
            rho = next;
            for (search, better) in search.iter_mut().zip(&better) {
                for k in 0..6 {
                    search.re[k] = better.re[k] + beta * search.re[k];
                    search.im[k] = better.im[k] + beta * search.im[k];
                }
            }
        }
        bloch.project_out_floppy_modes(&mut y);
        Ok(y)
    }
}

/// y += share × x, for each wave.
#[inline(always)]
fn advance(share: Row, x: &[Amplitude], y: &mut [Amplitude]) {
    for (x, y) in x.iter().zip(y) {
        y.add(share, x);
    }
}
