//! A servoed phase in the text: what is imposed on each component, and the control law.

use crate::canonical::{Entry, number, text};
use crate::keys;
use crate::model::PhaseKind;
use crate::reader::{Reader, as_number};
use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
use toml::{Table, Value};

/// Leak of the law `normalised` by default. A swing of the stress falls to a tenth in 460 exchanges by it, also where the packing damps
/// none ([`ServoLaw::Normalised`]). While a strain rate ε̇ is imposed, the stress is off its target by K ε̇ h 0.01/(4 share): less than
/// it scatters at 2 1/s, from 1 kPa on.
const DAMPED: f64 = 0.01;

/// The keys of a servoed phase besides those of every phase.
pub(crate) fn read(r: &mut Reader<'_>) -> PhaseKind {
    let controls = r.sub(&keys::CONTROL, |r| SymTensor::COMPONENTS.map(|c| component(r, c)));
    let controls = controls.unwrap_or([ComponentControl::Held; 6]);
    for (component, message) in tensions(&controls) {
        r.fault(&format!("control.{}", SymTensor::COMPONENTS[component]), message);
    }
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

/// Stress targets that pull along some direction, as no grains without cohesion do: the component, and the message.
fn tensions(controls: &[ComponentControl; 6]) -> Vec<(usize, String)> {
    let target = |c: usize| match controls[c] {
        ComponentControl::Stress(stress) => Some(stress),
        _ => None,
    };
    let pulled = |c: usize| {
        let stress = target(c).filter(|stress| *stress < 0.0)?;
        let message = format!(
            "is {{ stress = {stress:?} }}; it must be 0 or more: a stress below 0 is tension, and grains without cohesion only press"
        );
        Some((c, message))
    };
    // Voigt order: yz, xz, xy.
    let sheared = |c: usize| {
        let [a, b] = [[1, 2], [0, 2], [0, 1]][c - 3];
        let (stress, a, b) = (target(c)?, target(a)?.max(0.0), target(b)?.max(0.0));
        let most = (a * b).sqrt();
        (stress.abs() > most * (1.0 + 1e-9)).then(|| {
            let message = format!(
                "is {{ stress = {stress:?} }}; it must be from {:.6e} to {most:.6e} at these normal stresses: beyond, there is tension \
                 along some direction, and grains without cohesion only press",
                -most
            );
            (c, message)
        })
    };
    (0..3).filter_map(pulled).chain((3..6).filter_map(sheared)).collect()
}

fn law(r: &mut Reader<'_>) -> ServoLaw {
    // A response time selects the law that has one.
    let default = if r.has(&keys::RESPONSE_TIME) { "scaled" } else { "normalised" };
    let laws = ["normalised", "scaled", "integral"].map(|law| (law, law));
    match r.choice(&keys::LAW, default, &laws) {
        "scaled" => ServoLaw::Scaled { response_time: r.number(&keys::RESPONSE_TIME, None) },
        "integral" => {
            ServoLaw::Integral { gain: r.number(&keys::GAIN, None), leak: r.number(&keys::LEAK, Some(0.0)) }
        }
        _ => ServoLaw::Normalised {
            share: r.number(&keys::GAIN_SHARE, None),
            leak: r.number(&keys::LEAK, Some(DAMPED)),
        },
    }
}

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
