//! Many nodes on one host: more than the 12 ports to which announcements are sent by unicast.

use grainlab_msgs::topics;
use grainlab_node_kit::{Bus, DdsBus, Demand, FreeDomain, Graph, Names};
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
            let subscription = bus.subscribe(&topics::RUN_STATE, Demand::reliable(10)).unwrap();
            (bus, publisher, subscription)
        })
        .collect();
    let begin = Instant::now();
    loop {
        for (bus, ..) in &mut nodes {
            bus.wait(Duration::ZERO);
        }
        let found: Vec<[usize; 2]> =
            nodes.iter().map(|(bus, p, s)| [bus.readers(*p), bus.writers(*s)]).collect();
        if found.iter().all(|found| *found == [NODES - 1; 2]) {
            break;
        }
        assert!(begin.elapsed() < TIME_LIMIT, "readers and writers found by each: {found:?}");
        std::thread::sleep(Duration::from_millis(2));
    }
    println!("{NODES} nodes opened in {:.1?}, all matched {:.1?} later", begin - opened, begin.elapsed());
}
