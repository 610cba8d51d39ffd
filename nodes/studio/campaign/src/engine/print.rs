//! The commands of a campaign as a script.

use crate::campaign::Campaign;
use crate::command::{command, line};
use crate::folder::Folder;
use grainlab_console::Failure;

/// Prints one command for each member.
pub(super) fn run(campaign: &Campaign, folder: &Folder) -> Result<(), Failure> {
    let mut script = format!(
        "#!/bin/sh\n# Campaign {}: {}, in any order. Each line can be repeated: a finished run is left as it is, an\n\
         # interrupted one is continued.\nunset ROS_DOMAIN_ID\n",
        campaign.name,
        grainlab_console::count(campaign.members.len(), "run")
    );
    for member in &campaign.members {
        script += &line(&command(campaign, folder, member)?);
        script.push('\n');
    }
    grainlab_console::print(&script)
}
