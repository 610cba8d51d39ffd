//! The members that can still be run.

use crate::campaign::Campaign;
use crate::folder::{Folder, MemberState};

/// The members that can still be run.
pub(super) fn pending(campaign: &Campaign, folder: &Folder) -> Vec<usize> {
    let is_pending = |n: &usize| {
        matches!(folder.state(&campaign.members[*n]), MemberState::Waiting | MemberState::Interrupted)
    };
    (0..campaign.members.len()).filter(is_pending).collect()
}
