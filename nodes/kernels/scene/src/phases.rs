//! The loading path in the text: phases and cycles.

use crate::canonical::{Entries, Entry, numbers, text};
use crate::fault::Fault;
use crate::key::Key;
use crate::keys;
use crate::model::{Condition, GasMethod, Measure, Phase, PhaseKind};
use crate::reader::{Reader, as_number, kind};
use crate::sizes::Sizes;
use crate::{ends, record, servo, until};
use grainlab_core::Material;
use toml::{Table, Value};

/// Maximum number of unrolled phases of a path; more indicates a wrong cycle count.
const MAX_PHASES: usize = 100_000;
const GAS_METHODS: [(&str, GasMethod); 2] =
    [("event_driven", GasMethod::EventDriven), ("soft", GasMethod::Soft)];

/// Number of grains that a shear wave crosses during the decay time of spins, in phases that come to rest.
///
/// Packings of 500 grains settle in two thirds of the steps that they need without this drag, as with 10 or
/// 100; with 10⁴ in the same number. The settled state is the same: k to 0.01, moduli to 5e-4. The effect on
/// grains that rotate with a slow strain is negligible: at 50 kPa and 10 rad/s the torque is 4e-4 of the
/// friction limit of one contact.
const SPIN_CROSSINGS: f64 = 1e3;

/// Values that phases take from the scene by default.
pub(crate) struct Inherited<'a> {
    pub(crate) sizes: &'a Sizes,
    pub(crate) friction: Option<f64>,
    /// True if a phase used the friction.
    pub(crate) taken: bool,
    /// Drag on spins of relaxing and servoed phases, 1/s.
    pub(crate) spin_drag: f64,
    /// Lower bound of the solid fraction as the next phase begins; 0 if it is not known.
    pub(crate) solid_fraction: f64,
}

/// Default of the drag on spins of a relaxing or servoed phase, 1/s.
pub(crate) fn spin_drag(material: &Material, diameter: f64) -> f64 {
    (material.shear_modulus / material.density).sqrt() / (SPIN_CROSSINGS * diameter)
}

/// The phases of a scene, with or without a gas at the start.
pub(crate) fn read(r: &mut Reader<'_>, inherited: &mut Inherited<'_>, begins_with_gas: bool) -> Vec<Phase> {
    let mut phases = Vec::new();
    list(r, &keys::PHASE, "phase", inherited, &mut phases);
    if phases.len() > MAX_PHASES {
        r.fault("phase", format!("unrolls to {} phases; at most {MAX_PHASES}", phases.len()));
        phases.truncate(1);
    }
    for pair in phases.windows(2) {
        if pair[0].publish && pair[0].friction > 0.0 && pair[1].friction == 0.0 {
            let (name, next) = (&pair[0].name, &pair[1].name);
            let message = format!(
                "{name} publishes a packing whose tangential forces {next} drops at once; put the frictionless phase elsewhere"
            );
            r.fault("phase", message);
        }
    }
    for (i, phase) in phases.iter().enumerate() {
        if matches!(phase.kind, PhaseKind::Gas { .. }) != (begins_with_gas && i == 0) {
            let rule = match begins_with_gas {
                true => "a path begins with one gas phase and has no other",
                false => "a path that starts from a packing has no gas phase",
            };
            r.fault("phase", format!("phase {} ({}): {rule}", i + 1, phase.name));
        }
    }
    phases
}

fn list(
    r: &mut Reader<'_>,
    key: &'static Key,
    place: &str,
    inherited: &mut Inherited<'_>,
    out: &mut Vec<Phase>,
) {
    let value = r.get(key);
    let Some(Value::Array(items)) = value else {
        r.refuse(key, value);
        return;
    };
    if items.is_empty() {
        r.fault(key.name(), "is empty; a path needs at least one phase");
    }
    let mut tables = Vec::new();
    for (i, item) in items.iter().enumerate() {
        let Value::Table(table) = item else {
            r.fault(key.name(), format!("entry {i} is {}; it must be a table", kind(item)));
            continue;
        };
        let (entries, faults) = one(format!("{place}[{i}]"), table, inherited, out);
        r.adopt(faults);
        tables.push(entries);
    }
    r.keep(key, Entry::Tables(tables));
}

fn one(
    place: String,
    table: &Table,
    inherited: &mut Inherited<'_>,
    out: &mut Vec<Phase>,
) -> (Entries, Vec<Fault>) {
    let name = table.get("name").and_then(Value::as_str).unwrap_or("");
    let place = if name.is_empty() { place } else { format!("{place} ({name})") };
    let mut r = Reader::new(place.clone(), table);
    let word = table.get("kind").and_then(Value::as_str);
    let Some(word) = keys::KINDS.into_iter().map(|(kind, _)| kind).find(|kind| Some(*kind) == word) else {
        // Without a kind the other keys cannot be checked; the missing kind is the first fault to correct.
        r.refuse(&keys::KIND, table.get("kind"));
        let (_, faults) = r.finish();
        return (Entries::new(), faults.into_iter().filter(|f| f.place.ends_with(".kind")).take(1).collect());
    };
    r.get(&keys::KIND);
    r.keep(&keys::KIND, text(word));
    if word == "cycle" {
        cycle(&mut r, &place, inherited, out);
    } else {
        out.push(phase(&mut r, word, inherited));
    }
    r.finish()
}

fn cycle(r: &mut Reader<'_>, place: &str, inherited: &mut Inherited<'_>, out: &mut Vec<Phase>) {
    r.text(&keys::PHASE_NAME, Some("cycle"));
    let times = r.whole(&keys::TIMES, None) as usize;
    let (mut body, before) = (Vec::new(), inherited.solid_fraction);
    list(r, &keys::CYCLE_PHASES, &format!("{place}.phase"), inherited, &mut body);
    // Each round begins where the last one ended.
    if inherited.solid_fraction < before {
        inherited.solid_fraction = 0.0;
    }
    let unrolled = body.len().saturating_mul(times);
    if unrolled.saturating_add(out.len()) > MAX_PHASES {
        r.fault("times", format!("unrolls to {unrolled} phases; at most {MAX_PHASES}"));
        return;
    }
    for round in 1..=times {
        out.extend(body.iter().map(|p| Phase { name: format!("{}#{round}", p.name), ..p.clone() }));
    }
}

fn phase(r: &mut Reader<'_>, word: &str, inherited: &mut Inherited<'_>) -> Phase {
    let name = r.text(&keys::PHASE_NAME, Some(word));
    let kind = match word {
        "gas" => PhaseKind::Gas {
            method: r.choice(&keys::METHOD, "event_driven", &GAS_METHODS),
            initial_solid_fraction: r.number(&keys::INITIAL_SOLID_FRACTION, None),
            speed: r.number(&keys::SPEED, None),
            rate: r.number(&keys::GAS_RATE, None),
        },
        "relax" => PhaseKind::Relax,
        "strain" => PhaseKind::Strain { rate: six(r, &keys::STRAIN_RATE) },
        "servo" => servo::read(r),
        other => unreachable!("{other} is in KINDS and is not read here"),
    };
    let gas = matches!(kind, PhaseKind::Gas { .. });
    let hard = matches!(kind, PhaseKind::Gas { method: GasMethod::EventDriven, .. });
    let (damping, period) = match (gas, hard) {
        (_, true) => (0.0, 20),
        (true, false) => (0.002, 200),
        (false, false) => (0.3, 10),
    };
    let settles = matches!(kind, PhaseKind::Relax | PhaseKind::Servo { .. });
    let spin_drag = if settles { inherited.spin_drag } else { 0.0 };
    let phase = Phase {
        name,
        friction: friction(r, gas, inherited),
        damping: r.number(&keys::DAMPING, Some(damping)),
        drag: r.number(&keys::DRAG, None),
        spin_drag: r.number(&keys::SPIN_DRAG, Some(spin_drag)),
        control_period: r.whole(&keys::CONTROL_PERIOD, Some(period)) as u32,
        reference: r.flag(&keys::REFERENCE),
        publish: r.flag(&keys::PUBLISH),
        record: record::read(r),
        until: until::read(r, matches!(kind, PhaseKind::Servo { .. })),
        kind,
    };
    if hard {
        refuse_contacts(r, &phase);
    }
    let before = match phase.kind {
        PhaseKind::Gas { initial_solid_fraction, .. } => initial_solid_fraction,
        _ => inherited.solid_fraction,
    };
    // A phase with other faults is not judged twice.
    if r.is_sound() {
        let faults = ends::faults(&phase, inherited.sizes, before);
        faults.into_iter().for_each(|(key, message)| r.fault(key, message));
        inherited.solid_fraction = ends::solid_fraction_after(&phase, before);
    }
    phase
}

/// The friction of a phase: its own, else that of the scene, which is in the canonical form once.
fn friction(r: &mut Reader<'_>, gas: bool, inherited: &mut Inherited<'_>) -> f64 {
    if gas || r.has(&keys::PHASE_FRICTION) {
        return r.number(&keys::PHASE_FRICTION, gas.then_some(0.0));
    }
    r.get(&keys::PHASE_FRICTION);
    inherited.taken |= inherited.friction.is_some();
    inherited.friction.unwrap_or_else(|| {
        let requirement = keys::PHASE_FRICTION.requirement();
        let message = format!(
            "is missing; it must be {requirement}, here or at the top of the scene for all phases that name none"
        );
        r.fault("friction", message);
        f64::NAN
    })
}

/// An event-driven gas has no contact law.
fn refuse_contacts(r: &mut Reader<'_>, phase: &Phase) {
    let values = [phase.friction, phase.damping, phase.drag, phase.spin_drag];
    for (key, value) in keys::CONTACT_KEYS.into_iter().zip(values) {
        if value != 0.0 {
            let message =
                format!("is {value}, but an event-driven gas is elastic and frictionless; leave it out");
            r.fault(key.name(), message);
        }
    }
    r.leave_out(&keys::CONTACT_KEYS);
    let needs_force = |c: &Condition| {
        let (Condition::AtLeast(measure, _) | Condition::AtMost(measure, _)) = c else { return false };
        matches!(measure, Measure::Pressure | Measure::Deviator | Measure::Stress(_) | Measure::Unbalanced)
    };
    if phase.until.all.iter().any(needs_force) {
        r.fault(
            "until",
            "names a stress or the unbalanced force, but an event-driven gas has no lasting contacts; use solid_fraction, strain, elapsed or speed",
        );
    }
}

/// Six numbers in Voigt order.
fn six(r: &mut Reader<'_>, key: &'static Key) -> [f64; 6] {
    let value = r.get(key);
    let values: Option<Vec<f64>> = value
        .and_then(Value::as_array)
        .map(|a| a.iter().filter_map(as_number).filter(|v| v.is_finite()).collect());
    match values.and_then(|v| <[f64; 6]>::try_from(v).ok()) {
        Some(v) => {
            r.keep(key, numbers(&v));
            v
        }
        None => {
            r.refuse(key, value);
            [0.0; 6]
        }
    }
}
