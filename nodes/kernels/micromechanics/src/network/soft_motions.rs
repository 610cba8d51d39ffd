//! Motions of a few neighbours that meet far less resistance than the motion of each of these grains alone.
//!
//! A grain on two contacts is free to turn about the line through both. If its neighbour has only three, the two can
//! often move together at 10⁻⁸ of the stiffness of their blocks. A preconditioner made of blocks does not contain such motions, and each
//! costs conjugate gradients tens to hundreds of iterations. A packing of 30,000 grains at z = 4.6 has some thirty.
//! They are found here by the eigenvectors of small clusters, and solved for directly: deflation (Nicolaides,
//! SIAM J. Numer. Anal. 24, 355 (1987)).
//!
//! Stiffnesses are relative to the blocks D of the grains: eigenvalues of D⁻½ K D⁻½, which are between 0 and 2.

use super::spring_network::{ContactSpring, GrainDofs, SpringNetwork};
use nalgebra::{DMatrix, DVector, Matrix6, SymmetricEigen, Vector6};
use std::collections::{BTreeMap, BTreeSet};

/// Pairs of neighbours below this relative stiffness begin a cluster…
const PAIR: f64 = 0.2;

/// …and clusters have motions below this one left out of the iterations.
const SOFT: f64 = 3e-3;

/// Motions below this relative stiffness have none: rounding leaves some 10⁻¹⁶.
const NONE: f64 = 1e-12;

/// A further grain has to lower the stiffness of a cluster to this fraction.
const LOWERED: f64 = 0.7;

/// Maximum number of grains of a cluster, and of clusters that touch each other.
const CLUSTER: usize = 8;
const GROUP: usize = 24;

/// The entries of one motion, or of its forces, by grain.
pub(crate) type Entries = Vec<(u32, [f64; 6])>;

/// A motion w (m), scaled to wᵀ K w = 1 J. Different motions have no work in common: wᵀ K w′ = 0.
#[derive(Clone, Debug)]
pub(crate) struct SoftMotion {
    pub(crate) motion: Entries,
    /// Product K w, N.
    pub(crate) force: Entries,
}

/// The soft motions of `network`, softest cluster first.
pub(crate) fn soft_motions(network: &SpringNetwork) -> Vec<SoftMotion> {
    let search = Search::new(network);
    let mut clusters: Vec<(f64, BTreeSet<u32>)> =
        network.contact_springs().iter().filter_map(|s| search.grown(s)).collect();
    clusters.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
    let mut groups: Vec<BTreeSet<u32>> = Vec::new();
    let mut group_of: BTreeMap<u32, usize> = BTreeMap::new();
    for (_, cluster) in clusters {
        let near = cluster.iter().flat_map(|g| search.neighbours(*g)).chain(cluster.iter().copied());
        let touched: BTreeSet<usize> = near.filter_map(|g| group_of.get(&g).copied()).collect();
        let all: BTreeSet<u32> =
            touched.iter().flat_map(|t| groups[*t].iter().copied()).chain(cluster).collect();
        if all.len() > GROUP {
            continue;
        }
        for t in touched {
            groups[t].clear();
        }
        group_of.extend(all.iter().map(|g| (*g, groups.len())));
        groups.push(all);
    }
    groups.iter().filter(|g| !g.is_empty()).flat_map(|g| search.motions(g)).collect()
}

struct Search<'a> {
    network: &'a SpringNetwork,
    /// Contacts of grain g: `contacts[first[g]..first[g + 1]]`.
    contacts: Vec<u32>,
    first: Vec<usize>,
    /// Blocks D⁻½, with zero in place of the inverse of zero.
    roots: Vec<Matrix6<f64>>,
}

impl<'a> Search<'a> {
    fn new(network: &'a SpringNetwork) -> Self {
        let springs = network.contact_springs();
        let mut ends: Vec<(u32, u32)> = Vec::with_capacity(2 * springs.len());
        for (c, s) in springs.iter().enumerate() {
            ends.extend([(s.i, c as u32), (s.j, c as u32)]);
        }
        ends.sort_unstable();
        // A contact with an own image once.
        ends.dedup();
        let mut first = vec![0; network.grains() + 1];
        ends.iter().for_each(|(grain, _)| first[*grain as usize + 1] += 1);
        for g in 0..network.grains() {
            first[g + 1] += first[g];
        }
        let root = |block: &[[f64; 6]; 6]| {
            let eigen = SymmetricEigen::new(Matrix6::from_fn(|i, j| block[i][j]));
            let floor = NONE * eigen.eigenvalues.max();
            let values = eigen.eigenvalues.map(|e| if e > floor { e.sqrt().recip() } else { 0.0 });
            eigen.eigenvectors * Matrix6::from_diagonal(&values) * eigen.eigenvectors.transpose()
        };
        let roots = network.diagonal_blocks().iter().map(root).collect();
        Self { network, contacts: ends.into_iter().map(|(_, c)| c).collect(), first, roots }
    }

    fn contacts(&self, grain: u32) -> impl Iterator<Item = &ContactSpring> {
        let range = self.first[grain as usize]..self.first[grain as usize + 1];
        self.contacts[range].iter().map(|c| &self.network.contact_springs()[*c as usize])
    }

    fn neighbours(&self, grain: u32) -> impl Iterator<Item = u32> {
        self.contacts(grain).map(move |s| s.i + s.j - grain)
    }

    /// D⁻½ K D⁻½ between the grains of a contact.
    fn coupling(&self, s: &ContactSpring) -> Matrix6<f64> {
        let block = s.coupling();
        self.roots[s.i as usize] * Matrix6::from_fn(|i, j| block[i][j]) * self.roots[s.j as usize]
    }

    /// A cluster with a soft motion that contains the pair of a contact, with its stiffness.
    fn grown(&self, s: &ContactSpring) -> Option<(f64, BTreeSet<u32>)> {
        let least = (1.0 - PAIR).powi(2);
        let coupling = self.coupling(s);
        // The norm is an upper bound of the largest eigenvalue.
        if s.i == s.j
            || coupling.norm_squared() < least
            || (coupling.transpose() * coupling).symmetric_eigenvalues().max() < least
        {
            return None;
        }
        let mut cluster = BTreeSet::from([s.i, s.j]);
        let (mut stiffness, mut motion) = self.softest(&cluster)?;
        while cluster.len() < CLUSTER {
            // The neighbour whose own motion lowers the energy most.
            let mut forces: BTreeMap<u32, Vector6<f64>> = BTreeMap::new();
            for (at, grain) in cluster.iter().enumerate() {
                let own = motion.fixed_rows::<6>(6 * at);
                for s in self.contacts(*grain).filter(|s| !cluster.contains(&(s.i + s.j - grain))) {
                    let coupling = self.coupling(s);
                    let force = if s.i == *grain { coupling.tr_mul(&own) } else { coupling * own };
                    *forces.entry(s.i + s.j - grain).or_default() += force;
                }
            }
            let Some((next, _)) = forces
                .iter()
                .max_by(|a, b| a.1.norm_squared().total_cmp(&b.1.norm_squared()).then(b.0.cmp(a.0)))
            else {
                break;
            };
            let mut wider = cluster.clone();
            wider.insert(*next);
            match self.softest(&wider) {
                Some((lower, found)) if lower < LOWERED * stiffness => {
                    (cluster, stiffness, motion) = (wider, lower, found);
                }
                _ => break,
            }
        }
        (stiffness < SOFT).then_some((stiffness, cluster))
    }

    /// Eigenvalues and eigenvectors of D⁻½ K D⁻½ with all other grains fixed; 1 in place of 0 where D is singular.
    fn eigen(&self, cluster: &BTreeSet<u32>) -> SymmetricEigen<f64, nalgebra::Dyn> {
        let place: BTreeMap<u32, usize> = cluster.iter().enumerate().map(|(at, g)| (*g, 6 * at)).collect();
        let mut matrix = DMatrix::identity(6 * cluster.len(), 6 * cluster.len());
        for (grain, row) in &place {
            // D has the contacts with own images.
            for s in self.contacts(*grain).filter(|s| s.i == *grain && s.j != *grain) {
                if let Some(column) = place.get(&s.j) {
                    let coupling = self.coupling(s);
                    let mut upper = matrix.fixed_view_mut::<6, 6>(*row, *column);
                    upper += coupling;
                    let mut lower = matrix.fixed_view_mut::<6, 6>(*column, *row);
                    lower += coupling.transpose();
                }
            }
        }
        SymmetricEigen::new(matrix)
    }

    /// Smallest eigenvalue of that above zero, with its eigenvector.
    fn softest(&self, cluster: &BTreeSet<u32>) -> Option<(f64, DVector<f64>)> {
        let eigen = self.eigen(cluster);
        let values = eigen.eigenvalues.iter().copied().enumerate().filter(|(_, e)| *e > NONE);
        let (column, value) = values.min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((value, eigen.eigenvectors.column(column).into_owned()))
    }

    fn motions(&self, group: &BTreeSet<u32>) -> Vec<SoftMotion> {
        let eigen = self.eigen(group);
        let mut columns: Vec<usize> =
            (0..6 * group.len()).filter(|c| (NONE..SOFT).contains(&eigen.eigenvalues[*c])).collect();
        columns.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        columns.into_iter().map(|c| self.scaled(group, &eigen.eigenvectors.column(c).into_owned())).collect()
    }

    /// The motion D⁻½ y with its forces, scaled.
    fn scaled(&self, group: &BTreeSet<u32>, y: &DVector<f64>) -> SoftMotion {
        let of = |(at, grain): (usize, &u32)| {
            let own = self.roots[*grain as usize] * y.fixed_rows::<6>(6 * at);
            (*grain, std::array::from_fn(|k| [own[k]]))
        };
        let motion: BTreeMap<u32, GrainDofs<1>> = group.iter().enumerate().map(of).collect();
        let mut force: BTreeMap<u32, GrainDofs<1>> = BTreeMap::new();
        let mut energy = 0.0;
        let rest = [[0.0]; 6];
        for grain in group {
            // Every contact once.
            for s in self.contacts(*grain).filter(|s| s.i == *grain || !group.contains(&s.i)) {
                let [a, b] = [s.i, s.j].map(|g| motion.get(&g).unwrap_or(&rest));
                let (work, on_i, on_j) = s.response(a, b);
                energy += work;
                for (g, on) in [(s.i, on_i), (s.j, on_j)] {
                    let sum = force.entry(g).or_insert(rest);
                    (0..6).for_each(|k| sum[k][0] += on[k][0]);
                }
            }
        }
        let unit = |entries: BTreeMap<u32, GrainDofs<1>>| {
            entries.into_iter().map(|(g, x)| (g, x.map(|[x]| x / energy.sqrt()))).collect()
        };
        SoftMotion { motion: unit(motion), force: unit(force) }
    }
}
