//! One column of the probed stiffness: strains forward and backward, relaxes both, takes the difference.

use super::relaxation::Relaxation;
use super::settings::StrainProbe;
use crate::error::ProbeError;
use grainlab_core::{Contact, SymTensor};
use grainlab_dem::{Engine, Observables};
use grainlab_engine::EngineError;
use std::cmp::Ordering;

/// Steps between two evaluations of the stress.
pub(crate) const STEPS_PER_EVALUATION: u32 = 20;

/// Least number of evaluations; their last third is compared.
const MIN_EVALUATIONS: usize = 6;

/// Least number of steps over which a strain is imposed, and largest strain of one step: far below any
/// relevant overlap.
const STRAIN_STEPS: f64 = 20.0;
const STRAIN_PER_STEP: f64 = 1e-7;

/// Entries of a column are compared with the largest of them, or with this fraction of the affine stiffness
/// if that is larger.
const FEEBLE: f64 = 1e-3;

/// Details of the measurement of one column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProbeColumn {
    /// Steps of each relaxation, including the strain.
    pub steps: u32,
    /// Mean net force on the non-rattlers at the end, over the mean change of contact force by the affine
    /// strain.
    pub residual: f64,
    /// Largest change of an entry over the last third of the steps, relative to the largest entry.
    pub drift: f64,
    /// Largest difference between the forward and the backward column, relative to the largest entry. Hertz's law
    /// contributes about (2/3) amplitude × Θ/p.
    pub forward_backward: f64,
    /// Contacts of the packing at rest that open under either strain.
    pub opened: u32,
    /// Contacts that form under either strain.
    pub closed: u32,
    /// Contacts at the Coulomb limit under either strain.
    pub sliding: u32,
}

/// The packing at rest, the start of every column.
pub(crate) struct RestState {
    engine: Engine,
    stress: [f64; 6],
    contacts: Vec<Contact>,
    /// Largest affine stiffness, Pa.
    affine: f64,
}

impl RestState {
    pub(crate) fn new(engine: Engine) -> Result<Self, EngineError> {
        let seen = engine.observables()?;
        let (stress, affine) = (stress(&seen), amax(&seen.tangent));
        Ok(Self { stress, contacts: contacts(&engine), affine, engine })
    }
}

/// Column `component` of the stiffness, Pa. `load` is the change of contact forces that scales the residuals.
pub(crate) fn strained(
    at_rest: &RestState,
    settings: &StrainProbe,
    load: f64,
    component: usize,
) -> Result<([f64; 6], ProbeColumn), ProbeError> {
    let strain_steps = (settings.amplitude / STRAIN_PER_STEP).ceil().max(STRAIN_STEPS) as u32;
    let mut rate = [0.0; 6];
    // Tensor components: half the engineering shear.
    let share = if component < 3 { 1.0 } else { 0.5 };
    rate[component] = share * settings.amplitude / (f64::from(strain_steps) * at_rest.engine.time_step());
    let mut relaxation = Relaxation::new(vec![at_rest.engine.clone(); 2]);
    for (engine, side) in relaxation.engines.iter_mut().zip([1.0, -1.0]) {
        engine.set_rate(&rate.map(|r| side * r))?;
    }
    for _ in 0..strain_steps {
        relaxation.step()?;
    }
    for engine in &mut relaxation.engines {
        engine.set_rate(&[0.0; 6])?;
    }
    let between = 2.0 * settings.amplitude;
    let mut seen: Vec<[f64; 6]> = Vec::new();
    let mut column = ProbeColumn { steps: strain_steps, ..ProbeColumn::default() };
    loop {
        for _ in 0..STEPS_PER_EVALUATION {
            relaxation.step()?;
        }
        column.steps += STEPS_PER_EVALUATION;
        let [first, second] = [relaxation.engines[0].observables()?, relaxation.engines[1].observables()?];
        let [one, other] = [stress(&first), stress(&second)];
        let entries: [f64; 6] = std::array::from_fn(|k| -(one[k] - other[k]) / between);
        let largest = amax(&entries).max(FEEBLE * at_rest.affine);
        seen.push(entries);
        column.residual = first.unbalanced.max(second.unbalanced) / load;
        // In a slow relaxation, the remaining change is best estimated over a time proportional to the time
        // already spent.
        column.drift = seen[2 * (seen.len() - 1) / 3..]
            .iter()
            .map(|past| difference(past, &entries))
            .fold(0.0, f64::max)
            / largest;
        if seen.len() >= MIN_EVALUATIONS
            && column.residual <= settings.tolerance
            && column.drift <= settings.tolerance
        {
            let side = |s: &[f64; 6], sign: f64| -> [f64; 6] {
                std::array::from_fn(|k| -sign * (s[k] - at_rest.stress[k]) / settings.amplitude)
            };
            column.forward_backward = difference(&side(&one, 1.0), &side(&other, -1.0)) / largest;
            for engine in &relaxation.engines {
                let strained = contacts(engine);
                let (opened, closed) = changes(&at_rest.contacts, &strained);
                column.opened += opened;
                column.closed += closed;
                column.sliding +=
                    strained.iter().filter(|c| c.slides(engine.settings().friction)).count() as u32;
            }
            return Ok((entries, column));
        }
        if column.steps >= settings.max_steps {
            return Err(ProbeError::NotConverged {
                component: SymTensor::COMPONENTS[component],
                residual: column.residual,
                drift: column.drift,
                tolerance: settings.tolerance,
                steps: column.steps,
            });
        }
    }
}

fn stress(snapshot: &Observables) -> [f64; 6] {
    snapshot.stress.tensor.voigt()
}

fn contacts(engine: &Engine) -> Vec<Contact> {
    engine.packing(grainlab_core::Mat3::identity()).contacts
}

fn amax(a: &[f64; 6]) -> f64 {
    a.iter().fold(0.0, |m, v| m.max(v.abs()))
}

fn difference(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    amax(&std::array::from_fn(|k| a[k] - b[k]))
}

/// Numbers of contacts of `before` that are missing in `after`, and of new ones; both lists are sorted.
fn changes(before: &[Contact], after: &[Contact]) -> (u32, u32) {
    let key = |c: &Contact| (c.i, c.j, c.image);
    let (mut b, mut a) = (0, 0);
    let (mut opened, mut closed) = (0, 0);
    while b < before.len() || a < after.len() {
        let order = match (before.get(b), after.get(a)) {
            (Some(x), Some(y)) => key(x).cmp(&key(y)),
            (Some(_), None) => Ordering::Less,
            _ => Ordering::Greater,
        };
        b += usize::from(order != Ordering::Greater);
        a += usize::from(order != Ordering::Less);
        opened += u32::from(order == Ordering::Less);
        closed += u32::from(order == Ordering::Greater);
    }
    (opened, closed)
}
