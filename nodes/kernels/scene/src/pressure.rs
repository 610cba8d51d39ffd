//! One pressure for a whole path: the key `pressure`.

use crate::fault::Fault;
use crate::keys::PRESSURE;
use crate::overlay::name_of;
use crate::reader::{as_number, number_of};
use toml::{Table, Value};

/// Stress over the held one up to which a bound means "none", as in a relaxation, and is not part of the loading.
const NEGLIGIBLE: f64 = 0.01;

const TARGETS: [&str; 3] = [".control.xx.stress", ".control.yy.stress", ".control.zz.stress"];

/// Called with a phase, a key in it, its stress, and the value of the key.
type Visit<'a> = &'a mut dyn FnMut(&str, &str, f64, &mut Value);

/// Takes the key out of a scene and gives every normal stress target its value. The faults are scenes in which it has no clear
/// meaning.
pub(crate) fn apply(scene: &mut Table) -> Vec<Fault> {
    // Another value is refused when the scene is read.
    let wanted = scene.get(PRESSURE.name()).and_then(|value| number_of(&PRESSURE, value));
    let Some(pressure) = wanted else { return Vec::new() };
    scene.remove(PRESSURE.name());
    let fault = |message| Fault { place: PRESSURE.name().into(), message };
    let mut none = Value::Array(Vec::new());
    let path = scene.get_mut("phase").unwrap_or(&mut none);
    let (mut held, mut found) = (Vec::new(), Vec::new());
    each("", "", path, &mut |phase, key, stress, _| {
        if TARGETS.contains(&key) && !held.contains(&stress) {
            held.push(stress);
            found.push(format!("{stress} Pa in {phase}"));
        }
    });
    let [held] = held[..] else {
        let found = if found.is_empty() { "none".into() } else { found.join(", ") };
        let message =
            format!("needs stress targets of normal components, all equal, and the scene has {found}");
        return vec![fault(message + "; set phase.NAME.control of each phase instead")];
    };
    let (mut faults, named) = (Vec::new(), format!("{}kPa", held / 1e3));
    each("", "", path, &mut |phase, key, stress, value| {
        if TARGETS.contains(&key) || key.starts_with(".until") && stress == held {
            *value = pressure.into();
            if phase.contains(&named) && pressure != held {
                faults.push(fault(format!("is not that in the name of phase {phase}: give it another name")));
            }
        } else if stress.abs() > NEGLIGIBLE * held {
            let why = format!("does not say what becomes of {stress} Pa, beside {held} Pa elsewhere");
            faults
                .push(fault(format!("{why}, in phase.{phase}{key}; set the stresses of each phase instead")));
        }
    });
    faults.dedup();
    faults
}

/// Visits every stress target and every bound of `until` on a stress below a place in a phase, in cycles too.
fn each(phase: &str, place: &str, value: &mut Value, visit: Visit<'_>) {
    let is_stress = [".stress", ".pressure_", ".deviator_"].iter().any(|part| place.contains(part));
    match value {
        Value::Array(phases) if matches!(place, "" | ".phase") => {
            for phase in phases {
                let name = phase.as_table().map(|table| name_of(table).to_owned()).unwrap_or_default();
                each(&name, "", phase, visit);
            }
        }
        Value::Table(inner) => {
            inner.iter_mut().for_each(|(key, value)| each(phase, &format!("{place}.{key}"), value, visit));
        }
        value => {
            as_number(value).filter(|_| is_stress).into_iter().for_each(|s| visit(phase, place, s, value));
        }
    }
}
