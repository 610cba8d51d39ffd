//! The loading path in the text: phases, cycles, conditions.

use crate::model::{Condition, Conditions, GasMethod, Measure, Phase, PhaseKind};
use crate::table::{Reader, as_number};
use grainlab_core::{ComponentControl, Material, ServoLaw};
use toml::{Table, Value};

/// Unrolled phases a path may have; more is a mistake in a cycle count.
const MAX_PHASES: usize = 100_000;
const GAS_METHODS: [(&str, GasMethod); 2] =
    [("event_driven", GasMethod::EventDriven), ("soft", GasMethod::Soft)];
const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "yz", "xz", "xy"];

/// Grains that a shear wave crosses while a spin dies away, where grains are to come to rest.
///
/// Packings of 500 grains settle in two thirds of the steps that they take without, as with 10 or 100; with 10⁴ in as
/// many. What settles is the same: k to 0.01, moduli to 5e-4. Grains that are held and turn with a slow strain do not feel
/// it: at 50 kPa and 10 rad/s its torque is 4e-4 of what friction bears at one contact.
const SPIN_CROSSINGS: f64 = 1e3;

/// Drag on spins of a relaxing or servoed phase that names none, 1/s.
pub(crate) fn spin_drag(material: &Material, diameter: f64) -> f64 {
    (material.shear_modulus / material.density).sqrt() / (SPIN_CROSSINGS * diameter)
}

/// The phases; `spin_drag` (1/s) is that of relaxing and servoed phases which name none.
pub(crate) fn read(r: &mut Reader<'_>, spin_drag: f64) -> Vec<Phase> {
    let mut phases = Vec::new();
    list(r, "phase", "phase", spin_drag, &mut phases);
    if phases.len() > MAX_PHASES {
        r.fault("phase", format!("unrolls to {} phases; at most {MAX_PHASES}", phases.len()));
        phases.truncate(1);
    }
    for pair in phases.windows(2) {
        if pair[0].publish && pair[0].friction > 0.0 && pair[1].friction == 0.0 {
            let (name, next) = (&pair[0].name, &pair[1].name);
            r.fault("phase", format!("{name} publishes a packing whose tangential forces {next} drops at once; put the frictionless phase elsewhere"));
        }
    }
    for (i, phase) in phases.iter().enumerate() {
        if matches!(phase.kind, PhaseKind::Gas { .. }) != (i == 0) {
            r.fault(
                "phase",
                format!("phase {i} ({}): a path begins with one gas phase and has no other", phase.name),
            );
        }
    }
    phases
}

/// Reads the array of phase tables under `key`.
fn list(r: &mut Reader<'_>, key: &'static str, place: &str, spin_drag: f64, out: &mut Vec<Phase>) {
    let Some(Value::Array(items)) = r.get(key) else {
        r.fault(key, "is missing; it must be an array of tables, one a phase");
        return;
    };
    if items.is_empty() {
        r.fault(key, "is empty; a path needs at least one phase");
    }
    for (i, item) in items.iter().enumerate() {
        let Value::Table(table) = item else {
            r.fault(key, format!("entry {i} is a {}; it must be a table", item.type_str()));
            continue;
        };
        r.adopt(one(format!("{place}[{i}]"), table, spin_drag, out));
    }
}

fn one(place: String, table: &Table, spin_drag: f64, out: &mut Vec<Phase>) -> Vec<crate::Fault> {
    let name = table.get("name").and_then(Value::as_str).unwrap_or("");
    let place = if name.is_empty() { place } else { format!("{place} ({name})") };
    let mut r = Reader::new(place.clone(), table);
    if table.get("kind").and_then(Value::as_str) == Some("") {
        r.fault("kind", "is empty; it must be gas, relax, strain, servo or cycle");
    }
    match r.text("kind", None).as_str() {
        "cycle" => cycle(&mut r, &place, spin_drag, out),
        "" => {
            // Without a kind the other keys cannot be judged; the missing kind is the fault to mend first.
            return r.finish().into_iter().filter(|f| f.place.ends_with(".kind")).collect();
        }
        kind => {
            let kind = kind.to_string();
            if let Some(phase) = phase(&mut r, &kind, spin_drag) {
                out.push(phase);
            } else {
                r.fault("kind", format!("is {kind:?}; it must be gas, relax, strain, servo or cycle"));
                return r.finish().into_iter().filter(|f| f.place.ends_with(".kind")).collect();
            }
        }
    }
    r.finish()
}

fn cycle(r: &mut Reader<'_>, place: &str, spin_drag: f64, out: &mut Vec<Phase>) {
    r.text("name", Some("cycle"));
    let times = r.integer("times", None, 1, 10_000) as usize;
    let mut body = Vec::new();
    list(r, "phase", &format!("{place}.phase"), spin_drag, &mut body);
    if body.len().saturating_mul(times).saturating_add(out.len()) > MAX_PHASES {
        r.fault(
            "times",
            format!("unrolls to {} phases; at most {MAX_PHASES}", body.len().saturating_mul(times)),
        );
        return;
    }
    for round in 1..=times {
        out.extend(body.iter().map(|p| Phase { name: format!("{}#{round}", p.name), ..p.clone() }));
    }
}

fn phase(r: &mut Reader<'_>, kind: &str, spin_drag: f64) -> Option<Phase> {
    let positive = |v: f64| v > 0.0 && v.is_finite();
    let from_zero = |v: f64| v >= 0.0 && v.is_finite();
    let parsed = match kind {
        "gas" => PhaseKind::Gas {
            initial_solid_fraction: r.number(
                "initial_solid_fraction",
                Some(0.3),
                "from 0.001 to 0.35",
                |v| (0.001..=0.35).contains(&v),
            ),
            speed: r.number("speed", Some(1.0), "a speed in m/s, more than 0", positive),
            rate: r.number("rate", None, "a strain rate in 1/s, below 0 (compression)", |v| {
                v < 0.0 && v.is_finite()
            }),
            method: r.choice("method", GasMethod::EventDriven, &GAS_METHODS),
        },
        "relax" => PhaseKind::Relax,
        "strain" => PhaseKind::Strain { rate: six(r, "rate") },
        "servo" => servo(r),
        _ => return None,
    };
    let gas = matches!(parsed, PhaseKind::Gas { .. });
    let hard = matches!(parsed, PhaseKind::Gas { method: GasMethod::EventDriven, .. });
    let (damping, period) = match (gas, hard) {
        (_, true) => (0.0, 20),
        (true, false) => (0.002, 200),
        (false, false) => (0.3, 10),
    };
    let settles = matches!(parsed, PhaseKind::Relax | PhaseKind::Servo { .. });
    let spin_drag = if settles { spin_drag } else { 0.0 };
    let phase = Phase {
        name: r.text("name", Some(kind)),
        friction: r.number(
            "friction",
            gas.then_some(0.0),
            "a friction coefficient, 0 or more (inf: no sliding)",
            |v| v >= 0.0,
        ),
        damping: r.number("damping", Some(damping), "a share of critical, from 0 to 1", |v| {
            (0.0..=1.0).contains(&v)
        }),
        drag: r.number("drag", Some(0.0), "in 1/s, 0 or more", from_zero),
        spin_drag: r.number("spin_drag", Some(spin_drag), "in 1/s, 0 or more", from_zero),
        control_period: r.integer("control_period", Some(period), 1, 100_000) as u32,
        reference: r.boolean("reference", false),
        publish: r.boolean("publish", false),
        until: conditions(r, matches!(parsed, PhaseKind::Servo { .. })),
        kind: parsed,
    };
    if hard {
        refuse_contacts(r, &phase);
    }
    Some(phase)
}

/// An event-driven gas knows nothing of the contact law.
fn refuse_contacts(r: &mut Reader<'_>, phase: &Phase) {
    let keys = [
        ("friction", phase.friction),
        ("damping", phase.damping),
        ("drag", phase.drag),
        ("spin_drag", phase.spin_drag),
    ];
    for (key, value) in keys {
        if value != 0.0 {
            r.fault(
                key,
                format!("is {value}, but an event-driven gas is elastic and frictionless; leave it out"),
            );
        }
    }
    let needs_force = |c: &Condition| {
        matches!(
            c,
            Condition::AtLeast(Measure::Pressure | Measure::Stress(_) | Measure::Unbalanced, _)
                | Condition::AtMost(Measure::Pressure | Measure::Stress(_) | Measure::Unbalanced, _)
        )
    };
    if phase.until.all.iter().any(needs_force) {
        r.fault(
            "until",
            "names a stress or the unbalanced force, but an event-driven gas has no lasting contacts; use solid_fraction, strain, elapsed or speed",
        );
    }
}

/// Six numbers in Voigt order.
fn six(r: &mut Reader<'_>, key: &'static str) -> [f64; 6] {
    let requirement = "six numbers in 1/s, order xx, yy, zz, yz, xz, xy";
    let values: Option<Vec<f64>> = r
        .get(key)
        .and_then(Value::as_array)
        .map(|a| a.iter().filter_map(as_number).filter(|v| v.is_finite()).collect());
    match values.and_then(|v| <[f64; 6]>::try_from(v).ok()) {
        Some(v) => v,
        None => {
            r.fault(key, format!("must be {requirement}"));
            [0.0; 6]
        }
    }
}

fn servo(r: &mut Reader<'_>) -> PhaseKind {
    let positive = |v: f64| v > 0.0 && v.is_finite();
    let controls: [ComponentControl; 6] = r
        .sub("control", |r| COMPONENTS.map(|c| component(r, c)))
        .unwrap_or_else(|| {
            r.fault("control", "is missing; name what each of xx, yy, zz, yz, xz, xy gets: { stress = Pa }, { rate = 1/s } or \"held\"");
            [ComponentControl::Held; 6]
        });
    let rate_limit = r.number("rate_limit", Some(4.0), "a strain rate in 1/s, more than 0", positive);
    let law = law(r);
    let targets = controls[..3]
        .iter()
        .filter_map(|c| if let ComponentControl::Stress(s) = c { Some(*s) } else { None });
    let (count, sum) = targets.fold((0, 0.0), |(n, sum), s| (n + 1, sum + s));
    if count == 0 || sum <= 0.0 {
        r.fault(
            "control",
            "needs a stress target above 0 on average among xx, yy, zz: errors are judged against it",
        );
    }
    PhaseKind::Servo { controls, law, rate_limit }
}

/// Share of the critical gain when the scene names none. Packings settle in as many steps at any share from 0.03 to 0.6;
/// 0.3 leaves a factor of 3 to the limit for stiffness that grows within a control period.
const GAIN_SHARE: f64 = 0.3;

#[derive(Clone, Copy)]
enum Law {
    Normalised,
    Scaled,
    Integral,
}

fn law(r: &mut Reader<'_>) -> ServoLaw {
    let positive = |v: f64| v > 0.0 && v.is_finite();
    // A response time means the law that has one.
    let default = if r.has("response_time") { Law::Scaled } else { Law::Normalised };
    let laws = [("normalised", Law::Normalised), ("scaled", Law::Scaled), ("integral", Law::Integral)];
    let chosen = r.choice("law", default, &laws);
    let leak = |r: &mut Reader<'_>| r.number("leak", Some(0.0), "from 0 to 1", |v| (0.0..=1.0).contains(&v));
    match chosen {
        Law::Normalised => ServoLaw::Normalised {
            share: r.number(
                "gain_share",
                Some(GAIN_SHARE),
                "a share of the critical gain, above 0 and below 1",
                |v| v > 0.0 && v < 1.0,
            ),
            leak: leak(r),
        },
        Law::Scaled => ServoLaw::Scaled {
            response_time: r.number("response_time", None, "a time in s, more than 0", positive),
        },
        Law::Integral => ServoLaw::Integral {
            gain: r.number("gain", None, "in 1/(Pa s), more than 0", positive),
            leak: leak(r),
        },
    }
}

fn component(r: &mut Reader<'_>, key: &'static str) -> ComponentControl {
    let requirement = "{ stress = Pa }, { rate = 1/s } or \"held\"";
    let single = |t: &Table, k: &str| (t.len() == 1).then(|| t.get(k).and_then(as_number)).flatten();
    let parsed = match r.get(key) {
        None => Some(ComponentControl::Held),
        Some(Value::String(s)) if s == "held" => Some(ComponentControl::Held),
        Some(Value::Table(t)) => single(t, "stress")
            .map(ComponentControl::Stress)
            .or(single(t, "rate").map(ComponentControl::StrainRate))
            .filter(|c| matches!(c, ComponentControl::Stress(v) | ComponentControl::StrainRate(v) if v.is_finite())),
        Some(_) => None,
    };
    parsed.unwrap_or_else(|| {
        r.fault(key, format!("must be {requirement}"));
        ComponentControl::Held
    })
}

fn conditions(r: &mut Reader<'_>, servoed: bool) -> Conditions {
    let until = r.sub("until", |r| {
        let mut all = Vec::new();
        condition(r, "solid_fraction", &mut all, |v| Condition::AtLeast(Measure::SolidFraction, v));
        condition(r, "elapsed", &mut all, |v| Condition::AtLeast(Measure::Elapsed, v));
        condition(r, "unbalanced", &mut all, |v| Condition::AtMost(Measure::Unbalanced, v));
        condition(r, "speed", &mut all, |v| Condition::AtMost(Measure::Speed, v));
        condition(r, "pressure_below", &mut all, |v| Condition::AtMost(Measure::Pressure, v));
        condition(r, "pressure_above", &mut all, |v| Condition::AtLeast(Measure::Pressure, v));
        signed(r, "strain", &mut all, |c, v| {
            // A strain is reached from the side of zero.
            if v < 0.0 {
                Condition::AtMost(Measure::Strain(c), v)
            } else {
                Condition::AtLeast(Measure::Strain(c), v)
            }
        });
        signed(r, "stress_above", &mut all, |c, v| Condition::AtLeast(Measure::Stress(c), v));
        signed(r, "stress_below", &mut all, |c, v| Condition::AtMost(Measure::Stress(c), v));
        if servoed {
            condition(r, "on_target", &mut all, |v| Condition::OnTarget { fraction: v });
        }
        let hold = r.number("hold", Some(0.0), "a time in s, 0 or more", |v| v >= 0.0 && v.is_finite());
        let timeout =
            r.number("timeout", Some(1.0), "a time in s, more than 0", |v| v > 0.0 && v.is_finite());
        if hold >= timeout {
            r.fault(
                "hold",
                format!("is {hold}, not below the timeout of {timeout} s: the phase could never end"),
            );
        }
        if all.is_empty() {
            r.fault("", "names no condition: the phase would never end by itself");
        }
        Conditions { all, hold, timeout }
    });
    until.unwrap_or_else(|| {
        r.fault("until", "is missing; it must be a table of conditions that end the phase");
        Conditions { all: Vec::new(), hold: 0.0, timeout: 1.0 }
    })
}

fn condition(
    r: &mut Reader<'_>,
    key: &'static str,
    out: &mut Vec<Condition>,
    make: impl Fn(f64) -> Condition,
) {
    if r.get(key).is_some() {
        let value = r.number(key, Some(0.0), "a finite number", f64::is_finite);
        out.push(make(value));
    }
}

/// A table of component = value.
fn signed(
    r: &mut Reader<'_>,
    key: &'static str,
    out: &mut Vec<Condition>,
    make: impl Fn(usize, f64) -> Condition,
) {
    r.sub(key, |r| {
        for (c, name) in COMPONENTS.iter().enumerate() {
            condition(r, name, out, |v| make(c, v));
        }
    });
}
