//! Phases that cannot end: conditions that exclude each other, that nothing imposed can meet, or that come too late.

use crate::model::{Condition, Conditions, GasMethod, Measure, Phase, PhaseKind, Record};
use crate::path::name;
use crate::phase_share::time_until;
use crate::sizes::Sizes;
use grainlab_core::{ComponentControl, SymTensor};

/// Solid fraction of random close packing: no disordered packing of equal hard spheres is denser.
const CLOSEST_EQUAL: f64 = 0.64;

/// Solid fraction of the closest packing of spheres of two sizes, where the small ones fill the voids of the large ones: 1 − (1 − 0.64)².
const CLOSEST: f64 = 0.87;

/// Volume of the spheres over volume of the cell that no packing has: a close-packed crystal at the largest overlap of a run has 1.02.
const OVERFULL: f64 = 1.1;

/// Solid fraction below which no packing of spheres carries a stress.
const LOOSEST: f64 = 0.3;

/// Why the phase cannot end, or cannot publish the packings that it records: the key at fault, and the message. `solid_fraction`
/// is a lower bound of the one at its begin.
pub(crate) fn faults(phase: &Phase, sizes: &Sizes, solid_fraction: f64) -> Vec<(&'static str, String)> {
    let mut found = Vec::new();
    let all = &phase.until.all;
    for (n, condition) in all.iter().enumerate() {
        let excluded = all[n + 1..].iter().filter_map(|other| excluding(condition, other));
        let other = excluded.chain(never(condition, phase)).chain(too_dense(condition, phase, sizes));
        found.extend(other.map(|message| ("until", message)));
    }
    found.extend(too_late(phase).map(|message| ("until", message)));
    found.extend(overfull(phase, solid_fraction).map(|message| ("until", message)));
    let strains = phase.controls().iter().any(|c| match c {
        ComponentControl::StrainRate(rate) => *rate != 0.0,
        ComponentControl::Stress(_) => true,
        ComponentControl::Held => false,
    });
    if matches!(phase.record, Some(Record::EveryStrain(_))) && !strains {
        found.push(("record.every_strain", "publishes nothing: the phase has no strain".to_owned()));
    }
    found
}

/// Two conditions on one quantity that no value meets.
fn excluding(one: &Condition, other: &Condition) -> Option<String> {
    let ((&Condition::AtLeast(low, above), &Condition::AtMost(high, below))
    | (&Condition::AtMost(high, below), &Condition::AtLeast(low, above))) = (one, other)
    else {
        return None;
    };
    (low == high && above > below).then(|| {
        format!("{} is to be at least {above:e} and at most {below:e}: both never hold at once", name(low))
    })
}

/// A condition that what the phase imposes does not lead to.
fn never(condition: &Condition, phase: &Phase) -> Option<String> {
    let (measure, bound, upwards) = match *condition {
        Condition::AtLeast(measure, bound) => (measure, bound, 1.0),
        Condition::AtMost(measure, bound) => (measure, bound, -1.0),
        Condition::OnTarget { .. } => return None,
    };
    let name = name(measure);
    match measure {
        Measure::Strain(_) if bound != 0.0 => {
            let rate = imposed_rate(measure, phase)?;
            (rate * upwards <= 0.0).then(|| {
                format!("{name} = {bound}, but the phase strains it at {rate} 1/s: it is never there")
            })
        }
        Measure::SolidFraction => {
            let rate = imposed_rate(measure, phase)?;
            (rate * upwards <= 0.0).then(|| {
                format!(
                    "{name} = {bound}, but the phase does not compress: it holds from the start, or never"
                )
            })
        }
        Measure::Stress(0..=2) if upwards < 0.0 && bound < 0.0 => {
            Some(format!("{name} at or below {bound:e} Pa is tension: grains without cohesion only press"))
        }
        Measure::Stress(_) | Measure::Pressure | Measure::Deviator => {
            let target = target(measure, phase)?;
            ((bound - target) * upwards > 0.0).then(|| {
                format!("{name} {bound:e} Pa is beyond the {target:e} Pa that the phase controls it to")
            })
        }
        _ => None,
    }
}

fn too_dense(condition: &Condition, phase: &Phase, sizes: &Sizes) -> Option<String> {
    let PhaseKind::Gas { method: GasMethod::EventDriven, .. } = phase.kind else { return None };
    let &Condition::AtLeast(Measure::SolidFraction, wanted) = condition else { return None };
    let closest = if sizes.ratio() > 1.0 { CLOSEST } else { CLOSEST_EQUAL };
    (wanted >= closest).then(|| {
        format!("solid_fraction = {wanted}: a gas of hard spheres of these sizes jams below {closest}")
    })
}

fn too_late(phase: &Phase) -> Option<String> {
    let Conditions { all, hold, timeout } = &phase.until;
    let times = all.iter().filter_map(|c| Some((c, least_time(c, phase)?)));
    let (condition, time) = times.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let held = if *hold > 0.0 { format!(" and hold for {hold} s") } else { String::new() };
    (time + hold >= *timeout).then(|| {
        let (Condition::AtLeast(measure, _) | Condition::AtMost(measure, _)) = condition else {
            return String::new();
        };
        format!(
            "{} takes {time:.4} s of simulated time{held}, and the phase fails at its timeout of {timeout} s; raise the timeout",
            name(*measure)
        )
    })
}

/// Returns a lower bound of the solid fraction at the end of a phase from one at its begin.
pub(crate) fn solid_fraction_after(phase: &Phase, before: f64) -> f64 {
    let Conditions { all, timeout, .. } = &phase.until;
    let deformed = match phase.imposed_volumetric_rate() {
        Some(rate) => {
            let needed = all.iter().filter_map(|c| least_time(c, phase)).fold(0.0, f64::max);
            before * (-rate * if rate < 0.0 { needed } else { *timeout }).exp()
        }
        // A stress keeps grains together.
        None => before.min(LOOSEST),
    };
    let bound = |c: &Condition| match *c {
        Condition::AtLeast(Measure::SolidFraction, bound) => Some(bound),
        _ => None,
    };
    all.iter().filter_map(bound).fold(deformed, f64::max)
}

fn overfull(phase: &Phase, before: f64) -> Option<String> {
    let rate = phase.imposed_volumetric_rate().filter(|rate| *rate < 0.0 && before > 0.0)?;
    let times = phase.until.all.iter().filter_map(|c| Some((c, least_time(c, phase)?)));
    let (condition, time) = times.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let filled = before * (-rate * time).exp();
    let (Condition::AtLeast(measure, bound) | Condition::AtMost(measure, bound)) = *condition else {
        return None;
    };
    let full = before.recip().ln() / -rate;
    let limit = match measure {
        Measure::Strain(component) => phase.imposed_rate(component)? * full,
        Measure::Elapsed => full,
        _ => return None,
    };
    (filled > OVERFULL).then(|| {
        format!(
            "{} = {bound} is reached where the grains fill the cell {filled:.2} times (their solid fraction is {before:.3} or more as the \
             phase begins, and its rates compress them); the cell is full at {limit:.3}",
            name(measure)
        )
    })
}

/// Least simulated time until a condition holds, s, at the imposed rates; `None` where these do not determine it.
fn least_time(condition: &Condition, phase: &Phase) -> Option<f64> {
    // The solid fraction at the start of another phase is not known.
    let solid_fraction = if let PhaseKind::Gas { initial_solid_fraction: placed, .. } = phase.kind {
        placed
    } else {
        f64::NAN
    };
    time_until(condition, phase, &SymTensor::default(), solid_fraction, 0.0).filter(|time| time.is_finite())
}

/// Rate of a strain component, or of the logarithm of the solid fraction, 1/s; `None` where a stress is controlled instead.
fn imposed_rate(measure: Measure, phase: &Phase) -> Option<f64> {
    match measure {
        Measure::Strain(component) => phase.imposed_rate(component),
        Measure::SolidFraction => phase.imposed_volumetric_rate().map(|rate| -rate),
        _ => None,
    }
}

/// Value that the phase controls a stress to, Pa; `None` where it does not determine it.
fn target(measure: Measure, phase: &Phase) -> Option<f64> {
    let controls = phase.controls();
    let of = |component: usize| match controls[component] {
        ComponentControl::Stress(target) => Some(target),
        _ => None,
    };
    match measure {
        Measure::Stress(component) => of(component),
        Measure::Pressure => Some((of(0)? + of(1)? + of(2)?) / 3.0),
        Measure::Deviator => Some(of(2)? - 0.5 * (of(0)? + of(1)?)),
        _ => None,
    }
}
