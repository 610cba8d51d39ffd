//! Conditions that end a phase, in the text.

use crate::canonical::number;
use crate::key::Key;
use crate::keys;
use crate::model::{Condition, Conditions, Measure};
use crate::reader::{Reader, as_number};
use grainlab_core::SymTensor;

/// The conditions that end a phase; `servoed` phases may wait for their targets.
pub(crate) fn read(r: &mut Reader<'_>, servoed: bool) -> Conditions {
    let until = r.sub(&keys::UNTIL, |r| {
        let mut all = Vec::new();
        let mut one = |r: &mut Reader<'_>, key: &'static Key, make: &dyn Fn(f64) -> Condition| {
            all.extend(r.optional(key).map(make));
        };
        one(r, &keys::UNTIL_SOLID_FRACTION, &|v| Condition::AtLeast(Measure::SolidFraction, v));
        one(r, &keys::UNTIL_ELAPSED, &|v| Condition::AtLeast(Measure::Elapsed, v));
        one(r, &keys::UNTIL_UNBALANCED, &|v| Condition::AtMost(Measure::Unbalanced, v));
        one(r, &keys::UNTIL_SPEED, &|v| Condition::AtMost(Measure::Speed, v));
        one(r, &keys::UNTIL_PRESSURE_BELOW, &|v| Condition::AtMost(Measure::Pressure, v));
        one(r, &keys::UNTIL_PRESSURE_ABOVE, &|v| Condition::AtLeast(Measure::Pressure, v));
        one(r, &keys::UNTIL_DEVIATOR_ABOVE, &|v| Condition::AtLeast(Measure::Deviator, v));
        one(r, &keys::UNTIL_DEVIATOR_BELOW, &|v| Condition::AtMost(Measure::Deviator, v));
        by_component(r, &keys::UNTIL_STRAIN, &mut all, |c, v| {
            // A strain is reached starting from zero.
            let of = if v < 0.0 { Condition::AtMost } else { Condition::AtLeast };
            of(Measure::Strain(c), v)
        });
        by_component(r, &keys::UNTIL_STRESS_ABOVE, &mut all, |c, v| {
            Condition::AtLeast(Measure::Stress(c), v)
        });
        by_component(r, &keys::UNTIL_STRESS_BELOW, &mut all, |c, v| Condition::AtMost(Measure::Stress(c), v));
        if servoed {
            all.extend(r.optional(&keys::UNTIL_ON_TARGET).map(|v| Condition::OnTarget { fraction: v }));
        }
        let hold = r.number(&keys::HOLD, None);
        let timeout = r.number(&keys::TIMEOUT, None);
        if hold >= timeout {
            let message =
                format!("is {hold}, not below the timeout of {timeout} s: the phase could never end");
            r.fault("hold", message);
        }
        if all.is_empty() {
            r.fault("", "names no condition: the phase would never end by itself");
        }
        Conditions { all, hold, timeout }
    });
    until.unwrap_or(Conditions { all: Vec::new(), hold: 0.0, timeout: 1.0 })
}

fn by_component(
    r: &mut Reader<'_>,
    key: &'static Key,
    out: &mut Vec<Condition>,
    make: impl Fn(usize, f64) -> Condition,
) {
    r.sub(key, |r| {
        for (c, name) in SymTensor::COMPONENTS.into_iter().enumerate() {
            let Some(value) = r.get_named(name) else { continue };
            let found = as_number(value).filter(|v| v.is_finite());
            if found.is_none() {
                r.fault(name, format!("is {value}; it must be a finite number"));
            }
            let found = found.unwrap_or(1.0);
            r.keep_named(name, number(found));
            out.push(make(c, found));
        }
    });
}
