//! Grains with few contacts, and their softest motions.

use grainlab_core::{Mat3, Vec3};
use grainlab_micromechanics::network::{ContactSpring, SpringNetwork};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Largest number of contacts of a loosely held grain. With one more contact it cannot move without straining
/// contacts.
const FEW: usize = 3;

/// Ratio of an eigenvalue of a cluster's stiffness to the largest, below which the motion is floppy. Rounding
/// gives 1e-15, real contacts more than 1e-8.
const FREE: f64 = 1e-10;

/// Ratio of an eigenvalue to the largest, below which motions are kept. Motions above it are stiffer than a wave of some tens of
/// grains.
const SOFT: f64 = 1e-2;

/// Maximum number of grains of a cluster; the grains of larger ones are treated one by one.
const CLUSTER: usize = 40;

#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    pub(crate) grains: Vec<u32>,
    /// Position of each grain relative to the first, along the contacts between them, m.
    pub(crate) offsets: Vec<Vec3>,
    pub(crate) motions: Vec<Soft>,
}

/// One motion of a cluster, M-orthogonal to the others.
#[derive(Clone, Debug)]
pub(crate) struct Soft {
    /// Square of the angular frequency, (rad/s)².
    pub(crate) square: f64,
    pub(crate) is_free: bool,
    /// Six rows per grain, normalised to kinetic energy: zᵀ M z = 1.
    pub(crate) shape: DVector<f64>,
}

/// The softest motions of single grains and of groups of neighbours with few contacts, with all other grains at rest.
pub(crate) fn clusters(network: &SpringNetwork, mass: &[f64], inertia: &[f64]) -> Vec<Cluster> {
    let mut neighbours = vec![Vec::new(); network.grains()];
    let mut links = vec![Vec::new(); network.grains()];
    for link in network.contact_springs() {
        neighbours[link.i as usize].push(link.j);
        neighbours[link.j as usize].push(link.i);
        links[link.i as usize].push(link);
        if link.i != link.j {
            links[link.j as usize].push(link);
        }
    }
    let loose = |g: u32| (1..=FEW).contains(&neighbours[g as usize].len());
    let mut seen = vec![false; network.grains()];
    let mut clusters = Vec::new();
    for g in (0..network.grains() as u32).filter(|g| neighbours[*g as usize].iter().any(|o| o != g)) {
        if seen[g as usize] {
            continue;
        }
        let (mut cluster, mut offsets) = (vec![g], vec![Vec3::zeros()]);
        seen[g as usize] = true;
        let mut at = 0;
        while at < cluster.len() && loose(cluster[at]) {
            for link in &links[cluster[at] as usize] {
                let towards = Vec3::from(link.branch());
                let (other, step) =
                    if link.i == cluster[at] { (link.j, towards) } else { (link.i, -towards) };
                if loose(other) && !std::mem::replace(&mut seen[other as usize], true) {
                    cluster.push(other);
                    offsets.push(offsets[at] + step);
                }
            }
            at += 1;
        }
        let held = cluster.iter().any(|g| neighbours[*g as usize].iter().any(|o| !cluster.contains(o)));
        if held && cluster.len() <= CLUSTER {
            clusters.push((cluster, offsets));
        } else {
            clusters.extend(cluster.into_iter().map(|g| (vec![g], vec![Vec3::zeros()])));
        }
    }
    clusters.into_iter().filter_map(|(c, o)| softest(c, o, &links, mass, inertia)).collect()
}

fn softest(
    cluster: Vec<u32>,
    offsets: Vec<Vec3>,
    links: &[Vec<&ContactSpring>],
    mass: &[f64],
    inertia: &[f64],
) -> Option<Cluster> {
    let rows = 6 * cluster.len();
    let mut stiffness = DMatrix::<f64>::zeros(rows, rows);
    for (at, g) in cluster.iter().enumerate() {
        for link in &links[*g as usize] {
            let place = |grain: u32| cluster.iter().position(|c| *c == grain);
            let (i, j) = (place(link.i), place(link.j));
            // A contact inside the cluster is visited from both of its grains.
            if i.is_some() && j.is_some() && *g != link.i.min(link.j) {
                continue;
            }
            debug_assert!(i == Some(at) || j == Some(at));
            let (n, mut felt) = (Vec3::from(link.normal), DMatrix::<f64>::zeros(3, rows));
            for (place, sign, lever) in [(i, -1.0, link.levers()[0]), (j, 1.0, link.levers()[1])] {
                let Some(place) = place else { continue };
                for k in 0..3 {
                    felt[(k, 6 * place + k)] += sign;
                    // −λ φ×n.
                    let turned = -lever * Vec3::ith(k, 1.0).cross(&n);
                    for row in 0..3 {
                        felt[(row, 6 * place + 3 + k)] += turned[row];
                    }
                }
            }
            let spring = Mat3::identity() * link.tangential + n * n.transpose() * link.kn_minus_kt;
            stiffness += felt.transpose() * spring * &felt;
        }
    }
    // In units of the kinetic energy: M^-½ K M^-½.
    let root = DVector::from_fn(rows, |row, _| {
        let g = cluster[row / 6] as usize;
        (if row % 6 < 3 { mass[g] } else { inertia[g] }).sqrt()
    });
    let eigen =
        SymmetricEigen::new(DMatrix::from_fn(rows, rows, |i, j| stiffness[(i, j)] / (root[i] * root[j])));
    let stiffest = eigen.eigenvalues.max();
    let motions: Vec<Soft> = (0..rows)
        .filter(|k| eigen.eigenvalues[*k] <= SOFT * stiffest)
        .map(|k| Soft {
            square: eigen.eigenvalues[k].max(0.0),
            is_free: eigen.eigenvalues[k] <= FREE * stiffest,
            shape: eigen.eigenvectors.column(k).component_div(&root),
        })
        .collect();
    (!motions.is_empty()).then_some(Cluster { grains: cluster, offsets, motions })
}
