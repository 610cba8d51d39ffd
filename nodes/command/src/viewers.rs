//! The nodes of the studio, which the launcher starts like its own.

use grainlab_launcher::Viewer;
#[cfg(feature = "studio")]
use grainlab_msgs::topics;

/// Nodes for viewers; none in a build without the studio.
pub(crate) const VIEWERS: &[Viewer] = &[
    #[cfg(feature = "studio")]
    Viewer {
        name: "packing_pictures",
        summary: "publishes packings as points and markers for viewers, while somebody subscribes",
        parameters: Vec::new,
        topics: Some(&[topics::PACKING]),
        build: |bus, _| Ok(Box::new(grainlab_packing_pictures::PackingPictures::new(bus)?)),
    },
    #[cfg(feature = "studio")]
    Viewer {
        name: "foxglove_bridge",
        summary: "offers every topic to Foxglove and Lichtblick over a WebSocket",
        parameters: grainlab_foxglove_bridge::parameters,
        topics: None,
        build: |bus, parameters| {
            let settings = grainlab_foxglove_bridge::BridgeSettings::of(parameters)?;
            Ok(Box::new(grainlab_foxglove_bridge::FoxgloveBridge::new(bus, settings)?))
        },
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_launcher::{BUILT_IN, LaunchFile};
    use std::collections::BTreeMap;

    #[test]
    fn a_launch_file_starts_the_nodes_of_the_studio_in_a_build_with_it() {
        for node in ["packing_pictures", "foxglove_bridge"] {
            let text = format!("{}- executable: {{cmd: grainlab run {node}}}\n", BUILT_IN[0].1);
            let plans =
                LaunchFile::parse(&text, std::path::Path::new(".")).unwrap().nodes(&BTreeMap::new(), VIEWERS);
            if cfg!(feature = "studio") {
                plans.unwrap().last().unwrap().check_parameters().unwrap();
            } else {
                let error = plans.unwrap_err().to_string();
                assert!(error.contains(&format!("there is no node {node:?}; there are: dem_")), "{error}");
            }
        }
    }
}
