//! Several nodes in one process.

use grainlab_node_kit::{Bus, Component, Exit, Hub, Logger, Names, Next, Node, NodeError, RosArgs, step_all};
use std::sync::Arc;
use std::time::Duration;

/// A node that waits, or panics.
struct Waiting {
    panics: bool,
}

impl Node for Waiting {
    fn step(&mut self, _: &mut dyn Bus) -> Result<Next, NodeError> {
        assert!(!self.panics, "a broken node");
        Ok(Next::Wait(Duration::from_secs(3600)))
    }
}

#[test]
fn a_node_that_panics_ends_alone_with_exit_1_and_its_log_has_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let hub = Hub::real_time(Arc::default());
    let component = |name: &str, panics| {
        let log = std::fs::File::create(folder.path().join(name)).unwrap();
        let logger = Logger::of_node(name, &RosArgs::default(), log);
        let bus = hub.bus(Names::new(name).unwrap());
        Component::new(bus, format!("/{name}"), logger, |_| Ok(Box::new(Waiting { panics }))).unwrap()
    };
    let mut components = [component("broken", true), component("sound", false)];
    step_all(&hub, &mut components);
    assert_eq!(components.each_ref().map(Component::exit), [Some(Exit::Failure), None]);
    let log = std::fs::read_to_string(folder.path().join("broken")).unwrap();
    assert!(log.contains("/broken panicked: a broken node; this is a bug"), "{log}");
    assert_eq!(components[1].end(), Exit::Done);
    let log = std::fs::read_to_string(folder.path().join("sound")).unwrap();
    assert!(log.contains("stopping on request") && !log.contains("panicked"), "{log}");
}
