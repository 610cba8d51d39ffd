//! A reader that is not waited for, stopped while a writer publishes far beyond its window.

use super::{PATIENCE, Role, claim};
use grainlab_msgs::msg::StrainRate;
use grainlab_msgs::topics;
use rustdds::policy::{Durability, History, Reliability, ResourceLimits};
use rustdds::{
    DomainParticipantBuilder, DomainParticipantStatusEvent as Event, QosPolicyBuilder, StatusEvented,
    TopicKind,
};
use std::net::Ipv4Addr;
use std::time::{Duration, Instant};

/// Maximum number of unacknowledged samples of the writer.
const WINDOW: i32 = 1000;

/// Samples written while the reader is stopped, and the minimum duration.
const SAMPLES: u64 = 60_000;
const STILL: Duration = Duration::from_secs(3);

/// Samples written when it continues.
const AFTERWARDS: u64 = 100;

#[test]
fn a_stopped_reader_that_may_not_block_never_holds_up_a_writer() {
    let claimed = claim();
    let network = claimed.network();
    let participant = DomainParticipantBuilder::new(network.domain)
        .with_only_networks([Ipv4Addr::LOCALHOST])
        .reader_may_block(|_| false)
        .build()
        .unwrap();
    let qos = QosPolicyBuilder::new()
        .reliability(Reliability::Reliable { max_blocking_time: rustdds::Duration::from_millis(20) })
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth: 64 })
        .resource_limits(ResourceLimits {
            max_samples: WINDOW,
            max_instances: 1,
            max_samples_per_instance: WINDOW,
        })
        .build();
    let name = format!("rt/{}", topics::STRAIN_RATE.name);
    let info = topics::STRAIN_RATE.info;
    let topic = participant
        .create_topic(name, format!("{}::msg::dds_::{}_", info.package, info.name), &qos, TopicKind::NoKey)
        .unwrap();
    let publisher = participant.create_publisher(&qos).unwrap();
    let writer = publisher.create_datawriter_no_key_cdr::<StrainRate>(&topic, Some(qos)).unwrap();

    let reader = Role::start("our_listener", network);
    let status = participant.status_listener();
    let start = Instant::now();
    while !matches!(status.try_recv_status(), Some(Event::RemoteReaderMatched { .. })) {
        assert!(start.elapsed() < PATIENCE, "no reader");
        std::thread::sleep(Duration::from_millis(1));
    }
    // This match is seen by the writer; that seen by the reader follows.
    std::thread::sleep(Duration::from_secs(1));
    writer.write(StrainRate::default(), None).unwrap();
    std::thread::sleep(Duration::from_millis(200));

    reader.signal(libc::SIGSTOP);
    let begin = Instant::now();
    for sequence in 1..=SAMPLES {
        let rate = StrainRate { sequence, ..StrainRate::default() };
        writer.write(rate, None).expect("the writer does not wait for a bystander");
        let due = STILL.mul_f64(sequence as f64 / SAMPLES as f64);
        std::thread::sleep(due.saturating_sub(begin.elapsed()));
    }
    let all_acked = writer.wait_for_acknowledgments(Duration::from_millis(10)).unwrap();
    assert!(all_acked, "nor does one who waits for acknowledgments");

    reader.signal(libc::SIGCONT);
    for sequence in 1..=AFTERWARDS {
        std::thread::sleep(Duration::from_millis(20));
        let rate = StrainRate { sequence: SAMPLES + sequence, ..StrainRate::default() };
        writer.write(rate, None).unwrap();
    }
    // The listener ends when no sample arrives for a while.
    let (code, out, err) = reader.end();
    assert_eq!(code, Some(0), "{err}");
    let count = |what: &str| -> u64 {
        let rest = out.split(what).nth(1).unwrap_or_else(|| panic!("no {what}in {out}"));
        rest.split_whitespace().next().unwrap().parse().unwrap()
    };
    assert!(count("received ") >= AFTERWARDS, "what comes after is received: {out}");
    assert!(count("missing ") > 0, "what is gone is not sent: {out}");
}
