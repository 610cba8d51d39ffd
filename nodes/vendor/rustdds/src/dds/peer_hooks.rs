use std::{fmt, sync::Arc};

use crate::{
  dds::statusevents::ParticipantDescription,
  structure::{guid::GUID, sequence_number::SequenceNumber},
};

pub(crate) type DataFilter = Arc<dyn Fn(GUID, GUID) -> bool + Send + Sync>;
pub(crate) type ReceptionListener = Arc<dyn Fn(GUID, GUID, ReceptionEvent) + Send + Sync>;
pub(crate) type ParticipantListener = Arc<dyn Fn(&ParticipantDescription) -> bool + Send + Sync>;

/// What a local reader learns of a matched writer besides its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReceptionEvent {
  /// The Writer announced to a reliable reader which samples it holds: from
  /// `first` to `last`, or none if `first` is `last` + 1. Some of those may be
  /// of no relevance to the reader.
  Announced {
    first: SequenceNumber,
    last: SequenceNumber,
  },
  /// The first fragment of a sample arrived at a reliable reader.
  Begun { sequence_number: SequenceNumber },
  /// A sample is larger than
  /// [`crate::DomainParticipantBuilder::max_fragmented_sample_size`] and is
  /// skipped.
  TooLarge {
    sequence_number: SequenceNumber,
    /// In bytes.
    size: usize,
    limit: usize,
  },
}

/// What the application decides about its peers, called from RustDDS's own
/// threads.
#[derive(Clone, Default)]
pub(crate) struct PeerHooks {
  /// Writer and local reader: whether the reader takes this sample.
  pub data_filter: Option<DataFilter>,
  /// Writer and local reader: what the reader learned of the writer.
  pub reception_listener: Option<ReceptionListener>,
  /// Called when a participant is discovered, before any endpoint of it is
  /// matched: whether the application counts on it.
  pub participant_listener: Option<ParticipantListener>,
}

impl fmt::Debug for PeerHooks {
  fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    f.write_str("PeerHooks")
  }
}
