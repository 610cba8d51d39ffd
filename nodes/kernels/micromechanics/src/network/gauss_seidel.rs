//! The operator K = L + D + Lᵀ in triangular halves: D the 6×6 blocks of the grains, L the coupling of
//! earlier to later grains.
//!
//! Conjugate gradients run on Â = (D + L)⁻¹ K (D + L)⁻ᵀ with the preconditioner D⁻¹, which is symmetric
//! Gauss–Seidel on K. Since K = (D + L) + (D + L)ᵀ − D, one product Â p = t + (D + L)⁻¹ (p − D t), t = (D +
//! L)⁻ᵀ p, costs as much as one product with K (Eisenstat, SIAM J. Sci. Stat. Comput. 2, 1 (1981)).
//!
//! Blocks may be singular: a null vector of a block is one of the whole network, so that a generalised
//! inverse suffices.

use super::lanes::{Real, Row, WIDTH, add, mul, mul_add, mul_sub_from, splat};
use super::preconditioner::{Block, generalised_inverse};
use super::soft_motions::SoftMotion;
use super::spring_network::{ContactSpring, SpringNetwork};

/// Degrees of freedom of one grain, or the conjugate forces, in the units of the sweeps: rows u_x, u_y, u_z,
/// φ_x, φ_y, φ_z.
pub(crate) type Rows<T> = [Row<T>; 6];

pub(crate) const fn still<T: Real>() -> Rows<T> {
    [[T::ZERO; WIDTH]; 6]
}

/// The halves of one network, grains in the order of a space-filling curve, stiffnesses in units of
/// [`Sweeps::unit`]. `G`: with the prestress term.
#[derive(Clone, Debug)]
pub(crate) struct Sweeps<T, const G: bool> {
    /// Between different grains, the earlier one first, sorted by both; contacts with own images are only in
    /// D.
    springs: Vec<Half<T>>,
    /// Springs of grain g to later grains: `springs[first[g]..first[g + 1]]`.
    first: Vec<u32>,
    /// Diagonal blocks D.
    blocks: Vec<Packed<T>>,
    /// Generalised inverses D⁻¹.
    inverse: Vec<Packed<T>>,
    /// Forces K w of the soft motions, each up to its end, scaled to wᵀ K w = 1.
    soft: Vec<(u32, [T; 6])>,
    soft_ends: Vec<u32>,
    /// Grain of the packing at each place.
    pub(crate) order: Vec<u32>,
    /// Mean stiffness of a block's displacements, N/m.
    pub(crate) unit: f64,
}

/// A symmetric block, row by row up to the diagonal.
type Packed<T> = [T; 21];

#[inline(always)]
const fn place(row: usize, column: usize) -> usize {
    let (low, high) = if row < column { (row, column) } else { (column, row) };
    high * (high + 1) / 2 + low
}

/// One contact as stored with the earlier of its grains.
#[derive(Clone, Copy, Debug)]
struct Half<T> {
    later: u32,
    /// Towards the later grain.
    normal: [T; 3],
    /// Levers of the earlier and the later grain.
    levers: [T; 2],
    tangential: T,
    kn_minus_kt: T,
    geometric: T,
}

impl<T: Real, const G: bool> Sweeps<T, G> {
    pub(crate) fn new(network: &SpringNetwork) -> Self {
        let order = network.order.clone();
        let places = places(&order);
        let blocks = network.diagonal_blocks();
        let traces: f64 = blocks.iter().map(|b| b[0][0] + b[1][1] + b[2][2]).sum();
        let unit = if traces > 0.0 { traces / (3 * blocks.len()) as f64 } else { 1.0 };
        let between = |s: &&ContactSpring| s.i != s.j;
        let mut springs: Vec<(u32, Half<T>)> =
            network.springs.iter().filter(between).map(|s| Half::of(s, &places, unit)).collect();
        springs.sort_by_key(|(earlier, half)| (*earlier, half.later));
        let mut first = vec![0u32; order.len() + 1];
        springs.iter().for_each(|(earlier, _)| first[*earlier as usize + 1] += 1);
        for g in 0..order.len() {
            first[g + 1] += first[g];
        }
        let rounded = |block: &Block, unit: f64| {
            let mut packed = [T::ZERO; 21];
            for (k, row) in block.iter().enumerate() {
                for (c, value) in row.iter().enumerate().take(k + 1) {
                    packed[place(k, c)] = T::of(value * unit);
                }
            }
            packed
        };
        Self {
            springs: springs.into_iter().map(|(_, half)| half).collect(),
            first,
            inverse: order
                .iter()
                .map(|g| rounded(&generalised_inverse(&blocks[*g as usize]), unit))
                .collect(),
            blocks: order.iter().map(|g| rounded(&blocks[*g as usize], 1.0 / unit)).collect(),
            soft: Vec::new(),
            soft_ends: Vec::new(),
            order,
            unit,
        }
    }

    /// With K − Σ K w wᵀ K in place of K in [`Sweeps::leave_out`].
    pub(crate) fn without(mut self, motions: &[SoftMotion]) -> Self {
        let places = places(&self.order);
        for motion in motions {
            let entries = motion.force.iter();
            self.soft
                .extend(entries.map(|(g, f)| (places[*g as usize], f.map(|f| T::of(f / self.unit.sqrt())))));
            self.soft_ends.push(self.soft.len() as u32);
        }
        self
    }

    #[inline(always)]
    pub(crate) fn grains(&self) -> usize {
        self.order.len()
    }

    /// D x of grain `g`.
    #[inline(always)]
    pub(crate) fn diagonal(&self, g: usize, x: &Rows<T>) -> Rows<T> {
        product(&self.blocks[g], x)
    }

    /// y = (D + L)⁻¹ y in place.
    #[inline(always)]
    pub(crate) fn forward(&self, y: &mut [Rows<T>]) {
        for g in 0..self.grains() {
            y[g] = self.forward_step(g, y);
        }
    }

    /// Returns u of grain `g`, and subtracts its effect on later grains from their entries.
    #[inline(always)]
    pub(crate) fn forward_step(&self, g: usize, y: &mut [Rows<T>]) -> Rows<T> {
        let u = product(&self.inverse[g], &y[g]);
        for s in self.later(g) {
            let y = &mut y[s.later as usize];
            *y = s.push::<G>(&u, *y);
        }
        u
    }

    /// y = (D + L)⁻ᵀ y in place.
    #[inline(always)]
    pub(crate) fn backward(&self, y: &mut [Rows<T>]) {
        for g in (0..self.grains()).rev() {
            let rest = self.left_by_later(g, y[g], y);
            y[g] = product(&self.inverse[g], &rest);
        }
    }

    /// One step of t = (D + L)⁻ᵀ p, from the last grain to the first: t and s = p − D t of grain `g`, from its p and the
    /// t of later grains.
    #[inline(always)]
    pub(crate) fn backward_step(&self, g: usize, p: &Rows<T>, t: &[Rows<T>]) -> (Rows<T>, Rows<T>) {
        let rest = self.left_by_later(g, *p, t);
        let minus = splat(T::of(-1.0));
        let mut taken = *p;
        for k in 0..6 {
            taken[k] = mul_add(rest[k], minus, p[k]);
        }
        (product(&self.inverse[g], &rest), taken)
    }

    /// Takes the forces Σ K w wᵀ K t of the soft motions off `taken`. Returns their work tᵀ Σ K w wᵀ K t.
    #[inline(always)]
    pub(crate) fn leave_out(&self, t: &[Rows<T>], taken: &mut [Rows<T>]) -> [f64; WIDTH] {
        let mut work = [0.0; WIDTH];
        let mut start = 0;
        for end in &self.soft_ends {
            let forces = &self.soft[start..*end as usize];
            start = *end as usize;
            let mut share = splat(T::ZERO);
            for (g, force) in forces {
                let t = t[*g as usize];
                for k in 0..6 {
                    share = mul_add(splat(force[k]), t[k], share);
                }
            }
            for (g, force) in forces {
                let s = &mut taken[*g as usize];
                for k in 0..6 {
                    s[k] = mul_sub_from(splat(force[k]), share, s[k]);
                }
            }
            for l in 0..WIDTH {
                work[l] += share[l].wide() * share[l].wide();
            }
        }
        work
    }

    /// Squared norms of (D + L) r, the residual of K.
    #[inline(always)]
    pub(crate) fn squares(&self, r: &[Rows<T>], scratch: &mut [Rows<T>]) -> [f64; WIDTH] {
        for g in 0..self.grains() {
            scratch[g] = product(&self.blocks[g], &r[g]);
        }
        let mut squares = [0.0; WIDTH];
        let minus = splat(T::of(-1.0));
        for g in 0..self.grains() {
            let mut opposite = r[g];
            for row in &mut opposite {
                *row = mul(*row, minus);
            }
            for s in self.later(g) {
                let y = &mut scratch[s.later as usize];
                *y = s.push::<G>(&opposite, *y);
            }
            add_products(&scratch[g], &scratch[g], &mut squares);
        }
        squares
    }

    /// `rest` minus the effect of the motions of later grains on grain `g`.
    #[inline(always)]
    fn left_by_later(&self, g: usize, mut rest: Rows<T>, motion: &[Rows<T>]) -> Rows<T> {
        for s in self.later(g) {
            rest = s.pull::<G>(&motion[s.later as usize], rest);
        }
        rest
    }

    #[inline(always)]
    fn later(&self, g: usize) -> &[Half<T>] {
        &self.springs[self.first[g] as usize..self.first[g + 1] as usize]
    }
}

/// Place of each grain, for the grain at each place.
fn places(order: &[u32]) -> Vec<u32> {
    let mut places = vec![0; order.len()];
    order.iter().zip(0u32..).for_each(|(grain, at)| places[*grain as usize] = at);
    places
}

impl<T: Real> Half<T> {
    /// With the place of the earlier grain.
    fn of(s: &ContactSpring, places: &[u32], unit: f64) -> (u32, Self) {
        let (i, j) = (places[s.i as usize], places[s.j as usize]);
        let side = if i < j { 1.0 } else { -1.0 };
        let [on_i, on_j] = s.levers();
        let levers = if i < j { [on_i, on_j] } else { [on_j, on_i] };
        let half = Self {
            later: i.max(j),
            normal: s.normal.map(|n| T::of(side * n)),
            levers: levers.map(T::of),
            tangential: T::of(s.tangential / unit),
            kn_minus_kt: T::of(s.kn_minus_kt / unit),
            geometric: T::of(s.geometric / unit),
        };
        (i.min(j), half)
    }

    /// `rest` of the later grain minus the effect of the motion `a` of the earlier one.
    #[inline(always)]
    fn push<const G: bool>(&self, a: &Rows<T>, rest: Rows<T>) -> Rows<T> {
        self.taken_off::<G>(a, self.levers, rest)
    }

    /// As [`Self::push`], from the later grain to the earlier: with exchanged levers.
    #[inline(always)]
    fn pull<const G: bool>(&self, b: &Rows<T>, rest: Rows<T>) -> Rows<T> {
        let [earlier, later] = self.levers;
        self.taken_off::<G>(b, [later, earlier].map(|arm| -arm), rest)
    }

    /// With the levers of the moving grain and of the other one.
    #[inline(always)]
    fn taken_off<const G: bool>(&self, a: &Rows<T>, levers: [T; 2], mut rest: Rows<T>) -> Rows<T> {
        let [nx, ny, nz] = [splat(self.normal[0]), splat(self.normal[1]), splat(self.normal[2])];
        let [from, to] = [splat(levers[0]), splat(levers[1])];
        let [mx, my, mz] = [mul(from, nx), mul(from, ny), mul(from, nz)];
        let [tx, ty, tz] = [mul(to, nx), mul(to, ny), mul(to, nz)];
        let (tangential, kn_minus_kt) = (splat(self.tangential), splat(self.kn_minus_kt));
        // u + φ×m, of this grain alone.
        let wx = mul_add(a[4], mz, mul_sub_from(a[5], my, a[0]));
        let wy = mul_add(a[5], mx, mul_sub_from(a[3], mz, a[1]));
        let wz = mul_add(a[3], my, mul_sub_from(a[4], mx, a[2]));
        let along = mul(kn_minus_kt, mul_add(nz, wz, mul_add(ny, wy, mul(nx, wx))));
        let fx = mul_add(tangential, wx, mul(along, nx));
        let fy = mul_add(tangential, wy, mul(along, ny));
        let fz = mul_add(tangential, wz, mul(along, nz));
        rest[0] = add(rest[0], fx);
        rest[1] = add(rest[1], fy);
        rest[2] = add(rest[2], fz);
        // −t×f.
        rest[3] = mul_sub_from(ty, fz, mul_add(tz, fy, rest[3]));
        rest[4] = mul_sub_from(tz, fx, mul_add(tx, fz, rest[4]));
        rest[5] = mul_sub_from(tx, fy, mul_add(ty, fx, rest[5]));
        if G {
            // −g (1 − nn) u.
            let (gain, loss) = (splat(self.geometric), splat(-self.geometric));
            let along = mul(gain, mul_add(nz, a[2], mul_add(ny, a[1], mul(nx, a[0]))));
            rest[0] = mul_add(loss, a[0], mul_add(along, nx, rest[0]));
            rest[1] = mul_add(loss, a[1], mul_add(along, ny, rest[1]));
            rest[2] = mul_add(loss, a[2], mul_add(along, nz, rest[2]));
        }
        rest
    }
}

#[inline(always)]
fn product<T: Real>(m: &Packed<T>, x: &Rows<T>) -> Rows<T> {
    [
        row::<T, 0>(m, x),
        row::<T, 1>(m, x),
        row::<T, 2>(m, x),
        row::<T, 3>(m, x),
        row::<T, 4>(m, x),
        row::<T, 5>(m, x),
    ]
}

#[inline(always)]
fn row<T: Real, const K: usize>(m: &Packed<T>, x: &Rows<T>) -> Row<T> {
    let sum = mul(splat(m[const { place(K, 0) }]), x[0]);
    let sum = mul_add(splat(m[const { place(K, 1) }]), x[1], sum);
    let sum = mul_add(splat(m[const { place(K, 2) }]), x[2], sum);
    let sum = mul_add(splat(m[const { place(K, 3) }]), x[3], sum);
    let sum = mul_add(splat(m[const { place(K, 4) }]), x[4], sum);
    mul_add(splat(m[const { place(K, 5) }]), x[5], sum)
}

/// Adds xᵀ y of each column to `sum`. Six products are added up in T before they are widened.
#[inline(always)]
pub(crate) fn add_products<T: Real>(x: &Rows<T>, y: &Rows<T>, sum: &mut [f64; WIDTH]) {
    let mut local = mul(x[0], y[0]);
    for k in 1..6 {
        local = mul_add(x[k], y[k], local);
    }
    for l in 0..WIDTH {
        sum[l] += local[l].wide();
    }
}
