//! Stress by kind of force and by network.

use grainlab_core::structure::{NetworkPart, StressParts};
use grainlab_core::{Mat3, Packing, SymTensor, Vec3};

/// Love–Weber stress of the normal and of the tangential forces. They add up to [`grainlab_core::stress::stress`].
pub fn stress_parts(packing: &Packing) -> StressParts {
    let (mut normal, mut tangential) = (Mat3::zeros(), Mat3::zeros());
    for c in &packing.contacts {
        let branch = packing.branch(c).transpose();
        normal += c.normal * c.normal_force * branch;
        tangential -= c.tangential_force * branch;
    }
    let volume = packing.cell.volume();
    let part = |virial: Mat3| SymTensor::symmetric_part(&(virial / volume));
    StressParts { normal: part(normal), tangential: part(tangential) }
}

/// The strong network (contacts with F_n above the mean over contacts) and the weak one (all others), with ε about the
/// unit vector `axis`.
pub fn networks(packing: &Packing, axis: &Vec3) -> (NetworkPart, NetworkPart) {
    // Forces that are equal but for rounding are weak, all of them.
    let threshold = mean_normal_force(packing) * (1.0 + 1e-12);
    let (mut strong, mut weak) = (Sums::default(), Sums::default());
    for c in &packing.contacts {
        let sums = if c.normal_force > threshold { &mut strong } else { &mut weak };
        sums.contacts += 1;
        sums.directions += c.normal * c.normal.transpose();
        sums.virial += (c.normal * c.normal_force - c.tangential_force) * packing.branch(c).transpose();
    }
    let volume = packing.cell.volume();
    (strong.part(volume, axis), weak.part(volume, axis))
}

/// ⟨F_n⟩ over contacts, N; 0 without contacts.
pub(crate) fn mean_normal_force(packing: &Packing) -> f64 {
    let sum: f64 = packing.contacts.iter().map(|c| c.normal_force).sum();
    sum / packing.contacts.len().max(1) as f64
}

#[derive(Default)]
struct Sums {
    contacts: u32,
    directions: Mat3,
    virial: Mat3,
}

impl Sums {
    fn part(&self, volume: f64, axis: &Vec3) -> NetworkPart {
        let mean = self.directions / f64::from(self.contacts.max(1));
        let fabric = SymTensor::symmetric_part(&mean);
        NetworkPart {
            contacts: self.contacts,
            fabric,
            eps: crate::fabric::eps(&fabric, axis),
            stress: SymTensor::symmetric_part(&(self.virial / volume)),
        }
    }
}
