//! Stress, tangent stiffness and force balance of the present contacts.

use super::contact_sums::{ChunkContacts, ContactSums, SlotForces, sum_chunk};
use super::rattlers::NetForces;
use crate::domain::state::State;
use crate::force::geometry::ForceInput;
use crate::pairs::contacts::Contacts;
use crate::pairs::subdomain_pairs::SubdomainPairs;
use crate::pairs::types::Pair;
use crate::simd::instruction_set::Simd;
use crate::simd::simd_f64::BLOCK_SIZE;
use grainlab_core::contact::{ContactSprings, LawVisitor};
use grainlab_core::stress::Stress;
use grainlab_core::{Mat3, min_contacts};
use grainlab_engine::{Compute, EngineError, EngineSettings};

/// Observed state of the present contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observables {
    /// Love–Weber stress of the elastic contact forces.
    pub stress: Stress,
    /// Affine tangent stiffness of the present contacts, Pa: C_iiii for xx, yy, zz and C_ijij for yz, xz, xy.
    pub tangent: [f64; 6],
    /// Solid fraction of the packing.
    pub solid_fraction: f64,
    /// Number of contacts.
    pub contacts: u32,
    /// Coordination number k = 2 contacts/grains.
    pub coordination: f64,
    /// Unbalanced force ratio: mean net force of non-rattlers over mean contact force; 1 where nothing is in contact.
    pub unbalanced: f64,
}

pub(crate) fn observe(
    state: &State,
    contacts: &Contacts,
    settings: &EngineSettings,
    compute: &Compute,
    simd: Simd,
) -> Result<Observables, EngineError> {
    let mut forces: Vec<SlotForces> = vec![[[0.0; BLOCK_SIZE]; 3]; contacts.blocks().count()];
    let total = state.law.visit(
        &state.material,
        SumContacts { state, contacts, settings, compute, simd, forces: &mut forces },
    );
    if total.too_deep {
        return Err(overlap_error(state, contacts));
    }
    let volume = state.cell.volume();
    let [xx, yy, zz, yz, xz, xy, zy, zx, yx, ..] = total.values;
    let virial = Mat3::new(xx, xy, xz, yx, yy, yz, zx, zy, zz);
    let net_forces = NetForces::new(contacts, &forces, state.len(), min_contacts(settings.friction));
    let mean_force = total.values[9] / f64::from(net_forces.contacts);
    let solid: f64 = state.radius.iter().map(|r| r * r * r).sum();
    Ok(Observables {
        stress: Stress::from_virial(&virial, volume),
        tangent: std::array::from_fn(|k| total.values[10 + k] / volume),
        solid_fraction: 4.0 / 3.0 * std::f64::consts::PI * solid / volume,
        contacts: net_forces.contacts,
        coordination: 2.0 * f64::from(net_forces.contacts) / state.len() as f64,
        unbalanced: net_forces.mean().map_or(1.0, |f| f / mean_force),
    })
}

struct SumContacts<'a> {
    state: &'a State,
    contacts: &'a Contacts,
    settings: &'a EngineSettings,
    compute: &'a Compute,
    simd: Simd,
    forces: &'a mut [SlotForces],
}

impl LawVisitor for SumContacts<'_> {
    type Output = ContactSums;

    fn visit<S: ContactSprings>(self, springs: S) -> ContactSums {
        let Self { state, contacts, settings, compute, simd, forces } = self;
        let input = ForceInput::new(state, contacts.images.offsets(), settings, springs);
        let mut total = ContactSums::default();
        let mut rest = forces;
        let chunks =
            contacts.subdomains.iter().flat_map(SubdomainPairs::owned_chunks).map(|(blocks, sizes)| {
                let (force, after) = std::mem::take(&mut rest).split_at_mut(blocks.len());
                rest = after;
                ChunkContacts { input, blocks, sizes, force, friction: settings.friction > 0.0 }
            });
        let sums = compute.map_subdomains(chunks, |chunk| sum_chunk(chunk, simd));
        sums.iter().for_each(|sums| total.add(sums));
        total
    }
}

/// Names the contact with the largest overlap relative to its smaller grain.
fn overlap_error(state: &State, contacts: &Contacts) -> EngineError {
    let radii = |p: &Pair| (state.radius[p.i as usize], state.radius[p.j as usize]);
    let overlap = |p: &Pair| p.overlap(&state.radius, p.history.contact_radius);
    let depth = |p: &Pair| overlap(p) / radii(p).0.min(radii(p).1);
    let worst = contacts.touching().max_by(|a, b| depth(a).total_cmp(&depth(b)));
    let (first, second, overlap) =
        worst.map_or((0, 0, f64::NAN), |p| (state.ids[p.i as usize], state.ids[p.j as usize], overlap(&p)));
    EngineError::Overlap { step: state.step, first, second, overlap }
}
