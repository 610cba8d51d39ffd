//! One sample, and what is inferred of it.

use super::super::speed_table::SpeedLine;
use grainlab_core::notes::Status;
use grainlab_emt::{Sensitivity, SeriesEstimate, SpeedSeries};
use serde::{Serialize, Serializer};

#[derive(Debug, Serialize)]
pub(super) struct Sample {
    pub(super) sample: String,
    pub(super) contact: &'static str,
    #[serde(serialize_with = "named")]
    pub(super) status: Status,
    pub(super) lines: Vec<SpeedLine>,
    #[serde(skip)]
    pub(super) series: SpeedSeries,
    pub(super) estimate: SeriesEstimate,
    pub(super) sensitivity: Sensitivity,
    /// Assumptions for want of a column or flag.
    pub(super) assumed: Vec<String>,
    /// Sentences on what is not determined, contradicts, or z depends on.
    pub(super) notes: Vec<String>,
    pub(super) doubts: Vec<String>,
}

impl Sample {
    pub(super) fn is_contradictory(&self) -> bool {
        self.status == Status::Contradictory
    }
}

fn named<S: Serializer>(status: &Status, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(status.name())
}
