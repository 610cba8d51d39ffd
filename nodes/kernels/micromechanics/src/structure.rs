//! Everything of the structure beyond coordination and the second-order fabrics.

use crate::axis::axis_found;
use crate::forces::{forces, mobilisation, tangential_fabric};
use crate::fourth_order::fourth_order_fabric;
use crate::orientation::orientation;
use crate::stress_force_fabric::stress_force_fabric;
use crate::stress_parts::{networks, stress_parts};
use grainlab_core::{Packing, Structure, SymTensor, Vec3};

/// Structure of `packing` about the unit vector `axis`, with `contact_fabric` its L (Eq. 2) and `found` the principal axis
/// of L that stands out most.
pub fn structure(packing: &Packing, axis: &Vec3, contact_fabric: &SymTensor, found: &Vec3) -> Structure {
    let (strong, weak) = networks(packing, axis);
    Structure {
        reference_axis: *axis,
        axis: axis_found(packing, contact_fabric, found),
        tangential_fabric: tangential_fabric(packing),
        fourth_order: fourth_order_fabric(packing),
        orientation: orientation(packing, axis),
        stress: stress_parts(packing),
        stress_force_fabric: stress_force_fabric(packing, contact_fabric),
        strong,
        weak,
        forces: forces(packing),
        mobilisation: mobilisation(packing),
    }
}
