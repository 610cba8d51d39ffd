//! Orientation of the contacts of a packing.

use super::fourth_order::fourth_order_fabric;
use super::orientation::orientation_histogram;
use super::principal_axis::principal_axis;
use crate::view::PackingView;
use grainlab_core::results::{Fabric, contact_anisotropy};
use grainlab_core::{Mat3, Packing, SymTensor, Vec3};

/// Orientation of the contacts, about the unit vector `axis`.
///
/// Without contacts the tensors, ε and the P4 coefficient are zero and the principal axis is `axis`. A
/// weighted fabric is also zero if its weights sum to zero.
pub fn fabric(view: &PackingView<'_>, axis: &Vec3) -> Fabric {
    let packing = view.packing;
    let contact_fabric = weighted(packing, |_| 1.0);
    Fabric {
        reference_axis: *axis,
        contact_fabric,
        normal_force_fabric: weighted(packing, |c| packing.contacts[c].normal_force),
        tangential_force_fabric: tangential_force_fabric(packing),
        stiffness_fabric: weighted(packing, |c| view.contact_stiffnesses[c].0),
        contact_anisotropy: contact_anisotropy(&contact_fabric, axis),
        p4_coefficient: p4_coefficient(packing, axis),
        fourth_order: fourth_order_fabric(packing),
        principal_axis: principal_axis(view, &contact_fabric, axis),
        orientation: orientation_histogram(packing, axis),
    }
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

/// Σ |F_t| t⊗t / Σ |F_t| with t the direction of F_t, trace 1; zero without tangential forces.
fn tangential_force_fabric(packing: &Packing) -> SymTensor {
    let (mut sum, mut total) = (Mat3::zeros(), 0.0);
    for c in &packing.contacts {
        let size = c.tangential_force.norm();
        if size > 0.0 {
            sum += c.tangential_force * c.tangential_force.transpose() / size;
            total += size;
        }
    }
    if total > 0.0 { SymTensor::symmetric_part(&(sum / total)) } else { SymTensor::default() }
}

/// a4 of the contact distribution 1 + a2 P2(x) + a4 P4(x) + …: 9 ⟨P4⟩, as ⟨P4²⟩ = 1/9 over the sphere.
fn p4_coefficient(packing: &Packing, axis: &Vec3) -> f64 {
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
