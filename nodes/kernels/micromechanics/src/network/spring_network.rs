//! The frozen contact network as a linear operator.
//!
//! Contact c between grains i and j, n from i to j, branch l = |l| n, springs k_c = k_n nn + k_t (1 − nn), all stuck:
//! the relative displacement at the contact is u_c = u_j − u_i + E·l − (λ_i θ_i + λ_j θ_j)×n. The contact acts at the
//! levers λ_i = R_i − δ/2 and λ_j = R_j − δ/2 from the centres; they are (|l| ± (R_i − R_j))/2, so that they add up to
//! |l| and a rigid rotation of the pair costs nothing. Rotations are held as φ = θ a (a the mean branch length over 2),
//! so that every degree of freedom is a displacement in m and every load a force in N.
//!
//! The rolling springs of a contact law with resistance to rolling are not in the network: its stiffness is a lower bound of
//! that of the packing ([`LeftOut`](grainlab_core::results::LeftOut)).

use super::preconditioner::Block;
use crate::error::MicroError;
use crate::view::PackingView;
use grainlab_core::Stiffness;
use nalgebra::Matrix6;

/// Displacement (m) and scaled rotation φ = θ a (m) of one grain, rows u_x, u_y, u_z, φ_x, φ_y, φ_z, for `L`
/// loads at once; or the conjugate forces and scaled torques (N).
pub type GrainDofs<const L: usize> = [[f64; L]; 6];

const ZERO: GrainDofs<6> = [[0.0; 6]; 6];

/// One column for each direction of a grain.
const UNIT: GrainDofs<6> = {
    let mut unit = ZERO;
    let mut k = 0;
    while k < 6 {
        unit[k][k] = 1.0;
        k += 1;
    }
    unit
};

/// Springs of the contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Springs {
    /// Those that the contacts carry: k_n, and k_t where the packing has friction. No contact slides, also none that is at
    /// the Coulomb limit.
    #[default]
    Carried,
    /// k_n and k_t, whatever the friction ("friction set very high").
    NormalAndTangential,
    /// k_n alone: frictionless.
    Normal,
    /// k_n and the prestress term −(F_n/|l|)(1 − nn) on the displacement of the centres: a normal force rotates with
    /// its branch. Relative to a tangential spring it is of the order of (2/3) overlap/diameter. Without such springs
    /// it decides whether a network near isostaticity is stiff. Contacts of rattlers are dropped: under its force a
    /// grain on one contact rolls off, while without the term it just follows. Terms of the order of the pressure that
    /// depend on the choice of strain and stress measures are left out.
    PrestressedNormal,
}

impl Springs {
    /// True if contacts of this friction coefficient have a k_t.
    pub fn has_tangential(self, friction: f64) -> bool {
        self == Self::NormalAndTangential || (self == Self::Carried && friction > 0.0)
    }
}

/// One contact of the network, with the data for the operator.
#[derive(Clone, Copy, Debug)]
pub struct ContactSpring {
    /// Index of the first grain.
    pub i: u32,
    /// Index of the second grain.
    pub j: u32,
    /// Unit normal, along the branch.
    pub normal: [f64; 3],
    /// Half the branch, |l|/2, m.
    half_branch: f64,
    /// |l|/(2a): mean lever of a scaled rotation.
    lever: f64,
    /// Levers of i and j over their mean, 1 ± (R_i − R_j)/|l|: exactly 1 where radii are equal.
    share: [f64; 2],
    /// Tangential stiffness k_t, N/m.
    pub tangential: f64,
    /// k_n − k_t, N/m.
    pub kn_minus_kt: f64,
    /// F_n/|l|, N/m, which reduces the stiffness across the normal; 0 without prestress.
    pub(crate) geometric: f64,
}

/// The frozen contact network of a packing: grains, springs, volume.
#[derive(Clone, Debug)]
pub struct SpringNetwork {
    pub(super) springs: Vec<ContactSpring>,
    grains: usize,
    volume: f64,
    spin_scale: f64,
    /// Grains along a space-filling curve.
    pub(crate) order: Vec<u32>,
    prestressed: bool,
}

impl SpringNetwork {
    /// The network of every contact of a packing at its present overlap. The kinematics use the branch
    /// vectors, which must be parallel to the contact normals.
    pub fn new(view: &PackingView<'_>, kind: Springs) -> Result<Self, MicroError> {
        let packing = view.packing;
        let mut springs = Vec::with_capacity(packing.contacts.len());
        for (index, c) in packing.contacts.iter().enumerate() {
            let branch = view.branches[index];
            let length = branch.norm();
            let normal = branch / length;
            let cosine = normal.dot(&c.normal);
            // NaN: the centres coincide.
            if cosine.is_nan() || cosine < 1.0 - 1e-6 {
                return Err(MicroError::Normal { contact: index, i: c.i, j: c.j, cosine });
            }
            let (k_n, k_t) = view.contact_stiffnesses[index];
            let k_t = if kind.has_tangential(packing.friction) { k_t } else { 0.0 };
            let skew = (packing.radii[c.i as usize] - packing.radii[c.j as usize]) / length;
            springs.push(ContactSpring {
                i: c.i,
                j: c.j,
                normal: normal.into(),
                half_branch: 0.5 * length,
                lever: 0.0,
                share: [1.0 + skew, 1.0 - skew],
                tangential: k_t,
                kn_minus_kt: k_n - k_t,
                geometric: 0.0,
            });
        }
        let total: f64 = springs.iter().map(|s| s.half_branch).sum();
        let spin_scale = if springs.is_empty() { 1.0 } else { total / springs.len() as f64 };
        for s in &mut springs {
            s.lever = s.half_branch / spin_scale;
        }
        let mut order: Vec<u32> = (0..packing.grains() as u32).collect();
        order.sort_by_cached_key(|g| packing.cell.place_on_curve(&packing.positions[*g as usize]));
        let prestressed = kind == Springs::PrestressedNormal;
        if prestressed {
            for (s, c) in springs.iter_mut().zip(&packing.contacts) {
                s.geometric = c.normal_force / (2.0 * s.half_branch);
            }
            springs.retain(|s| view.carries_force(s.i, s.j));
        }
        let (grains, volume) = (packing.grains(), packing.cell.volume());
        Ok(Self { springs, grains, volume, spin_scale, order, prestressed })
    }

    /// True if the prestress term is included.
    pub fn prestressed(&self) -> bool {
        self.prestressed
    }

    /// True if no contact has a tangential spring.
    pub fn smooth(&self) -> bool {
        self.springs.iter().all(|s| s.tangential == 0.0)
    }

    /// Number of grains, including those without contacts.
    pub fn grains(&self) -> usize {
        self.grains
    }

    /// Number of contacts.
    pub fn contacts(&self) -> usize {
        self.springs.len()
    }

    /// Volume of the cell, m³.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Every contact, in the order of the packing.
    pub fn contact_springs(&self) -> &[ContactSpring] {
        &self.springs
    }

    /// The length a that scales rotations, m: θ = φ/a.
    pub fn spin_scale(&self) -> f64 {
        self.spin_scale
    }

    /// y = K x for `L` motions at once, one entry per grain. Contacts are summed in the order of the packing, so the
    /// result is the same bit for bit on every call.
    ///
    /// # Panics
    /// If `x` and `y` have not one entry for each of [`SpringNetwork::grains`].
    pub fn apply<const L: usize>(&self, x: &[GrainDofs<L>], y: &mut [GrainDofs<L>]) {
        assert_eq!((x.len(), y.len()), (self.grains, self.grains), "one motion per grain");
        y.fill([[0.0; L]; 6]);
        for s in &self.springs {
            let (a, b) = (&x[s.i as usize], &x[s.j as usize]);
            s.scatter(&s.force(&s.relative(a, b)), &s.turned(&s.apart(a, b)), y);
        }
    }

    /// Diagonal blocks of K, one per grain, N/m.
    pub fn diagonal_blocks(&self) -> Vec<Block> {
        let mut blocks = vec![[[0.0; 6]; 6]; self.grains];
        for s in &self.springs {
            let mut add = |grain: u32, a: &GrainDofs<6>, b: &GrainDofs<6>| {
                let block = s.energies(a, b);
                for (row, entries) in blocks[grain as usize].iter_mut().enumerate() {
                    for (column, entry) in entries.iter_mut().enumerate() {
                        *entry += block[row][column];
                    }
                }
            };
            if s.i == s.j {
                // The own image moves with the grain.
                add(s.i, &UNIT, &UNIT);
            } else {
                add(s.i, &UNIT, &ZERO);
                add(s.j, &ZERO, &UNIT);
            }
        }
        blocks
    }

    /// Loads −Ξ of the six unit strains (engineering shear), N per unit strain, and for each strain the norm
    /// that the loads would have if contact forces on a grain never cancelled: the scale of a residual.
    pub fn affine_loads(&self) -> (Vec<GrainDofs<6>>, [f64; 6]) {
        let mut loads = vec![[[0.0; 6]; 6]; self.grains];
        let mut squares = [0.0; 6];
        for s in &self.springs {
            let affine = s.affine();
            let (f, h) = (s.force(&affine), s.turned(&affine));
            for lane in 0..6 {
                squares[lane] += 2.0 * (0..3).map(|k| f[k][lane] * f[k][lane]).sum::<f64>();
            }
            s.scatter(&f.map(|row| row.map(|v| -v)), &h.map(|row| row.map(|v| -v)), &mut loads);
        }
        (loads, squares.map(f64::sqrt))
    }

    /// Affine (Voigt) stiffness: every grain moves with the unit strains.
    pub fn affine_stiffness(&self) -> Stiffness {
        Stiffness(self.stiffness(None).0)
    }

    /// Stiffness, Pa, of the network whose grains move with the unit strains plus `motion`, in two forms: by energy,
    /// Σ u_aᵀ k u_b/V, symmetric and never negative; and by stress, Σ (E_a l)ᵀ k u_b/V. They agree where `motion` balances
    /// all forces.
    ///
    /// # Panics
    /// If `motion` has fewer entries than the network has grains.
    pub fn stiffness_with(&self, motion: &[GrainDofs<6>]) -> (Matrix6<f64>, Matrix6<f64>) {
        self.stiffness(Some(motion))
    }

    fn stiffness(&self, motion: Option<&[GrainDofs<6>]>) -> (Matrix6<f64>, Matrix6<f64>) {
        let (mut energy, mut stress) = (Matrix6::zeros(), Matrix6::zeros());
        for s in &self.springs {
            let affine = s.affine();
            let (mut w, mut d) = (affine, affine);
            if let Some(x) = motion {
                let (a, b) = (&x[s.i as usize], &x[s.j as usize]);
                let (relaxed, apart) = (s.relative(a, b), s.apart(a, b));
                for k in 0..3 {
                    for lane in 0..6 {
                        w[k][lane] += relaxed[k][lane];
                        d[k][lane] += apart[k][lane];
                    }
                }
            }
            let (f, h) = (s.force(&w), s.turned(&d));
            for k in 0..3 {
                for a in 0..6 {
                    for b in 0..6 {
                        energy[(a, b)] += w[k][a] * f[k][b] + d[k][a] * h[k][b];
                        stress[(a, b)] += affine[k][a] * (f[k][b] + h[k][b]);
                    }
                }
            }
        }
        let energy = (energy + energy.transpose()) * (0.5 / self.volume);
        (energy, stress / self.volume)
    }
}

impl ContactSpring {
    /// The work of the motions `a` and `b` of both grains against their own forces, every column with every column.
    fn energies(&self, a: &GrainDofs<6>, b: &GrainDofs<6>) -> Block {
        let (w, d) = (self.relative(a, b), self.apart(a, b));
        let (f, h) = (self.force(&w), self.turned(&d));
        let sum = |row: usize, column: usize| {
            (0..3).map(|k| w[k][row] * f[k][column] + d[k][row] * h[k][column]).sum()
        };
        std::array::from_fn(|row| std::array::from_fn(|column| sum(row, column)))
    }

    /// Forces on grain i, by row, under the motions of grain j, by column, N/m.
    pub(super) fn coupling(&self) -> Block {
        let (w, d) = (self.relative(&UNIT, &ZERO), self.apart(&UNIT, &ZERO));
        let (v, e) = (self.relative(&ZERO, &UNIT), self.apart(&ZERO, &UNIT));
        let (f, h) = (self.force(&v), self.turned(&e));
        let sum = |row: usize, column: usize| {
            (0..3).map(|k| w[k][row] * f[k][column] + d[k][row] * h[k][column]).sum()
        };
        std::array::from_fn(|row| std::array::from_fn(|column| sum(row, column)))
    }

    /// Work (J) and forces (N) on i and j under their motions `a` and `b`.
    pub(super) fn response(&self, a: &GrainDofs<1>, b: &GrainDofs<1>) -> (f64, GrainDofs<1>, GrainDofs<1>) {
        let (w, d) = (self.relative(a, b), self.apart(a, b));
        let (f, h) = (self.force(&w), self.turned(&d));
        let work = (0..3).map(|k| w[k][0] * f[k][0] + d[k][0] * h[k][0]).sum();
        let mut both = [[[0.0]; 6]; 2];
        Self { i: 0, j: 1, ..*self }.scatter(&f, &h, &mut both);
        (work, both[0], both[1])
    }

    /// Levers of scaled rotations φ of i and j: (R − δ/2)/a with a the [`SpringNetwork::spin_scale`].
    pub fn levers(&self) -> [f64; 2] {
        self.share.map(|share| self.lever * share)
    }

    /// u_j − u_i − (lever_i φ_i + lever_j φ_j)×n: relative displacement at the contact under the motions `a`
    /// of i and `b` of j.
    #[inline(always)]
    fn relative<const L: usize>(&self, a: &GrainDofs<L>, b: &GrainDofs<L>) -> [[f64; L]; 3] {
        let [nx, ny, nz] = self.normal.map(|n| n * self.lever);
        let [i, j] = self.share;
        let mut w = [[0.0; L]; 3];
        for l in 0..L {
            let (px, py, pz) =
                (i * a[3][l] + j * b[3][l], i * a[4][l] + j * b[4][l], i * a[5][l] + j * b[5][l]);
            w[0][l] = b[0][l] - a[0][l] - (py * nz - pz * ny);
            w[1][l] = b[1][l] - a[1][l] - (pz * nx - px * nz);
            w[2][l] = b[2][l] - a[2][l] - (px * ny - py * nx);
        }
        w
    }

    /// u_j − u_i, m.
    #[inline(always)]
    fn apart<const L: usize>(&self, a: &GrainDofs<L>, b: &GrainDofs<L>) -> [[f64; L]; 3] {
        let mut d = [[0.0; L]; 3];
        for k in 0..3 {
            for l in 0..L {
                d[k][l] = b[k][l] - a[k][l];
            }
        }
        d
    }

    /// −(F_n/|l|)(1 − nn) d, N: change of the normal force by its rotation with the branch.
    #[inline(always)]
    fn turned<const L: usize>(&self, d: &[[f64; L]; 3]) -> [[f64; L]; 3] {
        let mut h = [[0.0; L]; 3];
        if self.geometric != 0.0 {
            let n = self.normal;
            for l in 0..L {
                let along = n[0] * d[0][l] + n[1] * d[1][l] + n[2] * d[2][l];
                for k in 0..3 {
                    h[k][l] = self.geometric * (along * n[k] - d[k][l]);
                }
            }
        }
        h
    }

    /// k_c w, N.
    #[inline(always)]
    pub(crate) fn force<const L: usize>(&self, w: &[[f64; L]; 3]) -> [[f64; L]; 3] {
        let [nx, ny, nz] = self.normal;
        let mut f = [[0.0; L]; 3];
        for l in 0..L {
            let along = self.kn_minus_kt * (nx * w[0][l] + ny * w[1][l] + nz * w[2][l]);
            f[0][l] = self.tangential * w[0][l] + along * nx;
            f[1][l] = self.tangential * w[1][l] + along * ny;
            f[2][l] = self.tangential * w[2][l] + along * nz;
        }
        f
    }

    /// Adds Bᵀ f to `y`: f on j, −f on i, −lever n×f on each; and `h`, which has no torque.
    #[inline(always)]
    fn scatter<const L: usize>(&self, f: &[[f64; L]; 3], h: &[[f64; L]; 3], y: &mut [GrainDofs<L>]) {
        let [nx, ny, nz] = self.normal.map(|n| n * self.lever);
        let mut torque = [[0.0; L]; 3];
        for l in 0..L {
            torque[0][l] = ny * f[2][l] - nz * f[1][l];
            torque[1][l] = nz * f[0][l] - nx * f[2][l];
            torque[2][l] = nx * f[1][l] - ny * f[0][l];
        }
        let [i, j] = self.share;
        // One grain after the other: both are the same if the contact is with an own image.
        let on_i = &mut y[self.i as usize];
        for k in 0..3 {
            for l in 0..L {
                on_i[k][l] -= f[k][l] + h[k][l];
                on_i[3 + k][l] -= i * torque[k][l];
            }
        }
        let on_j = &mut y[self.j as usize];
        for k in 0..3 {
            for l in 0..L {
                on_j[k][l] += f[k][l] + h[k][l];
                on_j[3 + k][l] -= j * torque[k][l];
            }
        }
    }

    /// Branch vector l from i to the touched image of j, m.
    #[inline(always)]
    pub fn branch(&self) -> [f64; 3] {
        self.normal.map(|n| 2.0 * self.half_branch * n)
    }

    /// E·l of the six unit strains in Voigt order with engineering shear, m: rows x, y, z.
    #[inline(always)]
    pub(crate) fn affine(&self) -> [[f64; 6]; 3] {
        let [x, y, z] = self.branch();
        [
            [x, 0.0, 0.0, 0.0, 0.5 * z, 0.5 * y],
            [0.0, y, 0.0, 0.5 * z, 0.0, 0.5 * x],
            [0.0, 0.0, z, 0.5 * y, 0.5 * x, 0.0],
        ]
    }
}
