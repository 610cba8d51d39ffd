//! Anisotropies of contacts and forces, and the deviatoric stress that follows.

use super::deviator::{DeviatorVector, from_direction, from_tensor, shortest_solution, tensor};
use crate::view::PackingView;
use grainlab_core::results::StressForceFabric;
use grainlab_core::{Packing, SymTensor, Vec3};
use nalgebra::SMatrix;

type Square = SMatrix<f64, 5, 5>;

/// The second-order anisotropies of a packing, with `contact_fabric` its L (Eq. 2). `None` without contacts,
/// or if the mean normal force over directions is not positive.
///
/// Forces and branches are fitted to the contacts by least squares, so that the anisotropy of the contact
/// directions does not enter. Components that the directions do not determine (a chain, a simple cubic
/// lattice) are 0.
pub fn stress_force_fabric(view: &PackingView<'_>, contact_fabric: &SymTensor) -> Option<StressForceFabric> {
    let packing = view.packing;
    if packing.contacts.is_empty() || view.mean_normal_force <= 0.0 {
        return None;
    }
    let directions: Vec<DeviatorVector> =
        packing.contacts.iter().map(|c| from_direction(&c.normal)).collect();
    let mean = directions.iter().sum::<DeviatorVector>() / directions.len() as f64;
    let spread: Square = directions.iter().map(|d| (d - mean) * (d - mean).transpose()).sum();
    let fit = |value: &dyn Fn(usize) -> f64| {
        let mut sum = (0.0, DeviatorVector::zeros());
        for (index, d) in directions.iter().enumerate() {
            let v = value(index);
            sum = (sum.0 + v, sum.1 + (d - mean) * v);
        }
        let slope = shortest_solution(spread, &sum.1, directions.len() as f64);
        let level = sum.0 / directions.len() as f64 - slope.dot(&mean);
        (level, slope)
    };
    let (force, normal_forces) = fit(&|c| packing.contacts[c].normal_force);
    let (length, branches) = fit(&|c| view.branches[c].norm());
    if force <= 0.0 || length <= 0.0 {
        return None;
    }
    Some(StressForceFabric {
        contacts: tensor(&(from_tensor(contact_fabric) * 7.5)),
        normal_forces: tensor(&(normal_forces / force)),
        branches: tensor(&(branches / length)),
        tangential_forces: tensor(&(tangential(packing) / force)),
    })
}

/// Least squares of the tangential forces on `j` to A n − (n·A n) n: the five components of A, N.
fn tangential(packing: &Packing) -> DeviatorVector {
    let (mut matrix, mut right) = (Square::zeros(), DeviatorVector::zeros());
    let basis: [_; 5] = std::array::from_fn(|k| {
        let mut one = DeviatorVector::zeros();
        one[k] = 1.0;
        tensor(&one).matrix()
    });
    for c in &packing.contacts {
        let n = &c.normal;
        let pulls: [Vec3; 5] = basis.map(|b| {
            let along = b * n;
            along - n * n.dot(&along)
        });
        for a in 0..5 {
            right[a] -= pulls[a].dot(&c.tangential_force);
            for b in 0..5 {
                matrix[(a, b)] += pulls[a].dot(&pulls[b]);
            }
        }
    }
    shortest_solution(matrix, &right, packing.contacts.len() as f64)
}
