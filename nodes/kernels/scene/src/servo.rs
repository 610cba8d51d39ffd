//! A servoed phase in the text: what is imposed on each component, and the control law.

use crate::canonical::{Entry, number, text};
use crate::keys;
use crate::model::PhaseKind;
use crate::reader::{Reader, as_number};
use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
use toml::{Table, Value};

/// The keys of a servoed phase besides those of every phase.
pub(crate) fn read(r: &mut Reader<'_>) -> PhaseKind {
    let controls = r.sub(&keys::CONTROL, |r| SymTensor::COMPONENTS.map(|c| component(r, c)));
    let controls = controls.unwrap_or([ComponentControl::Held; 6]);
    let rate_limit = r.number(&keys::RATE_LIMIT, None);
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

fn law(r: &mut Reader<'_>) -> ServoLaw {
    // A response time selects the law that has one.
    let default = if r.has(&keys::RESPONSE_TIME) { "scaled" } else { "normalised" };
    let laws = ["normalised", "scaled", "integral"].map(|law| (law, law));
    match r.choice(&keys::LAW, default, &laws) {
        "scaled" => ServoLaw::Scaled { response_time: r.number(&keys::RESPONSE_TIME, None) },
        "integral" => {
            ServoLaw::Integral { gain: r.number(&keys::GAIN, None), leak: r.number(&keys::LEAK, None) }
        }
        _ => ServoLaw::Normalised {
            share: r.number(&keys::GAIN_SHARE, None),
            leak: r.number(&keys::LEAK, None),
        },
    }
}

/// Control of one component.
fn component(r: &mut Reader<'_>, name: &'static str) -> ComponentControl {
    let single = |t: &Table, k: &str| (t.len() == 1).then(|| t.get(k).and_then(as_number)).flatten();
    let parsed = match r.get_named(name) {
        None => Some(ComponentControl::Held),
        Some(Value::String(s)) if s == "held" => Some(ComponentControl::Held),
        Some(Value::Table(t)) => single(t, "stress")
            .map(ComponentControl::Stress)
            .or(single(t, "rate").map(ComponentControl::StrainRate))
            .filter(|c| matches!(c, ComponentControl::Stress(v) | ComponentControl::StrainRate(v) if v.is_finite())),
        Some(_) => None,
    };
    let Some(control) = parsed else {
        r.fault(name, "must be { stress = Pa }, { rate = 1/s } or \"held\"");
        return ComponentControl::Held;
    };
    let entry = match control {
        ComponentControl::Held => text("held"),
        ComponentControl::Stress(value) => Entry::Table(vec![("stress", number(value))]),
        ComponentControl::StrainRate(value) => Entry::Table(vec![("rate", number(value))]),
    };
    r.keep_named(name, entry);
    control
}
