//! How forces are distributed over contacts.

use crate::stress_parts::mean_normal_force;
use grainlab_core::structure::{FORCE_BIN_WIDTH, FORCE_BINS, Forces, MOBILISATION_BINS, Mobilisation};
use grainlab_core::{Mat3, Packing, SymTensor};

/// Distribution of normal forces; `None` without contacts, or where their mean is not positive.
pub fn forces(packing: &Packing) -> Option<Forces> {
    let mean_normal = mean_normal_force(packing);
    if mean_normal <= 0.0 {
        return None;
    }
    let count = packing.contacts.len() as f64;
    let mut found = Forces { mean_normal, ..Forces::default() };
    for c in &packing.contacts {
        let f = c.normal_force / mean_normal;
        let squared = f * f;
        found.moments[0] += squared / count;
        found.moments[1] += squared * f / count;
        found.moments[2] += squared * squared / count;
        found.mean_tangential += c.tangential_force.norm() / count;
        found.largest = found.largest.max(f);
        // A negative number saturates to 0.
        found.contacts[((f / FORCE_BIN_WIDTH) as usize).min(FORCE_BINS - 1)] += 1;
    }
    Some(found)
}

/// Mobilised friction; `None` without contacts and where there is no limit (μ = 0 or infinite). A contact without
/// normal force is at the limit if it carries a tangential one.
pub fn mobilisation(packing: &Packing) -> Option<Mobilisation> {
    let mu = packing.friction;
    if packing.contacts.is_empty() || mu == 0.0 || mu.is_infinite() {
        return None;
    }
    let mut found = Mobilisation::default();
    for c in &packing.contacts {
        let (carried, limit) = (c.tangential_force.norm(), mu * c.normal_force.max(0.0));
        let share = if carried < limit { carried / limit } else { f64::from(carried > 0.0) };
        found.mean += share / packing.contacts.len() as f64;
        found.contacts[((share * MOBILISATION_BINS as f64) as usize).min(MOBILISATION_BINS - 1)] += 1;
    }
    // The mean of ones is 1, whatever rounding makes of it.
    found.mean = found.mean.min(1.0);
    Some(found)
}

/// Σ |F_t| t⊗t / Σ |F_t| with t the direction of F_t, trace 1; zero without tangential forces.
pub fn tangential_fabric(packing: &Packing) -> SymTensor {
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
