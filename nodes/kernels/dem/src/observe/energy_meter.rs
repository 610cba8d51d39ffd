//! Sums the energy balance of a run, kick after kick.
//!
//! Velocities are those half a step behind the positions, so each step is split at the positions: the works of a kick are the
//! forces times the mean of the velocities before and after it, which balances the kinetic energy exactly. A spring works
//! along the path of its contact too, from one position to the next: that changes its energy. The two works differ by the
//! error of the trapezium rule, of second order in the time step. It is a channel of its own, [`EnergyBalance::integration`].
//!
//! Each channel is summed from its own terms, so that the balance closes to rounding at any time step. It then shows a force
//! in the kernel that is not that of the law, a lost or repeated kick, contact or channel, and a wrong work of the strain. It
//! cannot show a force that is not −dU/dr, or a contact that moves otherwise than its grains: both are in `integration`,
//! which then does not fall with the square of the time step.

use super::contact_works::{ContactWork, contact_works};
use super::pair_motion::vec3;
use super::path_works::PathWorks;
use crate::domain::state::State;
use crate::pairs::contacts::Contacts;
use crate::pairs::types::Pair;
use grainlab_core::{Mat3, Vec3};
use grainlab_engine::{EnergyBalance, EngineSettings, Features};

#[derive(Clone, Debug)]
pub(crate) struct EnergyMeter {
    /// The works; energies other than `start` are zero.
    works: EnergyBalance,
    /// The pair in each place before forces are evaluated.
    before: Vec<Option<Pair>>,
    /// Strain rate that the present forces were evaluated with, 1/s: it may change before the grains move.
    rate: Mat3,
}

impl EnergyMeter {
    /// Starts the balance at the present state, with its forces evaluated.
    pub(crate) fn new(state: &State, contacts: &Contacts, settings: &EngineSettings) -> Self {
        let list = contact_works(state, contacts, settings, &state.rate);
        // The first kick begins half a step before the positions: what is before the start is taken off.
        let half = kick(state, settings, &list, 0.5 * state.time_step);
        let mut works = EnergyBalance::default();
        add(&mut works, &half, -1.0);
        works.start = half.kinetic + list.iter().map(|c| c.energies.iter().sum::<f64>()).sum::<f64>();
        Self { works, before: Vec::new(), rate: state.rate }
    }

    /// Adds the works of the next kick. Call it before the grains move.
    pub(crate) fn add_kick(&mut self, state: &State, contacts: &Contacts, settings: &EngineSettings) {
        let list = contact_works(state, contacts, settings, &self.rate);
        add(&mut self.works, &kick(state, settings, &list, state.time_step), 1.0);
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

    pub(crate) fn balance(
        &self,
        state: &State,
        contacts: &Contacts,
        settings: &EngineSettings,
    ) -> EnergyBalance {
        let list = contact_works(state, contacts, settings, &self.rate);
        let half = kick(state, settings, &list, 0.5 * state.time_step);
        let mut balance = self.works;
        add(&mut balance, &half, 1.0);
        balance.kinetic = half.kinetic;
        [balance.normal_springs, balance.tangential_springs, balance.rolling_springs] =
            [0, 1, 2].map(|spring| list.iter().map(|c| c.energies[spring]).sum());
        balance
    }
}

fn add(sum: &mut EnergyBalance, kick: &EnergyBalance, factor: f64) {
    sum.strain_work += factor * kick.strain_work;
    sum.normal_damping += factor * kick.normal_damping;
    sum.tangential_damping += factor * kick.tangential_damping;
    sum.rolling_damping += factor * kick.rolling_damping;
    sum.drag += factor * kick.drag;
    sum.integration += factor * kick.integration;
}

/// A kick over `h` (s): its works, and the kinetic energy after it.
fn kick(state: &State, settings: &EngineSettings, contacts: &[ContactWork], h: f64) -> EnergyBalance {
    let n = state.len();
    let (mut force, mut torque) = (vec![Vec3::zeros(); n], vec![Vec3::zeros(); n]);
    for c in contacts {
        let (m, i, j) = (&c.motion, c.pair.i as usize, c.pair.j as usize);
        let (normal, tangential) = (vec3(m.contact.normal), vec3(c.forces.tangential));
        let f = normal * c.forces.normal - tangential;
        let moment = normal.cross(&tangential);
        force[i] -= f;
        force[j] += f;
        let rolling = normal.cross(&c.rolling_force) * m.r_eff;
        torque[i] += moment * m.levers[0] + rolling;
        torque[j] += moment * m.levers[1] - rolling;
    }
    let has_spins = settings.features() != Features::Frictionless;
    let keep = |drag: f64| (1.0 - drag * h).max(0.0);
    let (keep_v, keep_w) = (keep(settings.drag), keep(settings.spin_drag));
    let mut works = EnergyBalance::default();
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
        works.kinetic += after;
        velocity.push(mean);
        spin.push(0.5 * (w + r));
    }
    for c in contacts {
        let (m, i, j) = (&c.motion, c.pair.i as usize, c.pair.j as usize);
        let (normal, tangential, history) =
            (vec3(m.contact.normal), vec3(c.forces.tangential), &c.pair.history);
        let affine = state.rate * m.branch;
        let relative = velocity[j] - velocity[i] + affine;
        let separation = relative.dot(&normal);
        let spins = spin[i] * m.levers[0] + spin[j] * m.levers[1];
        let slip = relative - normal * separation - spins.cross(&normal);
        let f = normal * c.forces.normal - tangential;
        works.strain_work -= h * f.dot(&affine);
        works.normal_damping -= h * (c.forces.normal - c.forces.elastic) * separation;
        let rolling = (spin[j] - spin[i]).cross(&normal) * m.r_eff;
        works.tangential_damping += h * (tangential - history.tangential).dot(&slip);
        works.rolling_damping += h * (c.rolling_force - history.rolling).dot(&rolling);
        let elastic =
            c.forces.elastic * separation - history.tangential.dot(&slip) - history.rolling.dot(&rolling);
        works.integration += h * elastic;
    }
    works
}
