//! Kinds of forged messages.

use grainlab_msgs::{Topic, topics};

/// A kind of forged message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Forgery {
    StrainRate,
    Stress,
    Packing,
    Report,
    Microstructure,
    Finished,
    Failed,
    Garbage,
}

impl Forgery {
    pub(super) const ALL: [Forgery; 8] = [
        Forgery::StrainRate,
        Forgery::Stress,
        Forgery::Packing,
        Forgery::Report,
        Forgery::Microstructure,
        Forgery::Finished,
        Forgery::Failed,
        Forgery::Garbage,
    ];

    pub(super) fn topics(self) -> (Topic, Topic) {
        match self {
            Forgery::StrainRate => (topics::STRESS, topics::STRAIN_RATE),
            Forgery::Stress => (topics::STRESS, topics::STRESS),
            Forgery::Packing => (topics::PACKING, topics::PACKING),
            Forgery::Report => (topics::PACKING_REPORT, topics::PACKING_REPORT),
            Forgery::Microstructure => (topics::PACKING_REPORT, topics::MICROSTRUCTURE),
            Forgery::Finished | Forgery::Failed => (topics::STRESS, topics::RUN_STATE),
            Forgery::Garbage => (topics::STRESS, topics::STRAIN_RATE),
        }
    }
}
