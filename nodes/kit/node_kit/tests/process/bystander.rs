//! A reader that is not waited for, stopped while a writer publishes far beyond its window.

use super::{Role, claim};
use grainlab_msgs::msg::StrainRate;
use grainlab_msgs::topics;
use grainlab_node_kit::{Bus, DdsBus, Identity, Names, Publisher, RunId};
use std::time::{Duration, Instant};

/// Samples written while the reader is stopped, and the minimum duration. More than a writer keeps unacknowledged.
const SAMPLES: u64 = 60_000;
const STILL: Duration = Duration::from_secs(3);

/// Samples written when it continues.
const AFTERWARDS: u64 = 100;

#[test]
fn a_stopped_reader_outside_the_run_never_holds_up_a_writer() {
    let claimed = claim();
    let network = claimed.network();
    let identity = Identity::member_of(RunId::fresh(), 1);
    let mut bus = DdsBus::join(network, Names::new("writer").unwrap(), identity).unwrap();
    let writer = Publisher::<StrainRate>::advertise(&mut bus, &topics::STRAIN_RATE).unwrap();

    let reader = Role::start("our_listener", network);
    // A reader outside the run is not reported to a node; that it was matched shows in what it receives.
    std::thread::sleep(Duration::from_secs(2));
    writer.publish(&mut bus, &StrainRate::default()).unwrap();
    std::thread::sleep(Duration::from_millis(200));

    reader.signal(libc::SIGSTOP);
    let begin = Instant::now();
    for sequence in 1..=SAMPLES {
        let rate = StrainRate { sequence, ..StrainRate::default() };
        writer.publish(&mut bus, &rate).expect("the writer does not wait for a bystander");
        let due = STILL.mul_f64(sequence as f64 / SAMPLES as f64);
        std::thread::sleep(due.saturating_sub(begin.elapsed()));
    }
    assert!(bus.flush(Duration::from_millis(10)), "nor does one who waits for acknowledgements");

    reader.signal(libc::SIGCONT);
    for sequence in 1..=AFTERWARDS {
        std::thread::sleep(Duration::from_millis(20));
        let rate = StrainRate { sequence: SAMPLES + sequence, ..StrainRate::default() };
        writer.publish(&mut bus, &rate).unwrap();
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
