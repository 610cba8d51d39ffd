//! Conjugate gradients on the sweeps of a network, in one precision.

use super::gauss_seidel::{Rows, Sweeps, add_products, load, still, store};
#[cfg(target_arch = "x86_64")]
use super::lanes::Avx2;
use super::lanes::{Lanes, Plain, Real, WIDTH};
use grainlab_core::instruction_sets::{Work, with_avx2};
use std::marker::PhantomData;

/// The vectors of the conjugate gradients, one entry per grain, in the order of the sweeps.
#[derive(Debug)]
pub(crate) struct Descent<'a, T, const G: bool> {
    pub(crate) sweeps: &'a Sweeps<T, G>,
    /// x̂ = (D + L)ᵀ x; at the end x.
    pub(crate) motion: Vec<Rows<T>>,
    /// r̂ = (D + L)⁻¹ r, by recurrence; at the start r.
    pub(crate) rest: Vec<Rows<T>>,
    /// Search direction p.
    step: Vec<Rows<T>>,
    /// t = (D + L)⁻ᵀ p.
    half: Vec<Rows<T>>,
    /// s = p − D t = Lᵀ t, consumed by the forward sweep.
    taken: Vec<Rows<T>>,
    /// True if a direction of negative stiffness was found, which requires prestress.
    pub(crate) unstable: bool,
    /// Number of iterations to the least residual of a column, if the descent ended because a direction of the column met no
    /// resistance, or its residual had grown by [`Goal::growth`].
    pub(crate) lost_after: Option<u32>,
}

impl<'a, T: Real, const G: bool> Descent<'a, T, G> {
    pub(crate) fn new(sweeps: &'a Sweeps<T, G>) -> Self {
        let zero = || vec![still(); sweeps.grains()];
        Self {
            sweeps,
            motion: zero(),
            rest: zero(),
            step: zero(),
            half: zero(),
            taken: zero(),
            unstable: false,
            lost_after: None,
        }
    }

    /// Iterates from the residual r in `rest`, with the squared norms `squares`, until that of every column
    /// is at most its target, or `limit` iterations are done. Leaves the x with K x ≈ r in `motion`. Returns
    /// the number of iterations.
    #[inline(always)]
    fn descend<V: Lanes<T = T>>(&mut self, v: V, goal: &Goal) -> u32 {
        let Goal { squares, targets, limit, growth } = goal;
        let mut far = [false; WIDTH];
        for l in 0..WIDTH {
            far[l] = squares[l] > targets[l];
        }
        self.motion.fill(still());
        self.step.fill(still());
        self.sweeps.forward(v, &mut self.rest);
        let mut rho = self.weigh(v);
        let (mut alpha, mut beta) = ([0.0; WIDTH], [0.0; WIDTH]);
        // Squared norm of the residual r over ρ = r̂ᵀ D r̂, at the last check.
        let mut share = ratios(squares, &rho);
        let mut least = rho.map(|rho| (rho, 0));
        self.lost_after = None;
        let mut done = *limit;
        for iteration in 0..*limit {
            let mut energy = self.back(v, &alpha, &beta);
            let soft = self.sweeps.leave_out(v, &self.half, &mut self.taken);
            for l in 0..WIDTH {
                energy[l] -= soft[l];
            }
            alpha = ratios(&rho, &energy);
            for l in 0..WIDTH {
                self.unstable |= G && far[l] && (energy[l] < 0.0 || rho[l] < 0.0);
                let is_lost = growth.is_some_and(|growth| energy[l] <= 0.0 || rho[l] > growth * least[l].0);
                if far[l] && is_lost {
                    self.lost_after = Some(self.lost_after.map_or(least[l].1, |after| after.min(least[l].1)));
                } else if rho[l] < least[l].0 {
                    least[l] = (rho[l], iteration);
                }
                // A converged column is not changed any more, so that its rounding errors cannot grow.
                if !far[l] {
                    alpha[l] = 0.0;
                }
            }
            if self.lost_after.is_some() {
                done = iteration + 1;
                break;
            }
            let before = rho;
            rho = self.forth(v, &alpha);
            beta = ratios(&rho, &before);
            let mut look = false;
            for l in 0..WIDTH {
                look |= far[l] && share[l] * rho[l] <= targets[l];
            }
            if look {
                let squares = self.sweeps.squares(v, &self.rest, &mut self.taken);
                share = ratios(&squares, &rho);
                let mut any = false;
                for l in 0..WIDTH {
                    far[l] &= squares[l] > targets[l];
                    any |= far[l];
                }
                if !any {
                    done = iteration + 1;
                    break;
                }
            }
        }
        self.follow(v, &alpha);
        self.sweeps.backward(v, &mut self.motion);
        done
    }

    /// r̂ᵀ D r̂.
    #[inline(always)]
    fn weigh<V: Lanes<T = T>>(&self, v: V) -> [f64; WIDTH] {
        let mut rho = [0.0; WIDTH];
        for g in 0..self.rest.len() {
            let r = load(v, &self.rest[g]);
            add_products(v, &r, &self.sweeps.diagonal(v, g, &r), &mut rho);
        }
        rho
    }

    /// x̂ += α p, p = D r̂ + β p, t and s, from the last grain to the first. Returns pᵀ Â p = tᵀ K t, which is
    /// tᵀ (D t + 2 Lᵀ t) = tᵀ (p + s).
    #[inline(always)]
    fn back<V: Lanes<T = T>>(&mut self, v: V, alpha: &[f64; WIDTH], beta: &[f64; WIDTH]) -> [f64; WIDTH] {
        let (alpha, beta) = (v.load(&rounded(alpha)), v.load(&rounded(beta)));
        let mut energy = [0.0; WIDTH];
        for g in (0..self.step.len()).rev() {
            let z = self.sweeps.diagonal(v, g, &load(v, &self.rest[g]));
            let (mut x, mut p) = (load(v, &self.motion[g]), load(v, &self.step[g]));
            for k in 0..6 {
                x[k] = v.mul_add(alpha, p[k], x[k]);
                p[k] = v.mul_add(beta, p[k], z[k]);
            }
            store(v, &x, &mut self.motion[g]);
            store(v, &p, &mut self.step[g]);
            let (t, s) = self.sweeps.backward_step(v, g, &p, &self.half);
            store(v, &t, &mut self.half[g]);
            store(v, &s, &mut self.taken[g]);
            for k in 0..6 {
                p[k] = v.add(p[k], s[k]);
            }
            add_products(v, &t, &p, &mut energy);
        }
        energy
    }

    /// r̂ −= α Â p with Â p = t + (D + L)⁻¹ s, from the first grain to the last; returns r̂ᵀ D r̂.
    #[inline(always)]
    fn forth<V: Lanes<T = T>>(&mut self, v: V, alpha: &[f64; WIDTH]) -> [f64; WIDTH] {
        let mut back = *alpha;
        for l in 0..WIDTH {
            back[l] = -alpha[l];
        }
        let back = v.load(&rounded(&back));
        let mut rho = [0.0; WIDTH];
        for g in 0..self.rest.len() {
            let u = self.sweeps.forward_step(v, g, &mut self.taken);
            let (mut r, t) = (load(v, &self.rest[g]), load(v, &self.half[g]));
            for k in 0..6 {
                r[k] = v.mul_add(back, v.add(t[k], u[k]), r[k]);
            }
            store(v, &r, &mut self.rest[g]);
            add_products(v, &r, &self.sweeps.diagonal(v, g, &r), &mut rho);
        }
        rho
    }

    /// x̂ += α p.
    #[inline(always)]
    fn follow<V: Lanes<T = T>>(&mut self, v: V, alpha: &[f64; WIDTH]) {
        let alpha = v.load(&rounded(alpha));
        for g in 0..self.motion.len() {
            let (mut x, p) = (load(v, &self.motion[g]), load(v, &self.step[g]));
            for k in 0..6 {
                x[k] = v.mul_add(alpha, p[k], x[k]);
            }
            store(v, &x, &mut self.motion[g]);
        }
    }
}

/// Start and end of a descent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// Squared norms of the residual at the start.
    pub(crate) squares: [f64; WIDTH],
    /// Squared norms at which it ends.
    pub(crate) targets: [f64; WIDTH],
    /// Maximum number of iterations.
    pub(crate) limit: u32,
    /// Growth of a squared residual at which the descent ends, as it does at a direction that meets no resistance; none if it does at
    /// neither.
    pub(crate) growth: Option<f64>,
}

/// A precision of a descent, with the widest vectors that the processor has for it.
pub(crate) trait Precision: Real {
    /// See [`Descent::descend`]. All processors give the same bits.
    fn run<const G: bool>(descent: &mut Descent<'_, Self, G>, goal: &Goal) -> u32;
}

impl Precision for f32 {
    fn run<const G: bool>(descent: &mut Descent<'_, Self, G>, goal: &Goal) -> u32 {
        #[cfg(target_arch = "x86_64")]
        if let Some(lanes) = Avx2::of_processor()
            && let Ok(iterations) = with_avx2(Run { descent, goal, lanes })
        {
            return iterations;
        }
        descent.descend(Plain(PhantomData), goal)
    }
}

impl Precision for f64 {
    fn run<const G: bool>(descent: &mut Descent<'_, Self, G>, goal: &Goal) -> u32 {
        with_avx2(Run { descent, goal, lanes: Plain(PhantomData) }).unwrap_or_else(Run::run)
    }
}

/// [`Descent::descend`] with its arguments. It contains no closures: these are not inlined, and would use the baseline
/// instruction set.
struct Run<'d, 'a, V: Lanes, const G: bool> {
    descent: &'d mut Descent<'a, V::T, G>,
    goal: &'d Goal,
    lanes: V,
}

impl<V: Lanes, const G: bool> Work for Run<'_, '_, V, G> {
    type Output = u32;

    #[inline(always)]
    fn run(self) -> u32 {
        self.descent.descend(self.lanes, self.goal)
    }
}

#[inline(always)]
fn ratios(above: &[f64; WIDTH], below: &[f64; WIDTH]) -> [f64; WIDTH] {
    let mut ratios = [0.0; WIDTH];
    for l in 0..WIDTH {
        ratios[l] = if below[l] > 0.0 { above[l] / below[l] } else { 0.0 };
    }
    ratios
}

#[inline(always)]
fn rounded<T: Real>(values: &[f64; WIDTH]) -> [T; WIDTH] {
    let mut all = [T::ZERO; WIDTH];
    for l in 0..WIDTH {
        all[l] = T::of(values[l]);
    }
    all
}
