//! Stress by kind of force and by network.

use super::stress_force_fabric::stress_force_fabric;
use crate::view::PackingView;
use grainlab_core::results::{Fabric, StressDecomposition, SubNetwork, contact_anisotropy};
use grainlab_core::{Mat3, SymTensor, Vec3};

/// Love–Weber stress of the normal and of the tangential forces, whose sum is
/// [`grainlab_core::stress::stress`], and of the strong network (contacts with F_n above the mean over
/// contacts) and the weak one (all others). `fabric` is that of the packing.
pub fn stress_decomposition(view: &PackingView<'_>, fabric: &Fabric) -> StressDecomposition {
    // Forces that are equal up to rounding all count as weak.
    let threshold = view.mean_normal_force * (1.0 + 1e-9);
    let (mut normal, mut tangential) = (Mat3::zeros(), Mat3::zeros());
    let (mut strong, mut weak) = (Sums::default(), Sums::default());
    for (c, branch) in view.packing.contacts.iter().zip(&view.branches) {
        let branch = branch.transpose();
        normal += c.normal * c.normal_force * branch;
        tangential -= c.tangential_force * branch;
        let sums = if c.normal_force > threshold { &mut strong } else { &mut weak };
        sums.contacts += 1;
        sums.directions += c.normal * c.normal.transpose();
        sums.virial += (c.normal * c.normal_force - c.tangential_force) * branch;
    }
    let volume = view.packing.cell.volume();
    StressDecomposition {
        normal: SymTensor::symmetric_part(&(normal / volume)),
        tangential: SymTensor::symmetric_part(&(tangential / volume)),
        strong: strong.network(volume, &fabric.reference_axis),
        weak: weak.network(volume, &fabric.reference_axis),
        stress_force_fabric: stress_force_fabric(view, &fabric.contact_fabric),
    }
}

#[derive(Default)]
struct Sums {
    contacts: u32,
    directions: Mat3,
    virial: Mat3,
}

impl Sums {
    fn network(&self, volume: f64, axis: &Vec3) -> SubNetwork {
        let mean = self.directions / f64::from(self.contacts.max(1));
        let fabric = SymTensor::symmetric_part(&mean);
        SubNetwork {
            contacts: self.contacts,
            fabric,
            contact_anisotropy: contact_anisotropy(&fabric, axis),
            stress: SymTensor::symmetric_part(&(self.virial / volume)),
        }
    }
}
