use std::{fmt, sync::Arc};

use crate::{dds::statusevents::ParticipantDescription, structure::guid::GUID};

pub(crate) type DataFilter = Arc<dyn Fn(GUID, GUID) -> bool + Send + Sync>;
pub(crate) type ParticipantListener = Arc<dyn Fn(&ParticipantDescription) + Send + Sync>;

/// What the application decides about its peers, called from RustDDS's own
/// threads.
#[derive(Clone, Default)]
pub(crate) struct PeerHooks {
  /// Writer and local reader: whether the reader takes this sample.
  pub data_filter: Option<DataFilter>,
  /// Called when a participant is discovered, before any endpoint of it is
  /// matched.
  pub participant_listener: Option<ParticipantListener>,
}

impl fmt::Debug for PeerHooks {
  fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    f.write_str("PeerHooks")
  }
}
