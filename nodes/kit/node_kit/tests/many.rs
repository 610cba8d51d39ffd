//! Many nodes on one host: more than the 12 ports to which announcements are sent by unicast.

use grainlab_msgs::topics;
use grainlab_node_kit::{Bus, DdsBus, Demand, FreeDomain, Names};
use std::time::{Duration, Instant};

const NODES: usize = 24;

/// Far above the time needed on an idle machine.
const TIME_LIMIT: Duration = Duration::from_secs(30);

#[test]
fn two_dozen_nodes_of_one_host_find_each_other() {
    let claimed = FreeDomain::take().expect("a free DDS domain");
    let opened = Instant::now();
    let mut nodes: Vec<_> = (0..NODES)
        .map(|i| {
            let mut bus = DdsBus::open(claimed.network(), Names::new(&format!("node_{i}")).unwrap()).unwrap();
            let publisher = bus.advertise(&topics::RUN_STATE).unwrap();
            bus.subscribe(&topics::RUN_STATE, Demand::reliable(10)).unwrap();
            (bus, publisher)
        })
        .collect();
    let begin = Instant::now();
    loop {
        for (bus, _) in &mut nodes {
            bus.wait(Duration::ZERO);
        }
        let found: Vec<usize> = nodes.iter().map(|(bus, publisher)| bus.readers(*publisher)).collect();
        if found.iter().all(|n| *n == NODES - 1) {
            break;
        }
        assert!(begin.elapsed() < TIME_LIMIT, "readers found by each: {found:?}");
        std::thread::sleep(Duration::from_millis(2));
    }
    println!("{NODES} nodes opened in {:.1?}, all matched {:.1?} later", begin - opened, begin.elapsed());
}
