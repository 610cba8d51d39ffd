//! The Rayleigh–Ritz method: the best modes in the span of a few motions.

use crate::dispersion::bloch::Bloch;
use crate::dispersion::waves::{Amplitude, Block, Row, WAVES};
use nalgebra::{Complex, DMatrix, Matrix3, SymmetricEigen};

pub(super) type C = Complex<f64>;

/// Squared norm of a combination of unit motions below which it is rounding.
const DEPENDENT: f64 = 1e-12;

/// Maximum number of softer modes that are kept.
const SOFTER: usize = 24;

#[derive(Debug)]
pub(crate) struct Subspace {
    waves: usize,
    blocks: Vec<Held>,
}

#[derive(Debug)]
struct Held {
    x: Block,
    /// Image K x.
    image: Block,
    /// Product M x.
    mass_times: Block,
}

#[derive(Debug)]
pub(crate) struct Ritz {
    /// ω², 1/s², of each wave.
    pub(crate) squares: [f64; WAVES],
    /// The modes, of unit kinetic energy: x* M x = 1.
    pub(crate) waves: Block,
    /// Overlap of each mode (column) with each reference (row).
    pub(crate) overlaps: Matrix3<C>,
    /// Softer modes, of unit kinetic energy: nearly floppy motions of a few grains, to be separated.
    pub(crate) softer: Vec<Block>,
}

impl Subspace {
    pub(crate) fn new(waves: usize) -> Self {
        Self { waves, blocks: Vec::new() }
    }

    /// Adds the waves of a block, each normalised to unit kinetic energy; a zero wave stays zero.
    pub(crate) fn add(&mut self, bloch: &Bloch<'_>, mut x: Block) {
        let zero = || vec![Amplitude::STILL; x.len()];
        let (mut image, mut mass_times) = (zero(), zero());
        bloch.apply_mass(&x, &mut mass_times);
        let norm = |k: usize| product(&x, k, &mass_times, k).re.sqrt();
        let inverse = |k: usize| Some(1.0 / norm(k)).filter(|s| s.is_finite()).unwrap_or(0.0);
        let share = Row::of([inverse(0), inverse(1), inverse(2)]);
        for row in (x.iter_mut().chain(&mut mass_times)).flat_map(|x| x.re.iter_mut().chain(&mut x.im)) {
            *row = share * *row;
        }
        bloch.apply(&x, &mut image);
        self.blocks.push(Held { x, image, mass_times });
    }

    /// Among the combinations that make ω² stationary, those with the largest overlap with the references,
    /// one per wave. `references` is their M x. `None` if there are too few, or if one has no stiffness.
    pub(crate) fn best(&self, references: &[Amplitude]) -> Option<Ritz> {
        let (waves, size) = (self.waves, self.waves * self.blocks.len());
        let at = |k: usize| (&self.blocks[k / waves], k % waves);
        let matrix = |of: fn(&Held) -> &Block| {
            let full = DMatrix::from_fn(size, size, |a, b| {
                let ((one, wave), (other, next)) = (at(a), at(b));
                product(&one.x, wave, of(other), next)
            });
            (&full + full.adjoint()) * C::from(0.5)
        };
        let (stiffness, mass) = (matrix(|h| &h.image), matrix(|h| &h.mass_times));
        let gram = SymmetricEigen::new(mass);
        let kept: Vec<usize> = (0..size).filter(|k| gram.eigenvalues[*k] > DEPENDENT).collect();
        let basis = DMatrix::from_fn(size, kept.len(), |i, k| {
            gram.eigenvectors[(i, kept[k])] / C::from(gram.eigenvalues[kept[k]].sqrt())
        });
        let eigen = SymmetricEigen::new(basis.adjoint() * stiffness * &basis);
        let combinations = basis * &eigen.eigenvectors;
        // Overlap of each combination with each reference.
        let along = DMatrix::from_fn(waves, size, |reference, b| {
            let (held, wave) = at(b);
            product(references, reference, &held.x, wave)
        }) * &combinations;
        let share = |k: &usize| along.column(*k).norm_squared();
        let mut order: Vec<usize> = (0..kept.len()).collect();
        order.sort_by(|a, b| share(b).total_cmp(&share(a)));
        let others = order.split_off(waves.min(order.len()));
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let resisted = |k: &usize| eigen.eigenvalues[*k] > 0.0 && share(k) > 0.0;
        if order.len() < waves || !order.iter().all(resisted) {
            return None;
        }
        let stiffest = eigen.eigenvalues[order[waves - 1]];
        let mut softer: Vec<usize> =
            others.into_iter().filter(|k| eigen.eigenvalues[*k] < stiffest).collect();
        softer.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        softer.truncate(SOFTER);
        let (mut squares, mut overlaps) = ([0.0; WAVES], Matrix3::zeros());
        for (wave, k) in order.iter().enumerate() {
            squares[wave] = eigen.eigenvalues[*k];
            (0..waves).for_each(|reference| overlaps[(reference, wave)] = along[(reference, *k)]);
        }
        let combine = |chosen: &[usize]| self.combine(&combinations, chosen);
        let softer = softer.chunks(waves).map(combine).collect();
        Some(Ritz { squares, waves: combine(&order), overlaps, softer })
    }

    /// The waves given by the `chosen` columns of `combinations`, with a row for each wave of each block.
    fn combine(&self, combinations: &DMatrix<C>, chosen: &[usize]) -> Block {
        let mut x = vec![Amplitude::STILL; self.blocks[0].x.len()];
        for (wave, k) in chosen.iter().enumerate() {
            for (at, held) in self.blocks.iter().enumerate() {
                for from in 0..self.waves {
                    let share = combinations[(at * self.waves + from, *k)];
                    for (sum, x) in x.iter_mut().zip(&held.x) {
                        for row in 0..6 {
                            let value = share * C::new(x.re[row].0[from], x.im[row].0[from]);
                            sum.re[row].0[wave] += value.re;
                            sum.im[row].0[wave] += value.im;
                        }
                    }
                }
            }
        }
        x
    }
}

/// x* y of wave `a` of x and wave `b` of y.
pub(crate) fn product(x: &[Amplitude], a: usize, y: &[Amplitude], b: usize) -> C {
    let mut sum = C::new(0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        for k in 0..6 {
            let (xr, xi) = (x.re[k].0[a], x.im[k].0[a]);
            let (yr, yi) = (y.re[k].0[b], y.im[k].0[b]);
            sum.re += xr * yr + xi * yi;
            sum.im += xr * yi - xi * yr;
        }
    }
    sum
}
