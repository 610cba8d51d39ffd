//! The frozen contact network as a linear operator.
//!
//! Contact c between grains i and j, n from i to j, branch l = |l| n, springs k_c = k_n nn + k_t (1 − nn), all stuck:
//! the relative displacement at the contact is u_c = u_j − u_i + E·l − λ(θ_i + θ_j)×n with the lever λ = |l|/2, with
//! which a rigid rotation of the pair costs nothing. Rotations are held as φ = θ a (a the mean branch length over 2),
//! so that every degree of freedom is a displacement in m and every load a force in N.

use crate::error::MicroError;
use crate::preconditioner::Block;
use grains::Packing;
use nalgebra::Matrix6;

/// Displacement (m) and scaled rotation φ = θ a (m) of one grain, rows u_x, u_y, u_z, φ_x, φ_y, φ_z, for `L` loads at
/// once; or the forces and scaled torques (N) conjugate to them.
pub type Motion<const L: usize> = [[f64; L]; 6];

const ZERO: Motion<6> = [[0.0; 6]; 6];

/// Each direction of a grain in a column of its own.
const UNIT: Motion<6> = {
    let mut unit = ZERO;
    let mut k = 0;
    while k < 6 {
        unit[k][k] = 1.0;
        k += 1;
    }
    unit
};

/// One contact of the network, in what the operator needs: 64 bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spring {
    pub(crate) i: u32,
    pub(crate) j: u32,
    pub(crate) normal: [f64; 3],
    /// |l|/2, m.
    half_branch: f64,
    /// |l|/(2a): lever of a scaled rotation.
    pub(crate) lever: f64,
    /// k_t, N/m.
    pub(crate) tangential: f64,
    /// k_n − k_t, N/m.
    pub(crate) excess: f64,
}

/// The frozen contact network of a packing: grains, springs, volume.
#[derive(Clone, Debug)]
pub struct Network {
    springs: Vec<Spring>,
    grains: usize,
    volume: f64,
    rotation_length: f64,
    /// Grains along a space-filling curve.
    order: Vec<u32>,
}

impl Network {
    /// The network of every contact of `packing` at its present overlap, stuck (`tangential`: with k_t) or without
    /// tangential springs. The kinematics take the branch vectors, which must be along the contact normals.
    pub fn new(packing: &Packing, tangential: bool) -> Result<Self, MicroError> {
        let mut springs = Vec::with_capacity(packing.contacts.len());
        for (index, c) in packing.contacts.iter().enumerate() {
            let branch = packing.branch(c);
            let length = branch.norm();
            let normal = branch / length;
            let cosine = normal.dot(&c.normal);
            // NaN: the centres coincide.
            if cosine.is_nan() || cosine < 1.0 - 1e-6 {
                return Err(MicroError::Normal { contact: index, i: c.i, j: c.j, cosine });
            }
            let (k_n, k_t) = packing.contact_stiffness(c);
            let k_t = if tangential { k_t } else { 0.0 };
            springs.push(Spring {
                i: c.i,
                j: c.j,
                normal: normal.into(),
                half_branch: 0.5 * length,
                lever: 0.0,
                tangential: k_t,
                excess: k_n - k_t,
            });
        }
        let total: f64 = springs.iter().map(|s| s.half_branch).sum();
        let rotation_length = if springs.is_empty() { 1.0 } else { total / springs.len() as f64 };
        for s in &mut springs {
            s.lever = s.half_branch / rotation_length;
        }
        let mut order: Vec<u32> = (0..packing.grains() as u32).collect();
        order.sort_by_cached_key(|g| packing.cell.place_on_curve(&packing.positions[*g as usize]));
        Ok(Self { springs, grains: packing.grains(), volume: packing.cell.volume(), rotation_length, order })
    }

    /// Number of grains, those without contacts included.
    pub fn grains(&self) -> usize {
        self.grains
    }

    /// Number of contacts.
    pub fn contacts(&self) -> usize {
        self.springs.len()
    }

    pub(crate) fn springs(&self) -> &[Spring] {
        &self.springs
    }

    /// Grains in an order that keeps neighbours close in memory: a function of the positions.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// The length a that scales rotations, m: θ = φ/a.
    pub fn rotation_length(&self) -> f64 {
        self.rotation_length
    }

    /// y = K x for `L` motions at once, one entry per grain; returns xᵀ K x of each, J. Contacts are summed in the
    /// order of the packing, so the result is the same bit for bit on every call.
    pub fn apply<const L: usize>(&self, x: &[Motion<L>], y: &mut [Motion<L>]) -> [f64; L] {
        assert_eq!((x.len(), y.len()), (self.grains, self.grains), "one motion per grain");
        y.fill([[0.0; L]; 6]);
        let mut energy = [0.0; L];
        for s in &self.springs {
            let w = s.relative(&x[s.i as usize], &x[s.j as usize]);
            let f = s.force(&w);
            for lane in 0..L {
                energy[lane] += w[0][lane] * f[0][lane] + w[1][lane] * f[1][lane] + w[2][lane] * f[2][lane];
            }
            s.scatter(&f, y);
        }
        energy
    }

    /// Diagonal blocks of K, one per grain, N/m.
    pub fn diagonal_blocks(&self) -> Vec<Block> {
        let mut blocks = vec![[[0.0; 6]; 6]; self.grains];
        for s in &self.springs {
            let mut add = |grain: u32, a: &Motion<6>, b: &Motion<6>| {
                let w = s.relative(a, b);
                let block = s.energies(&w, &w);
                for (row, entries) in blocks[grain as usize].iter_mut().enumerate() {
                    for (column, entry) in entries.iter_mut().enumerate() {
                        *entry += block[row][column];
                    }
                }
            };
            if s.i == s.j {
                // An own image moves with the grain.
                add(s.i, &UNIT, &UNIT);
            } else {
                add(s.i, &UNIT, &ZERO);
                add(s.j, &ZERO, &UNIT);
            }
        }
        blocks
    }

    /// Loads −Ξ of the six unit strains (engineering shear), N per unit strain, and for each strain the norm that the
    /// loads would have if no two contact forces on a grain cancelled: the scale of a residual.
    pub fn strain_loads(&self) -> (Vec<Motion<6>>, [f64; 6]) {
        let mut loads = vec![[[0.0; 6]; 6]; self.grains];
        let mut squares = [0.0; 6];
        for s in &self.springs {
            let f = s.force(&s.affine());
            for lane in 0..6 {
                squares[lane] += 2.0 * (0..3).map(|k| f[k][lane] * f[k][lane]).sum::<f64>();
            }
            s.scatter(&f.map(|row| row.map(|v| -v)), &mut loads);
        }
        (loads, squares.map(f64::sqrt))
    }

    /// Stiffness, Pa, of the network whose grains move with the unit strains plus `motion` (none: affine motion), in
    /// two forms: by energy, Σ u_aᵀ k u_b/V, symmetric and never negative; and by stress, Σ (E_a l)ᵀ k u_b/V. They agree
    /// where `motion` balances all forces.
    pub fn stiffness(&self, motion: Option<&[Motion<6>]>) -> (Matrix6<f64>, Matrix6<f64>) {
        let (mut energy, mut stress) = (Matrix6::zeros(), Matrix6::zeros());
        for s in &self.springs {
            let affine = s.affine();
            let mut w = affine;
            if let Some(x) = motion {
                let relaxed = s.relative(&x[s.i as usize], &x[s.j as usize]);
                for (row, extra) in w.iter_mut().zip(&relaxed) {
                    row.iter_mut().zip(extra).for_each(|(a, b)| *a += b);
                }
            }
            let f = s.force(&w);
            for k in 0..3 {
                for a in 0..6 {
                    for b in 0..6 {
                        energy[(a, b)] += w[k][a] * f[k][b];
                        stress[(a, b)] += affine[k][a] * f[k][b];
                    }
                }
            }
        }
        let energy = (energy + energy.transpose()) * (0.5 / self.volume);
        (energy, stress / self.volume)
    }
}

impl Spring {
    /// The 6×6 block of K between grains i (rows) and j (columns), N/m; for different ones.
    pub(crate) fn coupling(&self) -> Block {
        self.energies(&self.relative(&UNIT, &ZERO), &self.relative(&ZERO, &UNIT))
    }

    /// aᵀ k_c b of every column of `a` with every column of `b`.
    fn energies(&self, a: &[[f64; 6]; 3], b: &[[f64; 6]; 3]) -> Block {
        let f = self.force(b);
        std::array::from_fn(|row| {
            std::array::from_fn(|column| (0..3).map(|k| a[k][row] * f[k][column]).sum())
        })
    }

    /// u_j − u_i − lever (φ_i + φ_j)×n: what the contact feels of the motions `a` of i and `b` of j.
    #[inline(always)]
    fn relative<const L: usize>(&self, a: &Motion<L>, b: &Motion<L>) -> [[f64; L]; 3] {
        let [nx, ny, nz] = self.normal.map(|n| n * self.lever);
        let mut w = [[0.0; L]; 3];
        for l in 0..L {
            let (px, py, pz) = (a[3][l] + b[3][l], a[4][l] + b[4][l], a[5][l] + b[5][l]);
            w[0][l] = b[0][l] - a[0][l] - (py * nz - pz * ny);
            w[1][l] = b[1][l] - a[1][l] - (pz * nx - px * nz);
            w[2][l] = b[2][l] - a[2][l] - (px * ny - py * nx);
        }
        w
    }

    /// k_c w, N.
    #[inline(always)]
    fn force<const L: usize>(&self, w: &[[f64; L]; 3]) -> [[f64; L]; 3] {
        let [nx, ny, nz] = self.normal;
        let mut f = [[0.0; L]; 3];
        for l in 0..L {
            let along = self.excess * (nx * w[0][l] + ny * w[1][l] + nz * w[2][l]);
            f[0][l] = self.tangential * w[0][l] + along * nx;
            f[1][l] = self.tangential * w[1][l] + along * ny;
            f[2][l] = self.tangential * w[2][l] + along * nz;
        }
        f
    }

    /// Adds Bᵀ f to `y`: f on j, −f on i, −lever n×f on both.
    #[inline(always)]
    fn scatter<const L: usize>(&self, f: &[[f64; L]; 3], y: &mut [Motion<L>]) {
        let [nx, ny, nz] = self.normal.map(|n| n * self.lever);
        let mut torque = [[0.0; L]; 3];
        for l in 0..L {
            torque[0][l] = ny * f[2][l] - nz * f[1][l];
            torque[1][l] = nz * f[0][l] - nx * f[2][l];
            torque[2][l] = nx * f[1][l] - ny * f[0][l];
        }
        // One grain after the other: they are the same one if the contact is with an own image.
        let on_i = &mut y[self.i as usize];
        for k in 0..3 {
            for l in 0..L {
                on_i[k][l] -= f[k][l];
                on_i[3 + k][l] -= torque[k][l];
            }
        }
        let on_j = &mut y[self.j as usize];
        for k in 0..3 {
            for l in 0..L {
                on_j[k][l] += f[k][l];
                on_j[3 + k][l] -= torque[k][l];
            }
        }
    }

    /// E·l of the six unit strains in Voigt order with engineering shear, m: rows x, y, z.
    #[inline(always)]
    fn affine(&self) -> [[f64; 6]; 3] {
        let [x, y, z] = self.normal.map(|n| 2.0 * self.half_branch * n);
        [
            [x, 0.0, 0.0, 0.0, 0.5 * z, 0.5 * y],
            [0.0, y, 0.0, 0.5 * z, 0.0, 0.5 * x],
            [0.0, 0.0, z, 0.5 * y, 0.5 * x, 0.0],
        ]
    }
}
