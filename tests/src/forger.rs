//! A process outside the run that publishes forged messages on its topics: a second servo, an analyzer with
//! other results, an old latched result.

use grainlab_msgs::msg::{Microstructure, Packing, PackingReport, RunState, StrainRate, Stress};
use grainlab_msgs::{Message, Topic, from_cdr, topics};
use grainlab_node_kit::{Bus, DdsBus, Demand, Names, Network, Publisher, Sample, SubscriptionId};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// The kind of forgery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Forgery {
    /// Every request is answered by another law; the answer refers to the request like that of a servo.
    SecondServo,
    /// Every request is published again with other stress.
    Stress,
    /// Every packing is published again with other forces.
    Packing,
    /// Stiffnesses are doubled.
    Report,
    /// Coordination numbers of nine.
    Microstructure,
    /// A run state: finished.
    Finished,
    /// A run state: failed.
    Failed,
    /// Answers without a request, before the first one: all zero.
    EarlyAnswer,
    /// A latched microstructure of a packing that the run has later.
    OldMicrostructure {
        /// Step of that packing.
        step: u64,
    },
}

/// All of them except the last.
pub const FORGERIES: [Forgery; 8] = [
    Forgery::SecondServo,
    Forgery::Stress,
    Forgery::Packing,
    Forgery::Report,
    Forgery::Microstructure,
    Forgery::Finished,
    Forgery::Failed,
    Forgery::EarlyAnswer,
];

/// A forger, on a thread with its own participant; it leaves when it is dropped.
#[derive(Debug)]
pub struct Forger {
    stop: Arc<AtomicBool>,
    sent: Arc<AtomicU64>,
    thread: Option<JoinHandle<()>>,
}

impl Forger {
    /// Starts the forger in this domain on loopback.
    pub fn start(domain: u16, forgery: Forgery) -> Self {
        let (stop, sent) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
        let (asked, count) = (Arc::clone(&stop), Arc::clone(&sent));
        let thread = std::thread::spawn(move || {
            let names = Names::new("forger").unwrap_or_else(|e| panic!("{e}"));
            let mut bus =
                DdsBus::open(Network::localhost(domain), names).unwrap_or_else(|e| panic!("no bus: {e}"));
            forge(&mut bus, forgery, &asked, &count);
        });
        Self { stop, sent, thread: Some(thread) }
    }

    /// Number of messages forged so far.
    pub fn sent(&self) -> u64 {
        self.sent.load(Ordering::Relaxed)
    }
}

impl Drop for Forger {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            assert!(thread.join().is_ok(), "the forger panicked");
        }
    }
}

fn decoded<T: Message>(sample: &Sample) -> T {
    from_cdr(&sample.body).unwrap_or_else(|e| panic!("a message of the run: {e}"))
}

fn forge(bus: &mut DdsBus, forgery: Forgery, stop: &AtomicBool, sent: &AtomicU64) {
    let (from, to) = match forgery {
        Forgery::SecondServo => (topics::STRESS, topics::STRAIN_RATE),
        Forgery::Stress => (topics::STRESS, topics::STRESS),
        Forgery::Packing => (topics::PACKING, topics::PACKING),
        Forgery::Report => (topics::PACKING_REPORT, topics::PACKING_REPORT),
        Forgery::Microstructure => (topics::MICROSTRUCTURE, topics::MICROSTRUCTURE),
        Forgery::Finished | Forgery::Failed => (topics::STRESS, topics::RUN_STATE),
        Forgery::EarlyAnswer => (topics::STRESS, topics::STRAIN_RATE),
        Forgery::OldMicrostructure { .. } => (topics::MICROSTRUCTURE, topics::MICROSTRUCTURE),
    };
    let input = subscribe(bus, &from);
    let output = bus.advertise(&to).unwrap_or_else(|e| panic!("{e}"));
    let typed: Publisher<StrainRate> =
        Publisher::advertise(bus, &topics::STRAIN_RATE).unwrap_or_else(|e| panic!("{e}"));
    let count = || sent.fetch_add(1, Ordering::Relaxed);
    if let Forgery::OldMicrostructure { step } = forgery {
        let old = Microstructure {
            source_step: step,
            source: "packing_report".into(),
            ..Microstructure::default()
        };
        bus.publish(output, &grainlab_msgs::to_cdr(&old)).unwrap_or_else(|e| panic!("{e}"));
        count();
    }
    let own = bus.participant();
    while !stop.load(Ordering::Relaxed) {
        if forgery == Forgery::EarlyAnswer {
            // The rate is limited: flooding is a different fault.
            let _ = typed.publish(bus, &StrainRate::default());
            count();
        }
        while let Ok(Some(sample)) = bus.take(input) {
            if sample.info.writer.participant() == own {
                continue;
            }
            if let Some((body, about)) = forged(forgery, &sample) {
                let _ = bus.publish_about(output, &body, about);
                count();
            }
        }
        bus.wait(Duration::from_millis(20));
    }
}

fn subscribe(bus: &mut DdsBus, topic: &Topic) -> SubscriptionId {
    bus.subscribe(topic, Demand::best_effort(1000)).unwrap_or_else(|e| panic!("{e}"))
}

/// A message that differs from this one, and the sample that it refers to.
fn forged(forgery: Forgery, sample: &Sample) -> Option<(Vec<u8>, Option<grainlab_node_kit::SampleId>)> {
    let info = &sample.info;
    let body = match forgery {
        Forgery::SecondServo => {
            let stress: Stress = decoded(sample);
            let mut answer = grainlab_servo_controller::answer(&stress).ok()?;
            answer.rate.iter_mut().for_each(|rate| *rate *= 0.5);
            return Some((grainlab_msgs::to_cdr(&answer), Some(info.id())));
        }
        Forgery::Stress => {
            let mut stress: Stress = decoded(sample);
            stress.stress.zz *= 1.5;
            grainlab_msgs::to_cdr(&stress)
        }
        Forgery::Packing => {
            let mut packing: Packing = decoded(sample);
            packing.contact_normal_force.iter_mut().for_each(|f| *f *= 1.5);
            grainlab_msgs::to_cdr(&packing)
        }
        Forgery::Report => {
            let mut report: PackingReport = decoded(sample);
            report.stiffness.iter_mut().flat_map(|s| &mut s.stiffness).for_each(|value| *value *= 2.0);
            grainlab_msgs::to_cdr(&report)
        }
        Forgery::Microstructure => {
            let mut found: Microstructure = decoded(sample);
            found.estimates.iter_mut().for_each(|e| e.k = vec![9.0]);
            grainlab_msgs::to_cdr(&found)
        }
        Forgery::Finished | Forgery::Failed => {
            let state = if forgery == Forgery::Finished { RunState::FINISHED } else { RunState::FAILED };
            grainlab_msgs::to_cdr(&RunState { state, message: "forged".into(), ..RunState::default() })
        }
        Forgery::EarlyAnswer | Forgery::OldMicrostructure { .. } => return None,
    };
    Some((body, info.about))
}
