//! Distance of a packing from equilibrium.

use grainlab_core::{Packing, Vec3};

/// Unbalanced force ratio: mean net force of the non-rattlers, over the mean contact force (all contacts).
/// Contact forces are those stored in the packing. `None` without non-rattlers or if no contact carries
/// force.
///
/// `non_rattlers` is one entry per grain, from [`grainlab_core::non_rattlers`].
///
/// # Panics
/// If a contact names a grain that does not exist, which [`Packing::check`] refuses.
pub fn unbalanced_force_ratio(packing: &Packing, non_rattlers: &[bool]) -> Option<f64> {
    let mut net = vec![Vec3::zeros(); packing.grains()];
    let mut contact_force = 0.0;
    for c in &packing.contacts {
        let on_j = c.normal * c.normal_force - c.tangential_force;
        net[c.j as usize] += on_j;
        net[c.i as usize] -= on_j;
        contact_force += on_j.norm();
    }
    let grains = non_rattlers.iter().filter(|&&p| p).count();
    if grains == 0 || contact_force <= 0.0 {
        return None;
    }
    let sum: f64 = net.iter().zip(non_rattlers).filter(|&(_, &p)| p).map(|(f, _)| f.norm()).sum();
    Some((sum / grains as f64) / (contact_force / packing.contacts.len() as f64))
}
