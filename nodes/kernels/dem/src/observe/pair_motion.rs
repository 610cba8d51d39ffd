//! Position and motion of a pair of grains, as the scalar contact law needs them.

use crate::domain::state::State;
use crate::pairs::contacts::Contacts;
use crate::pairs::types::Pair;
use grainlab_core::contact::ContactKinematics;
use grainlab_core::effective_radius;
use grainlab_core::lanes::LaneVec3;
use grainlab_core::{Mat3, Vec3};

pub(super) struct PairMotion {
    pub(super) contact: ContactKinematics<f64>,
    /// R* (ω_j − ω_i) × n, m/s.
    pub(super) rolling: LaneVec3<f64>,
    pub(super) branch: Vec3,
    /// R − δ/2 of both grains, m.
    pub(super) levers: [f64; 2],
    /// Effective radius R*, m.
    pub(super) r_eff: f64,
}

/// The motion of a pair in a cell that strains at `rate` (1/s).
pub(super) fn kinematics(
    state: &State,
    contacts: &Contacts,
    rate: &Mat3,
    p: &Pair,
    contact_radius_before: f64,
) -> PairMotion {
    let (i, j) = (p.i as usize, p.j as usize);
    let branch = contacts.branch(p, state);
    let distance = branch.norm();
    let normal = branch / distance;
    let (r_i, r_j) = (state.radius[i], state.radius[j]);
    let overlap = p.overlap(&state.radius, p.history.contact_radius);
    let levers = [r_i - 0.5 * overlap, r_j - 0.5 * overlap];
    let r_eff = effective_radius(r_i, r_j);
    let (v_i, v_j) = (&state.twist[i].0, &state.twist[j].0);
    let velocity = |t: &[f64; 8]| Vec3::new(t[0], t[1], t[2]);
    let spin = |t: &[f64; 8]| Vec3::new(t[4], t[5], t[6]);
    let contact = ContactKinematics {
        normal: lanes(normal),
        inverse_distance: 1.0 / distance,
        overlap,
        contact_radius: p.history.contact_radius,
        contact_radius_before,
        m_eff: 1.0 / (state.inverse_mass[i] + state.inverse_mass[j]),
        relative_velocity: lanes(velocity(v_j) - velocity(v_i) + rate * branch),
        spin_velocity: lanes(spin(v_i) * levers[0] + spin(v_j) * levers[1]),
        spin_sum: lanes(spin(v_i) + spin(v_j)),
    };
    let rolling = lanes((spin(v_j) - spin(v_i)).cross(&normal) * r_eff);
    PairMotion { contact, rolling, branch, levers, r_eff }
}

pub(super) fn lanes(v: Vec3) -> LaneVec3<f64> {
    LaneVec3::new(v.x, v.y, v.z)
}

pub(super) fn vec3(v: LaneVec3<f64>) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}
