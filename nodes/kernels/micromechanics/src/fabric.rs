//! Coordination, fabric tensors, ε.

use crate::anisotropy;
use crate::rattlers::participating;
use crate::structure::structure;
use grainlab_core::{Anisotropy, Fabric, Mat3, Packing, SymTensor, Vec3};

/// Structure of `packing`, with ε, the P4 coefficient and the ratios γ/Δ taken about the unit vector `axis`.
///
/// Without contacts the three tensors, ε and the P4 coefficient are zero and the axis found is `axis`; likewise a
/// weighted fabric is zero where its weights sum to nothing. `anisotropy.elastic` needs the stiffness and is left `None`:
/// [`crate::analyse()`] fills it in.
pub fn fabric(packing: &Packing, axis: &Vec3) -> Fabric {
    let present = participating(packing);
    let grains = packing.grains();
    let carrying = present.iter().filter(|&&p| p).count();
    let inner = packing.contacts.iter().filter(|c| present[c.i as usize] && present[c.j as usize]).count();
    let contact_fabric = weighted(packing, |_| 1.0);
    let found = axis_found(&contact_fabric, axis);
    Fabric {
        grains: grains as u32,
        contacts: packing.contacts.len() as u32,
        rattlers: (grains - carrying) as u32,
        k: coordination(packing.contacts.len(), grains),
        z: coordination(inner, carrying),
        contact_fabric,
        force_fabric: weighted(packing, |c| packing.contacts[c].normal_force),
        stiffness_fabric: weighted(packing, |c| packing.contact_stiffness(&packing.contacts[c]).0),
        eps: eps(&contact_fabric, axis),
        axis: found,
        fourth_order: fourth_order(packing, axis),
        anisotropy: Anisotropy {
            total: anisotropy::total(packing, axis),
            elastic: None,
            contact: anisotropy::contact(packing, axis),
        },
        mobilised: mobilised(packing),
        structure: structure(packing, axis, &contact_fabric, &found),
    }
}

/// ε = 5/2 (L_aa − (tr L − L_aa)/2) about the unit vector `axis` (Eq. 20).
pub fn eps(contact_fabric: &SymTensor, axis: &Vec3) -> f64 {
    let along = contact_fabric.along(axis);
    2.5 * (along - 0.5 * (contact_fabric.trace() - along))
}

fn coordination(contacts: usize, grains: usize) -> f64 {
    if grains == 0 { 0.0 } else { 2.0 * contacts as f64 / grains as f64 }
}

/// Σ w n⊗n / Σ w, L of Eq. 2 for w = 1.
fn weighted(packing: &Packing, weight: impl Fn(usize) -> f64) -> SymTensor {
    let (mut sum, mut total) = (Mat3::zeros(), 0.0);
    for (index, c) in packing.contacts.iter().enumerate() {
        let w = weight(index);
        sum += c.normal * c.normal.transpose() * w;
        total += w;
    }
    if total > 0.0 { SymTensor::symmetric_part(&(sum / total)) } else { SymTensor::default() }
}

/// Eigenvector whose eigenvalue is furthest from a third of the trace, with a non-negative z component.
fn axis_found(fabric: &SymTensor, fallback: &Vec3) -> Vec3 {
    let mean = fabric.mean();
    if mean <= 0.0 {
        return *fallback;
    }
    let eigen = fabric.matrix().symmetric_eigen();
    let distance = |k: usize| (eigen.eigenvalues[k] - mean).abs();
    let best = (1..3).fold(0, |best, k| if distance(k) > distance(best) { k } else { best });
    let v: Vec3 = eigen.eigenvectors.column(best).into_owned().normalize();
    // The first component that is not zero, from z down, decides the sign.
    let sign = [v.z, v.y, v.x].into_iter().find(|c| *c != 0.0).unwrap_or(1.0).signum();
    v * sign
}

/// a4 of the contact distribution 1 + a2 P2(x) + a4 P4(x) + …: 9 ⟨P4⟩, as ⟨P4²⟩ = 1/9 over the sphere.
fn fourth_order(packing: &Packing, axis: &Vec3) -> f64 {
    if packing.contacts.is_empty() {
        return 0.0;
    }
    let sum: f64 = packing
        .contacts
        .iter()
        .map(|c| {
            let x2 = c.normal.dot(axis).powi(2);
            (35.0 * x2 * x2 - 30.0 * x2 + 3.0) / 8.0
        })
        .sum();
    9.0 * sum / packing.contacts.len() as f64
}

/// Share of contacts with |F_t| ≥ 0.999 μ F_n; 0 where there is no such limit (μ = 0 or infinite).
fn mobilised(packing: &Packing) -> f64 {
    if packing.contacts.is_empty() {
        return 0.0;
    }
    let at_limit = packing.contacts.iter().filter(|c| c.slides(packing.friction));
    at_limit.count() as f64 / packing.contacts.len() as f64
}
