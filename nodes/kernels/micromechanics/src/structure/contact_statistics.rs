//! Numbers of contacts and their forces.

use crate::view::PackingView;
use grainlab_core::Packing;
use grainlab_core::results::{
    ContactStatistics, FORCE_BIN_WIDTH, FORCE_BINS, ForceStatistics, MOBILISATION_BINS, MobilisedFriction,
};

/// Contacts and the forces they carry.
pub fn contact_statistics(view: &PackingView<'_>) -> ContactStatistics {
    let packing = view.packing;
    let (grains, carrying) = (packing.grains(), view.carrying());
    let inner = packing.contacts.iter().filter(|c| view.carries_force(c.i, c.j)).count();
    ContactStatistics {
        grains: grains as u32,
        contacts: packing.contacts.len() as u32,
        rattlers: (grains - carrying) as u32,
        coordination: coordination(packing.contacts.len(), grains),
        mechanical_coordination: coordination(inner, carrying),
        sliding_fraction: packing.sliding_fraction(),
        forces: force_statistics(view),
        friction: mobilised_friction(packing),
    }
}

fn coordination(contacts: usize, grains: usize) -> f64 {
    if grains == 0 { 0.0 } else { 2.0 * contacts as f64 / grains as f64 }
}

/// Distribution of normal forces; `None` without contacts, or if their mean is not positive.
fn force_statistics(view: &PackingView<'_>) -> Option<ForceStatistics> {
    let (packing, mean_normal) = (view.packing, view.mean_normal_force);
    if mean_normal <= 0.0 {
        return None;
    }
    let count = packing.contacts.len() as f64;
    let mut found = ForceStatistics { mean_normal, ..ForceStatistics::default() };
    for c in &packing.contacts {
        let f = c.normal_force / mean_normal;
        let squared = f * f;
        found.moments[0] += squared / count;
        found.moments[1] += squared * f / count;
        found.moments[2] += squared * squared / count;
        found.mean_tangential += c.tangential_force.norm() / count;
        found.largest = found.largest.max(f);
        // A negative number saturates to 0.
        found.histogram[((f / FORCE_BIN_WIDTH) as usize).min(FORCE_BINS - 1)] += 1;
    }
    Some(found)
}

/// Mobilised friction; `None` without contacts or without a Coulomb limit (μ = 0 or infinite). A contact
/// without normal force is at the limit if it carries a tangential one.
fn mobilised_friction(packing: &Packing) -> Option<MobilisedFriction> {
    let mu = packing.friction;
    if packing.contacts.is_empty() || mu == 0.0 || mu.is_infinite() {
        return None;
    }
    let mut found = MobilisedFriction::default();
    for c in &packing.contacts {
        let (carried, limit) = (c.tangential_force.norm(), mu * c.normal_force.max(0.0));
        let share = if carried < limit { carried / limit } else { f64::from(carried > 0.0) };
        found.mean += share / packing.contacts.len() as f64;
        found.histogram[((share * MOBILISATION_BINS as f64) as usize).min(MOBILISATION_BINS - 1)] += 1;
    }
    // The mean of ones is 1, regardless of rounding.
    found.mean = found.mean.min(1.0);
    Some(found)
}
