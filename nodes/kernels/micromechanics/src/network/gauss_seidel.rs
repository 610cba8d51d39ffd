//! The operator K = L + D + Lᵀ in triangular halves: D the 6×6 blocks of the grains, L the coupling of
//! earlier to later grains.
//!
//! Conjugate gradients run on Â = (D + L)⁻¹ K (D + L)⁻ᵀ with the preconditioner D⁻¹, which is symmetric
//! Gauss–Seidel on K. Since K = (D + L) + (D + L)ᵀ − D, one product Â p = t + (D + L)⁻¹ (p − D t), t = (D +
//! L)⁻ᵀ p, costs as much as one product with K (Eisenstat, SIAM J. Sci. Stat. Comput. 2, 1 (1981)).
//!
//! Blocks may be singular: a null vector of a block is one of the whole network, so that a generalised
//! inverse suffices.

use super::lanes::{Lanes, Real, WIDTH};
use super::preconditioner::{Block, generalised_inverse};
use super::soft_motions::SoftMotion;
use super::spring_network::{ContactSpring, SpringNetwork};

/// Degrees of freedom of one grain, or the conjugate forces, in the units of the sweeps: rows u_x, u_y, u_z,
/// φ_x, φ_y, φ_z.
pub(crate) type Rows<T> = [[T; WIDTH]; 6];

/// A grain at rest.
pub(crate) const fn still<T: Real>() -> Rows<T> {
    [[T::ZERO; WIDTH]; 6]
}

/// [`Rows`] in registers.
type Six<V> = [<V as Lanes>::Row; 6];

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

/// Place of an entry in a packed block.
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

    /// Number of grains.
    #[inline(always)]
    pub(crate) fn grains(&self) -> usize {
        self.order.len()
    }

    /// D x of grain `g`.
    #[inline(always)]
    pub(crate) fn diagonal<V: Lanes<T = T>>(&self, v: V, g: usize, x: &Six<V>) -> Six<V> {
        product(v, &self.blocks[g], x)
    }

    /// y = (D + L)⁻¹ y in place.
    #[inline(always)]
    pub(crate) fn forward<V: Lanes<T = T>>(&self, v: V, y: &mut [Rows<T>]) {
        for g in 0..self.grains() {
            let u = self.forward_step(v, g, y);
            store(v, &u, &mut y[g]);
        }
    }

    /// One step of that, from the first grain to the last: returns u of grain `g` and subtracts its effect on
    /// later grains from their entries.
    #[inline(always)]
    pub(crate) fn forward_step<V: Lanes<T = T>>(&self, v: V, g: usize, y: &mut [Rows<T>]) -> Six<V> {
        let u = product(v, &self.inverse[g], &load(v, &y[g]));
        for s in self.later(g) {
            let y = &mut y[s.later as usize];
            let rest = s.push::<V, G>(v, &u, load(v, y));
            store(v, &rest, y);
        }
        u
    }

    /// y = (D + L)⁻ᵀ y in place.
    #[inline(always)]
    pub(crate) fn backward<V: Lanes<T = T>>(&self, v: V, y: &mut [Rows<T>]) {
        for g in (0..self.grains()).rev() {
            let rest = self.left_by_later(v, g, load(v, &y[g]), y);
            store(v, &product(v, &self.inverse[g], &rest), &mut y[g]);
        }
    }

    /// One step of t = (D + L)⁻ᵀ p, from the last grain to the first: t and s = p − D t of grain `g`, from its p and the
    /// t of later grains.
    #[inline(always)]
    pub(crate) fn backward_step<V: Lanes<T = T>>(
        &self,
        v: V,
        g: usize,
        p: &Six<V>,
        t: &[Rows<T>],
    ) -> (Six<V>, Six<V>) {
        let rest = self.left_by_later(v, g, *p, t);
        let minus = v.splat(T::of(-1.0));
        let mut taken = *p;
        for k in 0..6 {
            taken[k] = v.mul_add(rest[k], minus, p[k]);
        }
        (product(v, &self.inverse[g], &rest), taken)
    }

    /// Takes the forces Σ K w wᵀ K t of the soft motions off `taken`. Returns their work tᵀ Σ K w wᵀ K t.
    #[inline(always)]
    pub(crate) fn leave_out<V: Lanes<T = T>>(
        &self,
        v: V,
        t: &[Rows<T>],
        taken: &mut [Rows<T>],
    ) -> [f64; WIDTH] {
        let mut work = [0.0; WIDTH];
        let mut start = 0;
        for end in &self.soft_ends {
            let forces = &self.soft[start..*end as usize];
            start = *end as usize;
            let mut share = v.splat(T::ZERO);
            for (g, force) in forces {
                let t = load(v, &t[*g as usize]);
                for k in 0..6 {
                    share = v.mul_add(v.splat(force[k]), t[k], share);
                }
            }
            for (g, force) in forces {
                let mut s = load(v, &taken[*g as usize]);
                for k in 0..6 {
                    s[k] = v.mul_sub_from(v.splat(force[k]), share, s[k]);
                }
                store(v, &s, &mut taken[*g as usize]);
            }
            let mut columns = [T::ZERO; WIDTH];
            v.store(share, &mut columns);
            for l in 0..WIDTH {
                work[l] += columns[l].wide() * columns[l].wide();
            }
        }
        work
    }

    /// Squared norms of (D + L) r, the residual of K.
    #[inline(always)]
    pub(crate) fn squares<V: Lanes<T = T>>(
        &self,
        v: V,
        r: &[Rows<T>],
        scratch: &mut [Rows<T>],
    ) -> [f64; WIDTH] {
        for g in 0..self.grains() {
            store(v, &product(v, &self.blocks[g], &load(v, &r[g])), &mut scratch[g]);
        }
        let mut squares = [0.0; WIDTH];
        let minus = v.splat(T::of(-1.0));
        for g in 0..self.grains() {
            let mut opposite = load(v, &r[g]);
            for row in &mut opposite {
                *row = v.mul(*row, minus);
            }
            for s in self.later(g) {
                let y = &mut scratch[s.later as usize];
                let sum = s.push::<V, G>(v, &opposite, load(v, y));
                store(v, &sum, y);
            }
            let y = load(v, &scratch[g]);
            add_products(v, &y, &y, &mut squares);
        }
        squares
    }

    /// `rest` minus the effect of the motions of later grains on grain `g`.
    #[inline(always)]
    fn left_by_later<V: Lanes<T = T>>(&self, v: V, g: usize, mut rest: Six<V>, motion: &[Rows<T>]) -> Six<V> {
        for s in self.later(g) {
            rest = s.pull::<V, G>(v, &load(v, &motion[s.later as usize]), rest);
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
    fn push<V: Lanes<T = T>, const G: bool>(&self, v: V, a: &Six<V>, rest: Six<V>) -> Six<V> {
        self.taken_off::<V, G>(v, a, self.levers, rest)
    }

    /// `rest` of the earlier grain minus the effect of the motion `b` of the later one: the same with
    /// exchanged levers.
    #[inline(always)]
    fn pull<V: Lanes<T = T>, const G: bool>(&self, v: V, b: &Six<V>, rest: Six<V>) -> Six<V> {
        let [earlier, later] = self.levers;
        self.taken_off::<V, G>(v, b, [later, earlier].map(|arm| -arm), rest)
    }

    /// With the levers of the moving grain and of the other one.
    #[inline(always)]
    fn taken_off<V: Lanes<T = T>, const G: bool>(
        &self,
        v: V,
        a: &Six<V>,
        levers: [T; 2],
        mut rest: Six<V>,
    ) -> Six<V> {
        let [nx, ny, nz] = splats(v, &self.normal);
        let [from, to] = [v.splat(levers[0]), v.splat(levers[1])];
        let [mx, my, mz] = [v.mul(from, nx), v.mul(from, ny), v.mul(from, nz)];
        let [tx, ty, tz] = [v.mul(to, nx), v.mul(to, ny), v.mul(to, nz)];
        let (tangential, kn_minus_kt) = (v.splat(self.tangential), v.splat(self.kn_minus_kt));
        // u + φ×m, of this grain alone.
        let wx = v.mul_add(a[4], mz, v.mul_sub_from(a[5], my, a[0]));
        let wy = v.mul_add(a[5], mx, v.mul_sub_from(a[3], mz, a[1]));
        let wz = v.mul_add(a[3], my, v.mul_sub_from(a[4], mx, a[2]));
        let along = v.mul(kn_minus_kt, v.mul_add(nz, wz, v.mul_add(ny, wy, v.mul(nx, wx))));
        let fx = v.mul_add(tangential, wx, v.mul(along, nx));
        let fy = v.mul_add(tangential, wy, v.mul(along, ny));
        let fz = v.mul_add(tangential, wz, v.mul(along, nz));
        rest[0] = v.add(rest[0], fx);
        rest[1] = v.add(rest[1], fy);
        rest[2] = v.add(rest[2], fz);
        // −t×f.
        rest[3] = v.mul_sub_from(ty, fz, v.mul_add(tz, fy, rest[3]));
        rest[4] = v.mul_sub_from(tz, fx, v.mul_add(tx, fz, rest[4]));
        rest[5] = v.mul_sub_from(tx, fy, v.mul_add(ty, fx, rest[5]));
        if G {
            // −g (1 − nn) u.
            let (gain, loss) = (v.splat(self.geometric), v.splat(-self.geometric));
            let along = v.mul(gain, v.mul_add(nz, a[2], v.mul_add(ny, a[1], v.mul(nx, a[0]))));
            rest[0] = v.mul_add(loss, a[0], v.mul_add(along, nx, rest[0]));
            rest[1] = v.mul_add(loss, a[1], v.mul_add(along, ny, rest[1]));
            rest[2] = v.mul_add(loss, a[2], v.mul_add(along, nz, rest[2]));
        }
        rest
    }
}

#[inline(always)]
fn splats<V: Lanes>(v: V, three: &[V::T; 3]) -> [V::Row; 3] {
    [v.splat(three[0]), v.splat(three[1]), v.splat(three[2])]
}

#[inline(always)]
pub(crate) fn load<V: Lanes>(v: V, x: &Rows<V::T>) -> Six<V> {
    [v.load(&x[0]), v.load(&x[1]), v.load(&x[2]), v.load(&x[3]), v.load(&x[4]), v.load(&x[5])]
}

#[inline(always)]
pub(crate) fn store<V: Lanes>(v: V, x: &Six<V>, to: &mut Rows<V::T>) {
    for k in 0..6 {
        v.store(x[k], &mut to[k]);
    }
}

/// Product m x.
#[inline(always)]
fn product<V: Lanes>(v: V, m: &Packed<V::T>, x: &Six<V>) -> Six<V> {
    [
        row::<V, 0>(v, m, x),
        row::<V, 1>(v, m, x),
        row::<V, 2>(v, m, x),
        row::<V, 3>(v, m, x),
        row::<V, 4>(v, m, x),
        row::<V, 5>(v, m, x),
    ]
}

#[inline(always)]
fn row<V: Lanes, const K: usize>(v: V, m: &Packed<V::T>, x: &Six<V>) -> V::Row {
    let sum = v.mul(v.splat(m[const { place(K, 0) }]), x[0]);
    let sum = v.mul_add(v.splat(m[const { place(K, 1) }]), x[1], sum);
    let sum = v.mul_add(v.splat(m[const { place(K, 2) }]), x[2], sum);
    let sum = v.mul_add(v.splat(m[const { place(K, 3) }]), x[3], sum);
    let sum = v.mul_add(v.splat(m[const { place(K, 4) }]), x[4], sum);
    v.mul_add(v.splat(m[const { place(K, 5) }]), x[5], sum)
}

/// Adds xᵀ y of each column to `sum`. Six products are added up in T before they are widened.
#[inline(always)]
pub(crate) fn add_products<V: Lanes>(v: V, x: &Six<V>, y: &Six<V>, sum: &mut [f64; WIDTH]) {
    let mut local = v.mul(x[0], y[0]);
    for k in 1..6 {
        local = v.mul_add(x[k], y[k], local);
    }
    let mut columns = [V::T::ZERO; WIDTH];
    v.store(local, &mut columns);
    for l in 0..WIDTH {
        sum[l] += columns[l].wide();
    }
}
