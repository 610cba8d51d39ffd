//! Stress, tangent stiffness and balance of the present contacts.

use crate::error::DemError;
use crate::pairs::Pairs;
use crate::state::{Soa, State};
use grains::stress::Stress;
use grains::{Mat3, Vec3};

/// What one look at the contacts gives. Nothing in the state changes by looking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot {
    /// Love–Weber stress of the elastic contact forces.
    pub stress: Stress,
    /// Affine tangent stiffness of the present contacts, Pa: C_iiii for xx, yy, zz and C_ijij for yz, xz, xy.
    pub tangent: [f64; 6],
    /// Solid fraction.
    pub solid_fraction: f64,
    /// Contacts.
    pub contacts: u32,
    /// k = 2 contacts/grains.
    pub coordination: f64,
    /// Mean net force of non-rattlers over mean contact force; 1 where nothing is in contact.
    pub unbalanced: f64,
}

/// A contact overlapping by more than this share of a diameter is outside Hertz's law.
const OVERLAP_LIMIT: f64 = 0.1;

pub(crate) fn snapshot(state: &State, pairs: &Pairs, friction: f64) -> Result<Snapshot, DemError> {
    let volume = state.cell.volume();
    let mut virial = Mat3::zeros();
    let mut tangent = [0.0; 6];
    let mut net = Soa::zeros(state.grains());
    let mut force_sum = 0.0;
    let mut contacts = 0u32;
    for p in 0..pairs.len() {
        let overlap = pairs.overlap[p];
        if overlap <= 0.0 {
            continue;
        }
        let (i, j) = (pairs.i[p] as usize, pairs.j[p] as usize);
        let branch = pairs.branch(p, &state.position);
        let distance = branch.norm();
        let normal = branch / distance;
        let r_eff = grains::material::effective_radius(state.radius[i], state.radius[j]);
        let diameter = 2.0 * state.radius[i].min(state.radius[j]);
        if overlap > OVERLAP_LIMIT * diameter {
            let (first, second) = (state.ids[i], state.ids[j]);
            return Err(DemError::Overlap { step: state.step, first, second, overlap });
        }
        let force = normal * state.material.normal_force(r_eff, overlap) - pairs.tangential.get(p);
        virial += force * branch.transpose();
        net.add(i, -force);
        net.add(j, force);
        force_sum += force.norm();
        contacts += 1;
        let k_n = state.material.normal_stiffness(r_eff, overlap);
        let k_t = if friction > 0.0 { state.material.tangential_stiffness(r_eff, overlap) } else { 0.0 };
        add_tangent(&mut tangent, &normal, k_n * distance * distance, k_t * distance * distance);
    }
    let solid: f64 = state.radius.iter().map(|r| r * r * r).sum();
    Ok(Snapshot {
        stress: Stress::from_virial(&virial, volume),
        tangent: tangent.map(|t| t / volume),
        solid_fraction: 4.0 / 3.0 * std::f64::consts::PI * solid / volume,
        contacts,
        coordination: 2.0 * f64::from(contacts) / state.grains() as f64,
        unbalanced: unbalanced(pairs, &net, state.grains(), friction, force_sum / f64::from(contacts)),
    })
}

/// Energy of one contact under a unit strain component: normal part by k_n l², tangential part by k_t l².
fn add_tangent(tangent: &mut [f64; 6], n: &Vec3, normal: f64, tangential: f64) {
    let q = [n.x * n.x, n.y * n.y, n.z * n.z];
    for k in 0..3 {
        tangent[k] += normal * q[k] * q[k] + tangential * (q[k] - q[k] * q[k]);
        let (a, b) = (q[(k + 1) % 3], q[(k + 2) % 3]);
        tangent[3 + k] += normal * a * b + tangential * (0.25 * (a + b) - a * b);
    }
}

fn unbalanced(pairs: &Pairs, net: &Soa, grains: usize, friction: f64, mean_force: f64) -> f64 {
    let alive = load_bearing(pairs, grains, friction);
    let bearing = alive.iter().filter(|a| **a).count();
    if bearing == 0 {
        return 1.0;
    }
    let sum: f64 = (0..grains).filter(|i| alive[*i]).map(|i| net.get(i).norm()).sum();
    sum / bearing as f64 / mean_force
}

/// Grains that are no rattlers: recursively at least 2 contacts with friction, 4 without.
fn load_bearing(pairs: &Pairs, grains: usize, friction: f64) -> Vec<bool> {
    let least = if friction > 0.0 { 2u32 } else { 4 };
    let mut alive = vec![true; grains];
    loop {
        let mut count = vec![0u32; grains];
        for p in 0..pairs.len() {
            let (i, j) = (pairs.i[p] as usize, pairs.j[p] as usize);
            if pairs.overlap[p] > 0.0 && alive[i] && alive[j] {
                count[i] += 1;
                count[j] += 1;
            }
        }
        let mut changed = false;
        for i in 0..grains {
            if alive[i] && count[i] < least {
                alive[i] = false;
                changed = true;
            }
        }
        if !changed {
            return alive;
        }
    }
}
