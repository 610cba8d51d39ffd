//! Sums the energy balance of a run, kick after kick.

use super::contact_works::{ContactWork, contact_works};
use super::energy::EnergyBalance;
use super::path_works::PathWorks;
use crate::domain::state::State;
use crate::pairs::contacts::Contacts;
use crate::pairs::types::Pair;
use crate::settings::{EngineSettings, Features};
use grainlab_core::{Mat3, Vec3};

/// Sums the works of an engine's steps.
#[derive(Clone, Debug)]
pub(crate) struct EnergyMeter {
    /// The works; energies other than `start` are zero.
    works: EnergyBalance,
    /// The pair in each place before forces are evaluated.
    before: Vec<Option<Pair>>,
    /// Strain rate that the present forces were evaluated with, 1/s: it may change before the grains move.
    rate: Mat3,
}

/// The works of one kick.
struct Kick {
    works: EnergyBalance,
    kinetic: f64,
}

impl EnergyMeter {
    /// Starts the balance at the present state, with its forces evaluated.
    pub(crate) fn new(state: &State, contacts: &Contacts, settings: &EngineSettings) -> Self {
        let list = contact_works(state, contacts, settings, &state.rate);
        // The first kick begins half a step before the positions: what is before the start is taken off.
        let half = kick(state, settings, &list, 0.5 * state.time_step);
        let mut works = EnergyBalance::default();
        add(&mut works, &half.works, -1.0);
        works.start = half.kinetic + list.iter().map(ContactWork::energy).sum::<f64>();
        Self { works, before: Vec::new(), rate: state.rate }
    }

    /// Adds the works of the next kick. Call it before the grains move.
    pub(crate) fn add_kick(&mut self, state: &State, contacts: &Contacts, settings: &EngineSettings) {
        let list = contact_works(state, contacts, settings, &self.rate);
        add(&mut self.works, &kick(state, settings, &list, state.time_step).works, 1.0);
    }

    /// Adds what a thermostat removes that scales the present velocities by `factor`.
    pub(crate) fn add_thermostat(&mut self, state: &State, factor: f64) {
        let kinetic: f64 =
            state.velocities().zip(&state.inverse_mass).map(|(v, m)| 0.5 * v.norm_squared() / m).sum();
        self.works.thermostat += (1.0 - factor * factor) * kinetic;
    }

    /// Saves the history of all pairs. Call it after the lists of pairs are updated, before forces are evaluated.
    pub(crate) fn save_history(&mut self, contacts: &Contacts) {
        self.before.clear();
        self.before.extend(contacts.pairs());
    }

    /// Adds what springs and sliders do along the paths of their contacts. Call it after forces are evaluated.
    pub(crate) fn add_paths(&mut self, state: &State, contacts: &Contacts, settings: &EngineSettings) {
        self.rate = state.rate;
        let paths = PathWorks { state, contacts, settings, before: &self.before };
        let works = state.law.visit(&state.material, paths);
        self.works.sliding += works.sliding;
        self.works.rolling += works.rolling;
        self.works.history += works.history;
        self.works.integration += works.integration;
    }

    /// The balance at the present state.
    pub(crate) fn balance(
        &self,
        state: &State,
        contacts: &Contacts,
        settings: &EngineSettings,
    ) -> EnergyBalance {
        let list = contact_works(state, contacts, settings, &self.rate);
        let half = kick(state, settings, &list, 0.5 * state.time_step);
        let mut balance = self.works;
        add(&mut balance, &half.works, 1.0);
        balance.kinetic = half.kinetic;
        balance.normal_springs = list.iter().map(|c| c.normal_energy).sum();
        balance.tangential_springs = list.iter().map(|c| c.tangential_energy).sum();
        balance.rolling_springs = list.iter().map(|c| c.rolling_energy).sum();
        balance
    }
}

/// Adds `factor` times the works of a kick.
fn add(sum: &mut EnergyBalance, kick: &EnergyBalance, factor: f64) {
    sum.strain_work += factor * kick.strain_work;
    sum.normal_damping += factor * kick.normal_damping;
    sum.tangential_damping += factor * kick.tangential_damping;
    sum.rolling_damping += factor * kick.rolling_damping;
    sum.drag += factor * kick.drag;
    sum.integration += factor * kick.integration;
}

/// A kick over `h` (s): its works, and the kinetic energy after it.
fn kick(state: &State, settings: &EngineSettings, contacts: &[ContactWork], h: f64) -> Kick {
    let n = state.len();
    let (mut force, mut torque) = (vec![Vec3::zeros(); n], vec![Vec3::zeros(); n]);
    for c in contacts {
        let f = c.normal * c.normal_force - c.tangential_force;
        let moment = c.normal.cross(&c.tangential_force);
        force[c.i] -= f;
        force[c.j] += f;
        let rolling = c.normal.cross(&c.rolling_force) * c.r_eff;
        torque[c.i] += moment * c.levers[0] + rolling;
        torque[c.j] += moment * c.levers[1] - rolling;
    }
    let has_spins = settings.features() != Features::Frictionless;
    let keep = |drag: f64| (1.0 - drag * h).max(0.0);
    let (keep_v, keep_w) = (keep(settings.drag), keep(settings.spin_drag));
    let mut works = EnergyBalance::default();
    let mut kinetic = 0.0;
    let (mut velocity, mut spin) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for (g, (v, w)) in state.velocities().zip(state.spins()).enumerate() {
        let (mass, inertia) = (1.0 / state.inverse_mass[g], 1.0 / state.inverse_inertia[g]);
        let affine = state.rate * v;
        let u = v + (force[g] / mass - affine) * h;
        let r = if has_spins { w + torque[g] / inertia * h } else { w };
        let mean = 0.5 * (v + u);
        works.strain_work -= h * mass * mean.dot(&affine);
        let before = 0.5 * (mass * u.norm_squared() + inertia * r.norm_squared());
        let after =
            0.5 * (mass * keep_v * keep_v * u.norm_squared() + inertia * keep_w * keep_w * r.norm_squared());
        works.drag += before - after;
        kinetic += after;
        velocity.push(mean);
        spin.push(0.5 * (w + r));
    }
    for c in contacts {
        let affine = state.rate * c.branch;
        let relative = velocity[c.j] - velocity[c.i] + affine;
        let separation = relative.dot(&c.normal);
        let spins = spin[c.i] * c.levers[0] + spin[c.j] * c.levers[1];
        let slip = relative - c.normal * separation - spins.cross(&c.normal);
        let f = c.normal * c.normal_force - c.tangential_force;
        works.strain_work -= h * f.dot(&affine);
        works.normal_damping -= h * (c.normal_force - c.elastic) * separation;
        let rolling = (spin[c.j] - spin[c.i]).cross(&c.normal) * c.r_eff;
        works.tangential_damping += h * (c.tangential_force - c.history.tangential).dot(&slip);
        works.rolling_damping += h * (c.rolling_force - c.history.rolling).dot(&rolling);
        let elastic =
            c.elastic * separation - c.history.tangential.dot(&slip) - c.history.rolling.dot(&rolling);
        works.integration += h * elastic;
    }
    Kick { works, kinetic }
}
