//! Conjugate gradients on the sweeps of a network, in one precision.

use super::gauss_seidel::{Rows, Sweeps, add_products, still};
use super::lanes::{Real, WIDTH, add, mul_add};
use grainlab_core::instruction_sets::{Work, with_avx2};

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

    /// [`Descent::descend`] with the widest vectors that the processor has. All processors give the same bits.
    pub(crate) fn run(&mut self, goal: &Goal) -> u32 {
        with_avx2(Run { descent: self, goal }).unwrap_or_else(Run::run)
    }

    /// Iterates from the residual r in `rest`, with the squared norms `squares`, until that of every column
    /// is at most its target, or `limit` iterations are done. Leaves the x with K x ≈ r in `motion`. Returns
    /// the number of iterations.
    #[inline(always)]
    fn descend(&mut self, goal: &Goal) -> u32 {
        let Goal { squares, targets, limit, growth } = goal;
        let mut far = [false; WIDTH];
        for l in 0..WIDTH {
            far[l] = squares[l] > targets[l];
        }
        self.motion.fill(still());
        self.step.fill(still());
        self.sweeps.forward(&mut self.rest);
        let mut rho = self.weigh();
        let (mut alpha, mut beta) = ([0.0; WIDTH], [0.0; WIDTH]);
        // Squared norm of the residual r over ρ = r̂ᵀ D r̂, at the last check.
        let mut share = ratios(squares, &rho);
        let mut least = rho.map(|rho| (rho, 0));
        self.lost_after = None;
        let mut done = *limit;
        for iteration in 0..*limit {
            let mut energy = self.back(&alpha, &beta);
            let soft = self.sweeps.leave_out(&self.half, &mut self.taken);
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
            rho = self.forth(&alpha);
            beta = ratios(&rho, &before);
            let mut look = false;
            for l in 0..WIDTH {
                look |= far[l] && share[l] * rho[l] <= targets[l];
            }
            if look {
                let squares = self.sweeps.squares(&self.rest, &mut self.taken);
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
        self.follow(&alpha);
        self.sweeps.backward(&mut self.motion);
        done
    }

    /// r̂ᵀ D r̂.
    #[inline(always)]
    fn weigh(&self) -> [f64; WIDTH] {
        let mut rho = [0.0; WIDTH];
        for g in 0..self.rest.len() {
            let r = self.rest[g];
            add_products(&r, &self.sweeps.diagonal(g, &r), &mut rho);
        }
        rho
    }

    /// x̂ += α p, p = D r̂ + β p, t and s, from the last grain to the first. Returns pᵀ Â p = tᵀ K t, which is
    /// tᵀ (D t + 2 Lᵀ t) = tᵀ (p + s).
    #[inline(always)]
    fn back(&mut self, alpha: &[f64; WIDTH], beta: &[f64; WIDTH]) -> [f64; WIDTH] {
        let (alpha, beta) = (rounded(alpha), rounded(beta));
        let mut energy = [0.0; WIDTH];
        for g in (0..self.step.len()).rev() {
            let z = self.sweeps.diagonal(g, &self.rest[g]);
            let (mut x, mut p) = (self.motion[g], self.step[g]);
            for k in 0..6 {
                x[k] = mul_add(alpha, p[k], x[k]);
                p[k] = mul_add(beta, p[k], z[k]);
            }
            self.motion[g] = x;
            self.step[g] = p;
            let (t, s) = self.sweeps.backward_step(g, &p, &self.half);
            self.half[g] = t;
            self.taken[g] = s;
            for k in 0..6 {
                p[k] = add(p[k], s[k]);
            }
            add_products(&t, &p, &mut energy);
        }
        energy
    }

    /// r̂ −= α Â p with Â p = t + (D + L)⁻¹ s, from the first grain to the last; returns r̂ᵀ D r̂.
    #[inline(always)]
    fn forth(&mut self, alpha: &[f64; WIDTH]) -> [f64; WIDTH] {
        let mut back = *alpha;
        for l in 0..WIDTH {
            back[l] = -alpha[l];
        }
        let back = rounded(&back);
        let mut rho = [0.0; WIDTH];
        for g in 0..self.rest.len() {
            let u = self.sweeps.forward_step(g, &mut self.taken);
            let (mut r, t) = (self.rest[g], self.half[g]);
            for k in 0..6 {
                r[k] = mul_add(back, add(t[k], u[k]), r[k]);
            }
            self.rest[g] = r;
            add_products(&r, &self.sweeps.diagonal(g, &r), &mut rho);
        }
        rho
    }

    /// x̂ += α p.
    #[inline(always)]
    fn follow(&mut self, alpha: &[f64; WIDTH]) {
        let alpha = rounded(alpha);
        for (x, p) in self.motion.iter_mut().zip(&self.step) {
            for k in 0..6 {
                x[k] = mul_add(alpha, p[k], x[k]);
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// Squared norms of the residual at the start.
    pub(crate) squares: [f64; WIDTH],
    /// Squared norms at which it ends.
    pub(crate) targets: [f64; WIDTH],
    pub(crate) limit: u32,
    /// Growth of a squared residual at which the descent ends, as it does at a direction that meets no resistance; none if it does at
    /// neither.
    pub(crate) growth: Option<f64>,
}

/// [`Descent::descend`] with its arguments. It contains no closures: these are not inlined, and would use the baseline
/// instruction set.
struct Run<'d, 'a, T, const G: bool> {
    descent: &'d mut Descent<'a, T, G>,
    goal: &'d Goal,
}

impl<T: Real, const G: bool> Work for Run<'_, '_, T, G> {
    type Output = u32;

    #[inline(always)]
    fn run(self) -> u32 {
        self.descent.descend(self.goal)
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
