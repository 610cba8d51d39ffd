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
use crate::pairs::types::{History, Pair};
use crate::settings::{EngineSettings, Features};

use grainlab_core::contact::{
    ContactKinematics, ContactSprings, HistoryStep, LawVisitor, SpringDashpotSlider, TangentialLaw,
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
    /// Present energy of the rolling springs.
    pub rolling_springs: f64,
    /// Dissipated by normal dashpots.
    pub normal_damping: f64,
    /// Dissipated by tangential dashpots.
    pub tangential_damping: f64,
    /// Dissipated by rolling dashpots.
    pub rolling_damping: f64,
    /// Dissipated by sliding.
    pub sliding: f64,
    /// Dissipated by rolling beyond the limit of the rolling springs.
    pub rolling: f64,
    /// Lost by tangential springs whose stiffness changes, and by tangential and rolling springs whose contact opens.
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
        self.kinetic + self.normal_springs + self.tangential_springs + self.rolling_springs
    }

    /// Dissipated in all channels, J.
    pub fn dissipated(&self) -> f64 {
        self.normal_damping
            + self.tangential_damping
            + self.rolling_damping
            + self.sliding
            + self.rolling
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
    /// R*, m.
    r_eff: f64,
    rolling_force: Vec3,
    history: History,
    normal_energy: f64,
    tangential_energy: f64,
    rolling_energy: f64,
}

impl ContactWork {
    fn energy(&self) -> f64 {
        self.normal_energy + self.tangential_energy + self.rolling_energy
    }
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
        let frictional = settings.features() != Features::Frictionless;
        let work = |p: Pair| {
            let m = kinematics(state, contacts, rate, &p, p.history.contact_radius);
            let (c, tangential) = (&m.contact, lanes(p.history.tangential));
            let f = if no_slip {
                law.full_force::<f64, false, false, false>(c, tangential, 0.0)
            } else {
                law.full_force::<f64, false, true, false>(c, tangential, 0.0)
            };
            let rolling = if S::ROLLS && frictional {
                vec3(
                    law.rolling_force::<f64, false>(c, m.rolling, f.elastic, lanes(p.history.rolling), 0.0)
                        .total,
                )
            } else {
                Vec3::zeros()
            };
            ContactWork {
                i: p.i as usize,
                j: p.j as usize,
                normal: vec3(c.normal),
                branch: m.branch,
                levers: m.levers,
                elastic: f.elastic,
                normal_force: f.normal,
                tangential_force: vec3(f.tangential),
                r_eff: m.r_eff,
                rolling_force: rolling,
                history: p.history,
                normal_energy: springs.normal_energy(f.elastic, c.overlap),
                tangential_energy: tangential_energy(&springs, &p.history.tangential, c.contact_radius),
                rolling_energy: rolling_energy(&springs, &p.history.rolling),
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
    before: &'a [Option<Pair>],
}

impl LawVisitor for PathWorks<'_> {
    type Output = EnergyBalance;

    fn visit<S: ContactSprings>(self, springs: S) -> EnergyBalance {
        let Self { state, contacts, settings, before } = self;
        let law = law(settings, springs);
        let frictional = settings.features() != Features::Frictionless;
        let normal_energy = |p: &Pair, contact_radius: f64| {
            let force = springs
                .normal_force(springs.normal_stiffness(contact_radius), overlap(state, p, contact_radius));
            springs.normal_energy(force, overlap(state, p, contact_radius))
        };
        let mut works = EnergyBalance::default();
        for (pair, before) in contacts.pairs().zip(before) {
            let (Some(p), Some(b)) = (pair, before) else { continue };
            let before = b.history;
            if b.touches() {
                works.integration -= normal_energy(&p, before.contact_radius);
                works.history += tangential_energy(&springs, &before.tangential, before.contact_radius);
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
            let step = match settings.tangential {
                TangentialLaw::Rescaled => {
                    law.history_step::<f64, true>(&m.contact, history, state.time_step)
                }
                TangentialLaw::Incremental => {
                    law.history_step::<f64, false>(&m.contact, history, state.time_step)
                }
            };
            let k_t = springs.tangential_stiffness(p.history.contact_radius, 1.0);
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

/// Energy of a tangential spring, J.
fn tangential_energy(springs: &impl ContactSprings, force: &Vec3, contact_radius: f64) -> f64 {
    0.5 * force.norm_squared() / springs.tangential_stiffness(contact_radius, 1.0)
}

/// Energy of a rolling spring, J.
fn rolling_energy<S: ContactSprings>(springs: &S, force: &Vec3) -> f64 {
    if S::ROLLS { 0.5 * force.norm_squared() / springs.rolling().stiffness } else { 0.0 }
}

/// Full overlap of a pair with this contact radius, m.
fn overlap(state: &State, p: &Pair, contact_radius: f64) -> f64 {
    contact_radius * contact_radius / effective_radius(state.radius[p.i as usize], state.radius[p.j as usize])
}

fn law<S: ContactSprings>(settings: &EngineSettings, springs: S) -> SpringDashpotSlider<S> {
    SpringDashpotSlider { springs, friction: settings.friction, damping: settings.damping }
}

/// How a pair stands and moves.
struct PairMotion {
    contact: ContactKinematics<f64>,
    /// R* (ω_j − ω_i) × n, m/s.
    rolling: LaneVec3<f64>,
    branch: Vec3,
    /// R − δ/2 of both grains, m.
    levers: [f64; 2],
    /// R*, m.
    r_eff: f64,
}

/// The motion of a pair in a cell that strains at `rate` (1/s).
fn kinematics(
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
    let overlap = overlap(state, p, p.history.contact_radius);
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

fn lanes(v: Vec3) -> LaneVec3<f64> {
    LaneVec3::new(v.x, v.y, v.z)
}

fn vec3(v: LaneVec3<f64>) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}
