//! Packings within a phase: how often one is published.

use crate::keys;
use crate::model::Record;
use crate::reader::Reader;

/// Progress of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travelled {
    /// Solver steps of the run.
    pub steps: u64,
    /// Simulated time since the phase began, s.
    pub time: f64,
    /// Integral over time of the largest component of the strain rate since the phase began, without sign.
    pub strain: f64,
}

impl Record {
    /// True if a packing is due between `before` and `now`.
    pub fn is_due(&self, before: &Travelled, now: &Travelled) -> bool {
        // The end of a phase is often a multiple, from which a sum of many intervals differs by rounding.
        let multiples = |travelled: f64, every: f64| (travelled / every + 1e-9).floor();
        let passed = |from: f64, to: f64, every: f64| multiples(to, every) > multiples(from, every);
        match *self {
            Record::EverySteps(every) => now.steps / every > before.steps / every,
            Record::EveryTime(every) => passed(before.time, now.time, every),
            Record::EveryStrain(every) => passed(before.strain, now.strain, every),
        }
    }
}

/// The interval in the text; `None` if the phase publishes no packing within.
pub(crate) fn read(r: &mut Reader<'_>) -> Option<Record> {
    r.sub(&keys::RECORD, |r| {
        let steps = r.get(&keys::EVERY_STEPS).map(|_| Record::EverySteps(r.whole(&keys::EVERY_STEPS, None)));
        let strain = r.optional(&keys::EVERY_STRAIN).map(Record::EveryStrain);
        let time = r.optional(&keys::EVERY_TIME).map(Record::EveryTime);
        let found: Vec<Record> = [steps, strain, time].into_iter().flatten().collect();
        if found.len() != 1 {
            let count = if found.is_empty() { "none" } else { "more than one" };
            r.fault("", format!("has {count} of every_steps, every_strain and every_time; it takes one"));
        }
        found.first().copied()
    })
    .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_packing_is_due_where_a_multiple_is_passed() {
        let at = |steps, time, strain| Travelled { steps, time, strain };
        let due = |record: Record, before, now| record.is_due(&before, &now);
        assert!(due(Record::EverySteps(100), at(190, 0.0, 0.0), at(200, 0.0, 0.0)));
        assert!(!due(Record::EverySteps(100), at(200, 0.0, 0.0), at(299, 0.0, 0.0)));
        assert!(due(Record::EveryStrain(1e-3), at(0, 0.0, 1.9e-3), at(0, 0.0, 2.1e-3)));
        assert!(!due(Record::EveryStrain(1e-3), at(0, 0.0, 2.1e-3), at(0, 0.0, 2.9e-3)));
        assert!(
            due(Record::EveryTime(0.5), at(0, 0.2, 0.0), at(0, 1.4, 0.0)),
            "one, of two that were passed"
        );
    }
}
