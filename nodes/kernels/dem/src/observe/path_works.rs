//! Works of springs and sliders along the paths of their contacts.

use super::contact_works::{rolling_energy, tangential_energy};
use super::pair_motion::{kinematics, lanes, vec3};
use crate::domain::state::State;
use crate::pairs::contacts::Contacts;
use crate::pairs::types::Pair;
use grainlab_core::Vec3;
use grainlab_core::contact::{ContactSprings, HistoryStep, LawVisitor};
use grainlab_engine::{EnergyBalance, EngineSettings, Features};

/// Works of springs and sliders from the positions of one evaluation to those of the next, under any law.
pub(super) struct PathWorks<'a> {
    pub(super) state: &'a State,
    pub(super) contacts: &'a Contacts,
    pub(super) settings: &'a EngineSettings,
    pub(super) before: &'a [Option<Pair>],
}

impl LawVisitor for PathWorks<'_> {
    type Output = EnergyBalance;

    fn visit<S: ContactSprings>(self, springs: S) -> EnergyBalance {
        let Self { state, contacts, settings, before } = self;
        let law = settings.law(springs);
        let frictional = settings.features() != Features::Frictionless;
        let normal_energy = |p: &Pair, contact_radius: f64| {
            let overlap = p.overlap(&state.radius, contact_radius);
            let force = springs.normal_force(springs.normal_stiffness(contact_radius, overlap), overlap);
            springs.normal_energy(force, contact_radius, overlap)
        };
        let tangential_stiffness = |p: &Pair, contact_radius: f64| {
            springs.tangential_stiffness(contact_radius, p.overlap(&state.radius, contact_radius), 1.0)
        };
        let mut works = EnergyBalance::default();
        for (pair, before) in contacts.pairs().zip(before) {
            let (Some(p), Some(b)) = (pair, before) else { continue };
            let before = b.history;
            if b.touches() {
                works.integration -= normal_energy(&p, before.contact_radius);
                let stiffness = tangential_stiffness(&p, before.contact_radius);
                works.history += tangential_energy(&before.tangential, stiffness);
                works.history += rolling_energy(&springs, &before.rolling);
            }
            if !p.touches() {
                continue;
            }
            works.integration += normal_energy(&p, p.history.contact_radius);
            if !frictional {
                continue;
            }
            let m = kinematics(state, contacts, &state.rate, &p, before.contact_radius);
            let history = lanes(before.tangential);
            let step = law.history_step(&m.contact, history, state.time_step);
            let k_t = tangential_stiffness(&p, p.history.contact_radius);
            let slip = SpringStep::new(step, p.history.tangential, k_t);
            works.history -= slip.carried;
            works.sliding += slip.slider;
            works.integration += slip.given;
            if S::ROLLS {
                let step = law.rolling_step(&m.contact, m.rolling, lanes(before.rolling), state.time_step);
                let roll = SpringStep::new(step, p.history.rolling, springs.rolling().stiffness);
                works.history -= roll.carried;
                works.rolling += roll.slider;
                works.integration += roll.given;
            }
        }
        works
    }
}

/// A spring in series with a slider over one step, J.
struct SpringStep {
    /// Energy of the spring as carried from the step before.
    carried: f64,
    /// Work done on spring and slider.
    given: f64,
    /// The part of that which the slider takes.
    slider: f64,
}

impl SpringStep {
    /// `after` is the force at the end, N, `stiffness` that of the spring, N/m.
    fn new(step: HistoryStep<f64>, after: Vec3, stiffness: f64) -> Self {
        let (carried, elastic) = (vec3(step.carried), vec3(step.elastic));
        let mean = 0.5 * (carried + after) / stiffness;
        Self {
            carried: 0.5 * carried.norm_squared() / stiffness,
            given: mean.dot(&(elastic - carried)),
            slider: mean.dot(&(elastic - after)),
        }
    }
}
