//! How long the end of a run waits for what is due.

use super::debts::{INSTRUMENT, Standing};
use super::patience::Patience;
use super::supervisor::{INVERSION, PROBE};
use grainlab_node_kit::Exit;
use std::time::Duration;

/// How long the last packing may take to be measured, what was measured to be inverted, and moduli to follow a structure.
const MEASURED_WITHIN: Duration = Duration::from_secs(600);
const INVERTED_WITHIN: Duration = Duration::from_secs(30);
const MODULI_WITHIN: Duration = Duration::from_secs(5);

/// How long the last packing may take to be measured by a program that is not ours and measured others.
const INSTRUMENT_WITHIN: Duration = Duration::from_secs(60);

/// What is waited for, and for how long.
pub(super) struct Deadline {
    pub(super) of: Standing,
    pub(super) patience: Patience,
    pub(super) exit: Exit,
    pub(super) message: String,
}

impl Deadline {
    /// The last packing was published within a phase: it need not have anything to measure.
    pub(super) fn within_a_phase(standing: Standing) -> Self {
        let whole = Self::of(standing);
        match standing {
            Standing::Measured(_) => whole,
            Standing::Open(_) => {
                Self { patience: Patience::new(INSTRUMENT_WITHIN), exit: Exit::Done, ..whole }
            }
            _ => Self { exit: Exit::Done, ..whole },
        }
    }

    pub(super) fn of(standing: Standing) -> Self {
        let (time, exit, message) = match standing {
            Standing::Bare(node) => {
                (MODULI_WITHIN, Exit::PhysicsInvalid, format!("the last packing has no {}", nothing(node)))
            }
            Standing::Measured(node) => {
                let message = format!(
                    "what {node} measured of the last packing was not inverted: see logs/{INVERSION}.log"
                );
                (INVERTED_WITHIN, Exit::Failure, message)
            }
            Standing::Open(INSTRUMENT) => {
                let message = "a program that the launch file lists sent wave speeds of other packings, and none of the last";
                (INSTRUMENT_WITHIN, Exit::DataLoss, message.to_owned())
            }
            Standing::Open(node) | Standing::Declined(node) => {
                let message = format!("the last packing was not measured: see logs/{node}.log");
                (MEASURED_WITHIN, Exit::Failure, message)
            }
            Standing::Complete => (Duration::ZERO, Exit::Done, String::new()),
        };
        Self { of: standing, patience: Patience::new(time), exit, message }
    }
}

/// What a node did not find of a packing, and where it says why.
pub(super) fn nothing(node: &str) -> String {
    let data = if node == PROBE { "wave speeds" } else { "stiffness" };
    format!("{data} to invert: see logs/{node}.log")
}
