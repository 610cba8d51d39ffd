//! Kinds of forged messages.

use grainlab_msgs::msg::{Microstructure, Packing, PackingReport, RunState, StrainRate, Stress};
use grainlab_msgs::{Message, Topic, from_cdr, to_cdr, topics};
use std::fmt;

/// A kind of forged message: the topic from which it is made, and that of the forgery.
#[derive(Clone, Copy)]
pub struct Forgery {
    name: &'static str,
    pub(crate) from: Topic,
    pub(crate) to: Topic,
    /// A message that needs no request: an answer of zeros, an old result.
    pub(crate) early: Option<fn() -> Vec<u8>>,
    /// A message that differs from this one by a factor.
    pub(crate) forged: fn(&[u8], f64) -> Option<Vec<u8>>,
}

impl fmt::Debug for Forgery {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl PartialEq for Forgery {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

fn altered<T: Message>(body: &[u8], alter: impl FnOnce(&mut T)) -> Option<Vec<u8>> {
    let mut message: T = from_cdr(body).ok()?;
    alter(&mut message);
    Some(to_cdr(&message))
}

fn scale(values: &mut [f64], by: f64) {
    values.iter_mut().for_each(|v| *v *= by);
}

fn state(state: u8) -> Vec<u8> {
    to_cdr(&RunState { state, ..RunState::default() })
}

/// A kind without an early message.
const fn of(
    name: &'static str,
    from: Topic,
    to: Topic,
    forged: fn(&[u8], f64) -> Option<Vec<u8>>,
) -> Forgery {
    Forgery { name, from, to, early: None, forged }
}

/// The kinds of the plans of seeds, which depend on their order.
pub const FORGERIES: [Forgery; 8] = [
    Forgery {
        early: Some(|| to_cdr(&StrainRate::default())),
        ..of("StrainRate", topics::STRESS, topics::STRAIN_RATE, |body, by| {
            let mut answer = grainlab_servo_controller::answer(&from_cdr(body).ok()?).ok()?;
            scale(&mut answer.rate, by);
            Some(to_cdr(&answer))
        })
    },
    of("Stress", topics::STRESS, topics::STRESS, |body, by| {
        altered(body, |m: &mut Stress| m.stress.zz *= by)
    }),
    of("Packing", topics::PACKING, topics::PACKING, |body, by| {
        altered(body, |m: &mut Packing| scale(&mut m.contact_normal_force, by))
    }),
    of("Report", topics::PACKING_REPORT, topics::PACKING_REPORT, |body, by| {
        altered(body, |m: &mut PackingReport| m.stiffness.iter_mut().for_each(|s| s.stiffness[35] *= by))
    }),
    of("Microstructure", topics::PACKING_REPORT, topics::MICROSTRUCTURE, |body, _| {
        let source_step = from_cdr::<PackingReport>(body).ok()?.source_step;
        let source = "packing_report".to_owned();
        Some(to_cdr(&Microstructure { source_step, source, ..Microstructure::default() }))
    }),
    Forgery {
        early: Some(|| state(RunState::FINISHED)),
        ..of("Finished", topics::STRESS, topics::RUN_STATE, |_, _| Some(state(RunState::FINISHED)))
    },
    of("Failed", topics::STRESS, topics::RUN_STATE, |_, _| Some(state(RunState::FAILED))),
    of("Garbage", topics::STRESS, topics::STRAIN_RATE, |body, by| {
        Some(body[..body.len().min(4 + (by * 40.0) as usize)].to_vec())
    }),
];

/// Coordination numbers of nine in every estimate.
pub const ESTIMATES: Forgery = of("Estimates", topics::MICROSTRUCTURE, topics::MICROSTRUCTURE, |body, _| {
    altered(body, |m: &mut Microstructure| m.estimates.iter_mut().for_each(|e| e.k = vec![9.0]))
});

/// Answers of zeros to no request, and no others.
pub const EARLY_ANSWER: Forgery = Forgery {
    early: Some(|| to_cdr(&StrainRate::default())),
    ..of("EarlyAnswer", topics::STRESS, topics::STRAIN_RATE, |_, _| None)
};

/// No forged microstructure but the first one that its forger is given.
pub const OLD_RESULT: Forgery = of("OldResult", topics::MICROSTRUCTURE, topics::MICROSTRUCTURE, |_, _| None);
