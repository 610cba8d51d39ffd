//! Forces and energies of the present contacts, by the scalar contact law.

use super::pair_motion::{PairMotion, kinematics, lanes, vec3};
use crate::domain::state::State;
use crate::pairs::contacts::Contacts;
use crate::pairs::types::Pair;
use grainlab_core::contact::{ContactForces, ContactSprings, LawVisitor};
use grainlab_core::{Mat3, Vec3};
use grainlab_engine::{EngineSettings, Features};

/// A contact with its forces.
pub(super) struct ContactWork {
    pub(super) pair: Pair,
    pub(super) motion: PairMotion,
    pub(super) forces: ContactForces<f64>,
    pub(super) rolling_force: Vec3,
    /// Energies of the normal, tangential and rolling spring, J.
    pub(super) energies: [f64; 3],
}

/// `rate` is the strain rate that the forces were evaluated with, 1/s.
pub(super) fn contact_works(
    state: &State,
    contacts: &Contacts,
    settings: &EngineSettings,
    rate: &Mat3,
) -> Vec<ContactWork> {
    state.law.visit(&state.material, ContactWorks { state, contacts, settings, rate })
}

struct ContactWorks<'a> {
    state: &'a State,
    contacts: &'a Contacts,
    settings: &'a EngineSettings,
    rate: &'a Mat3,
}

impl LawVisitor for ContactWorks<'_> {
    type Output = Vec<ContactWork>;

    fn visit<S: ContactSprings>(self, springs: S) -> Vec<ContactWork> {
        let Self { state, contacts, settings, rate } = self;
        let law = settings.law(springs);
        let no_slip = settings.features() == Features::NoSlip;
        let frictional = settings.features() != Features::Frictionless;
        let work = |p: Pair| {
            let m = kinematics(state, contacts, rate, &p, p.history.contact_radius);
            let (c, tangential) = (&m.contact, lanes(p.history.tangential));
            let f = if no_slip {
                law.full_force::<f64, false, false>(c, tangential, 0.0)
            } else {
                law.full_force::<f64, false, true>(c, tangential, 0.0)
            };
            let rolling = if S::ROLLS && frictional {
                vec3(
                    law.rolling_force::<f64, false>(c, m.rolling, f.elastic, lanes(p.history.rolling), 0.0)
                        .total,
                )
            } else {
                Vec3::zeros()
            };
            let energies = [
                springs.normal_energy(f.elastic, c.contact_radius, c.overlap),
                tangential_energy(
                    &p.history.tangential,
                    springs.tangential_stiffness(c.contact_radius, c.overlap, 1.0),
                ),
                rolling_energy(&springs, &p.history.rolling),
            ];
            ContactWork { pair: p, forces: f, rolling_force: rolling, energies, motion: m }
        };
        contacts.touching().map(work).collect()
    }
}

/// Energy of a tangential spring of this stiffness (N/m), J.
pub(super) fn tangential_energy(force: &Vec3, stiffness: f64) -> f64 {
    0.5 * force.norm_squared() / stiffness
}

/// Energy of a rolling spring, J.
pub(super) fn rolling_energy<S: ContactSprings>(springs: &S, force: &Vec3) -> f64 {
    if S::ROLLS { 0.5 * force.norm_squared() / springs.rolling().stiffness } else { 0.0 }
}
