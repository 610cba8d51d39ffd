//! Running energy balance.
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

use crate::domain::state::State;
use crate::pairs::contacts::Contacts;
use crate::pairs::types::Pair;
use crate::settings::{EngineSettings, Features};
use crate::simd::simd_f64::BLOCK_SIZE;

use grainlab_core::contact::{
    ContactKinematics, ContactSprings, LawVisitor, SpringDashpotSlider, TangentialLaw,
};
use grainlab_core::lanes::LaneVec3;
use grainlab_core::material::effective_radius;
use grainlab_core::{Mat3, Vec3};

/// Energies and works since the balance was switched on, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyBalance {
    /// Kinetic and elastic energy at the start.
    pub start: f64,
    /// Work of the strain of the cell.
    pub strain_work: f64,
    /// Present kinetic energy, of velocities relative to the affine motion and of spins.
    pub kinetic: f64,
    /// Present energy of the normal springs.
    pub normal_springs: f64,
    /// Present energy of the tangential springs.
    pub tangential_springs: f64,
    /// Dissipated by normal dashpots.
    pub normal_damping: f64,
    /// Dissipated by tangential dashpots.
    pub tangential_damping: f64,
    /// Dissipated by sliding.
    pub sliding: f64,
    /// Lost by tangential springs whose stiffness changes or whose contact opens.
    pub history: f64,
    /// Dissipated by the drags on velocities and spins.
    pub drag: f64,
    /// Removed by the thermostat.
    pub thermostat: f64,
    /// Created by the finite time step, negative where it removes energy: work of the springs in the kicks, less the work
    /// that they give along the paths of their contacts. Of second order in the time step.
    pub integration: f64,
}

impl EnergyBalance {
    /// Present kinetic and elastic energy, J.
    pub fn stored(&self) -> f64 {
        self.kinetic + self.normal_springs + self.tangential_springs
    }

    /// Dissipated in all channels, J.
    pub fn dissipated(&self) -> f64 {
        self.normal_damping
            + self.tangential_damping
            + self.sliding
            + self.history
            + self.drag
            + self.thermostat
    }

    /// What the balance misses, J: start + work of the strain + integration − stored − dissipated. Rounding, in a correct run.
    pub fn residual(&self) -> f64 {
        self.start + self.strain_work + self.integration - self.stored() - self.dissipated()
    }

    /// The residual over the largest term of the balance.
    pub fn relative_residual(&self) -> f64 {
        let terms = [self.start, self.strain_work, self.integration, self.stored(), self.dissipated()];
        self.residual() / terms.into_iter().fold(f64::MIN_POSITIVE, |a, t| a.max(t.abs()))
    }
}

/// Sums the works of an engine's steps.
#[derive(Clone, Debug)]
pub(crate) struct EnergyMeter {
    /// The works; energies other than `start` are zero.
    works: EnergyBalance,
    /// Contact radius and history of each slot before forces are evaluated.
    before: Vec<(f64, Vec3)>,
    /// Strain rate that the present forces were evaluated with, 1/s: it may change before the grains move.
    rate: Mat3,
}

/// The works of one kick.
struct Kick {
    works: EnergyBalance,
    kinetic: f64,
}

/// A contact with its forces.
struct ContactWork {
    i: usize,
    j: usize,
    normal: Vec3,
    branch: Vec3,
    /// R − δ/2 of both grains, m.
    levers: [f64; 2],
    elastic: f64,
    normal_force: f64,
    tangential_force: Vec3,
    history: Vec3,
    normal_energy: f64,
    tangential_energy: f64,
}

impl EnergyMeter {
    /// Starts the balance at the present state, with its forces evaluated.
    pub(crate) fn new(state: &State, contacts: &Contacts, settings: &EngineSettings) -> Self {
        let list = contact_works(state, contacts, settings, &state.rate);
        // The first kick begins half a step before the positions: what is before the start is taken off.
        let half = kick(state, settings, &list, 0.5 * state.time_step);
        let mut works = EnergyBalance::default();
        add(&mut works, &half.works, -1.0);
        works.start = half.kinetic + list.iter().map(|c| c.normal_energy + c.tangential_energy).sum::<f64>();
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
        for block in contacts.blocks() {
            for lane in 0..BLOCK_SIZE {
                let h = &block.history;
                let history = Vec3::new(h[0][lane], h[1][lane], h[2][lane]);
                self.before.push((block.contact_radius[lane], history));
            }
        }
    }

    /// Adds what springs and sliders do along the paths of their contacts. Call it after forces are evaluated.
    pub(crate) fn add_paths(&mut self, state: &State, contacts: &Contacts, settings: &EngineSettings) {
        self.rate = state.rate;
        let paths = PathWorks { state, contacts, settings, before: &self.before };
        let works = state.law.visit(&state.material, paths);
        self.works.sliding += works.sliding;
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
        balance
    }
}

/// Adds `factor` times the works of a kick.
fn add(sum: &mut EnergyBalance, kick: &EnergyBalance, factor: f64) {
    sum.strain_work += factor * kick.strain_work;
    sum.normal_damping += factor * kick.normal_damping;
    sum.tangential_damping += factor * kick.tangential_damping;
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
        torque[c.i] += moment * c.levers[0];
        torque[c.j] += moment * c.levers[1];
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
        works.tangential_damping += h * (c.tangential_force - c.history).dot(&slip);
        works.integration += h * (c.elastic * separation - c.history.dot(&slip));
    }
    Kick { works, kinetic }
}

/// `rate` is the strain rate that the forces were evaluated with, 1/s.
fn contact_works(
    state: &State,
    contacts: &Contacts,
    settings: &EngineSettings,
    rate: &Mat3,
) -> Vec<ContactWork> {
    state.law.visit(&state.material, ContactWorks { state, contacts, settings, rate })
}

/// Forces and energies of all contacts, under any law.
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
        let law = law(settings, springs);
        let no_slip = settings.features() == Features::NoSlip;
        let work = |p: Pair| {
            let (c, branch, levers) = kinematics(state, contacts, rate, &p, p.contact_radius);
            let f = if no_slip {
                law.full_force::<f64, false, false, false>(&c, lanes(p.history), 0.0)
            } else {
                law.full_force::<f64, false, true, false>(&c, lanes(p.history), 0.0)
            };
            let k_t = springs.tangential_stiffness(p.contact_radius, 1.0);
            ContactWork {
                i: p.i as usize,
                j: p.j as usize,
                normal: vec3(c.normal),
                branch,
                levers,
                elastic: f.elastic,
                normal_force: f.normal,
                tangential_force: vec3(f.tangential),
                history: p.history,
                normal_energy: springs.normal_energy(f.elastic, c.overlap),
                tangential_energy: 0.5 * p.history.norm_squared() / k_t,
            }
        };
        contacts.touching().map(work).collect()
    }
}

/// What springs and sliders do from the positions of one evaluation to those of the next, under any law.
struct PathWorks<'a> {
    state: &'a State,
    contacts: &'a Contacts,
    settings: &'a EngineSettings,
    before: &'a [(f64, Vec3)],
}

impl LawVisitor for PathWorks<'_> {
    type Output = EnergyBalance;

    fn visit<S: ContactSprings>(self, springs: S) -> EnergyBalance {
        let Self { state, contacts, settings, before } = self;
        let law = law(settings, springs);
        let frictional = settings.features() != Features::Frictionless;
        let normal_energy = |p: &Pair, contact_radius: f64| {
            let overlap = overlap(state, p, contact_radius);
            let force = springs.normal_force(springs.normal_stiffness(contact_radius), overlap);
            springs.normal_energy(force, overlap)
        };
        let tangential_energy = |history: &Vec3, contact_radius: f64| {
            0.5 * history.norm_squared() / springs.tangential_stiffness(contact_radius, 1.0)
        };
        let mut works = EnergyBalance::default();
        let lanes_of_blocks = contacts.blocks().flat_map(|b| (0..BLOCK_SIZE).map(|lane| b.pair(lane)));
        for (pair, (radius_before, history_before)) in lanes_of_blocks.zip(before) {
            let Some(p) = pair else { continue };
            if *radius_before > 0.0 {
                works.integration -= normal_energy(&p, *radius_before);
                works.history += tangential_energy(history_before, *radius_before);
            }
            if !p.touches() {
                continue;
            }
            works.integration += normal_energy(&p, p.contact_radius);
            if !frictional {
                continue;
            }
            let (c, ..) = kinematics(state, contacts, &state.rate, &p, *radius_before);
            let step = match settings.tangential {
                TangentialLaw::Rescaled => {
                    law.history_step::<f64, true>(&c, lanes(*history_before), state.time_step)
                }
                TangentialLaw::Incremental => {
                    law.history_step::<f64, false>(&c, lanes(*history_before), state.time_step)
                }
            };
            let (carried, elastic) = (vec3(step.carried), vec3(step.elastic));
            works.history -= tangential_energy(&carried, p.contact_radius);
            // The mean force over the slip, and over the part of it that the slider takes.
            let mean = 0.5 * (carried + p.history) / springs.tangential_stiffness(p.contact_radius, 1.0);
            works.integration += mean.dot(&(elastic - carried));
            works.sliding += mean.dot(&(elastic - p.history));
        }
        works
    }
}

/// Full overlap of a pair with this contact radius, m.
fn overlap(state: &State, p: &Pair, contact_radius: f64) -> f64 {
    contact_radius * contact_radius / effective_radius(state.radius[p.i as usize], state.radius[p.j as usize])
}

fn law<S: ContactSprings>(settings: &EngineSettings, springs: S) -> SpringDashpotSlider<S> {
    SpringDashpotSlider { springs, friction: settings.friction, damping: settings.damping }
}

/// Kinematics of a pair, its branch vector (m) and the levers R − δ/2 of both grains (m).
fn kinematics(
    state: &State,
    contacts: &Contacts,
    rate: &Mat3,
    p: &Pair,
    contact_radius_before: f64,
) -> (ContactKinematics<f64>, Vec3, [f64; 2]) {
    let (i, j) = (p.i as usize, p.j as usize);
    let branch = contacts.branch(p, state);
    let distance = branch.norm();
    let (r_i, r_j) = (state.radius[i], state.radius[j]);
    let overlap = overlap(state, p, p.contact_radius);
    let levers = [r_i - 0.5 * overlap, r_j - 0.5 * overlap];
    let (v_i, v_j) = (&state.twist[i].0, &state.twist[j].0);
    let velocity = |t: &[f64; 8]| Vec3::new(t[0], t[1], t[2]);
    let spin = |t: &[f64; 8]| Vec3::new(t[4], t[5], t[6]);
    let c = ContactKinematics {
        normal: lanes(branch / distance),
        inverse_distance: 1.0 / distance,
        overlap,
        contact_radius: p.contact_radius,
        contact_radius_before,
        m_eff: 1.0 / (state.inverse_mass[i] + state.inverse_mass[j]),
        relative_velocity: lanes(velocity(v_j) - velocity(v_i) + rate * branch),
        spin_velocity: lanes(spin(v_i) * levers[0] + spin(v_j) * levers[1]),
        spin_sum: lanes(spin(v_i) + spin(v_j)),
    };
    (c, branch, levers)
}

fn lanes(v: Vec3) -> LaneVec3<f64> {
    LaneVec3::new(v.x, v.y, v.z)
}

fn vec3(v: LaneVec3<f64>) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}
