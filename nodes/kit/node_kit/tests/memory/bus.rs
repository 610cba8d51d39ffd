//! The bus in memory has the semantics of the DDS bus, with seeded faults.

use crate::{MS, bus_of};
use grainlab_msgs::msg::{RunState, StrainRate, Stress};
use grainlab_msgs::topics;
use grainlab_node_kit::{
    Actor, Bus, Demand, Exit, Faults, Graph, Hub, MemoryBus, Next, Node, NodeError, Publisher, Statistics,
    Subscription, Wake, Worker, run_until,
};
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

fn rate(sequence: u64) -> StrainRate {
    StrainRate { sequence, ..StrainRate::default() }
}

/// Publishes 1, 2, … `last`.
fn publish_all(publisher: &Publisher<StrainRate>, bus: &mut MemoryBus, last: u64) {
    for n in 1..=last {
        assert_eq!(publisher.publish(bus, &rate(n)).unwrap(), n as i64);
    }
}

fn take_all(subscription: &Subscription<StrainRate>, bus: &mut MemoryBus) -> Vec<(u64, i64)> {
    std::iter::from_fn(|| subscription.take_valid(bus).unwrap())
        .map(|(m, info)| (m.sequence, info.sequence))
        .collect()
}

#[test]
fn samples_arrive_in_order_with_sequence_numbers_per_writer() {
    let hub = Hub::new(1);
    let (mut a, mut b, mut c) = (bus_of(&hub, "a"), bus_of(&hub, "b"), bus_of(&hub, "c"));
    let from_a = Publisher::advertise(&mut a, &topics::STRAIN_RATE).unwrap();
    let from_b = Publisher::advertise(&mut b, &topics::STRAIN_RATE).unwrap();
    let at_c = Subscription::subscribe(&mut c, &topics::STRAIN_RATE, Demand::reliable(100)).unwrap();
    from_a.publish(&mut a, &rate(10)).unwrap();
    from_b.publish(&mut b, &rate(20)).unwrap();
    from_a.publish(&mut a, &rate(11)).unwrap();
    assert_eq!(take_all(&at_c, &mut c), [(10, 1), (20, 1), (11, 2)]);
    assert_eq!((a.readers(from_a.id()), c.writers(at_c.id())), (1, 2));
    assert_eq!(a.foreign_writers(&topics::STRAIN_RATE), [b.published()[0].writer]);
    drop(b);
    assert_eq!(c.writers(at_c.id()), 1, "a dropped bus leaves");
}

#[test]
fn only_reliable_late_joiners_get_the_latched_samples_and_only_the_depth_of_them() {
    let hub = Hub::new(1);
    let mut a = bus_of(&hub, "a");
    let publisher = Publisher::<RunState>::advertise(&mut a, &topics::RUN_STATE).unwrap();
    for step in 1..=3 {
        publisher.publish(&mut a, &RunState { step, ..RunState::default() }).unwrap();
    }
    for (demand, expected) in [(Demand::reliable(10), Some(3)), (Demand::best_effort(10), None)] {
        let mut b = bus_of(&hub, "b");
        let late = Subscription::<RunState>::subscribe(&mut b, &topics::RUN_STATE, demand).unwrap();
        assert_eq!(late.take_valid(&mut b).unwrap().map(|(m, _)| m.step), expected);
        assert!(late.take_valid(&mut b).unwrap().is_none());
    }
}

#[test]
fn keep_last_drops_the_oldest_and_leaves_a_gap_in_the_sequence() {
    let hub = Hub::new(1);
    let (mut a, mut b) = (bus_of(&hub, "a"), bus_of(&hub, "b"));
    let publisher = Publisher::advertise(&mut a, &topics::STRAIN_RATE).unwrap();
    let subscription = Subscription::subscribe(&mut b, &topics::STRAIN_RATE, Demand::reliable(2)).unwrap();
    publish_all(&publisher, &mut a, 5);
    assert_eq!(take_all(&subscription, &mut b), [(4, 4), (5, 5)]);
}

#[test]
fn faults_follow_the_seed_and_spare_reliable_readers_everything_but_delay() {
    let outcome = |seed| {
        let hub = Hub::new(seed);
        hub.set_faults("/lab/strain_rate", Faults { drop: 0.3, duplicate: 0.3, delay: 10 * MS });
        let (mut a, mut b, mut c) = (bus_of(&hub, "a"), bus_of(&hub, "b"), bus_of(&hub, "c"));
        let publisher = Publisher::advertise(&mut a, &topics::STRAIN_RATE).unwrap();
        let lossy = Subscription::subscribe(&mut b, &topics::STRAIN_RATE, Demand::best_effort(1000)).unwrap();
        let safe = Subscription::subscribe(&mut c, &topics::STRAIN_RATE, Demand::reliable(1000)).unwrap();
        publish_all(&publisher, &mut a, 200);
        assert!(take_all(&safe, &mut c).len() < 200, "some are still on their way");
        hub.advance(20 * MS);
        (take_all(&lossy, &mut b), take_all(&safe, &mut c))
    };
    let (lossy, safe) = outcome(7);
    assert_eq!(outcome(7), (lossy.clone(), safe.clone()), "the same seed, the same faults");
    assert_ne!(outcome(8).0, lossy);
    let numbers: Vec<u64> = safe.iter().map(|(n, _)| *n).collect();
    assert!(numbers.is_sorted() && numbers.last() == Some(&200));
    let distinct: std::collections::BTreeSet<u64> = lossy.iter().map(|(n, _)| *n).collect();
    // 200 samples, 30 % lost: 140 ± 6.5 (binomial); 5 sigma.
    assert!((108..=172).contains(&distinct.len()), "{}", distinct.len());
    assert!(lossy.len() > distinct.len(), "some came twice");
    assert!(!lossy.is_sorted(), "some overtook others");
}

#[test]
fn waiting_passes_virtual_time_to_the_next_arrival_or_the_timeout() {
    let hub = Hub::new(3);
    hub.set_faults("/lab/strain_rate", Faults { delay: 8 * MS, ..Faults::default() });
    let (mut a, mut b) = (bus_of(&hub, "a"), bus_of(&hub, "b"));
    let publisher = Publisher::advertise(&mut a, &topics::STRAIN_RATE).unwrap();
    let subscription =
        Subscription::<StrainRate>::subscribe(&mut b, &topics::STRAIN_RATE, Demand::reliable(9)).unwrap();
    assert_eq!(b.wait(5 * MS), Wake::Timeout);
    assert_eq!(hub.now(), 5 * MS);
    publisher.publish(&mut a, &rate(1)).unwrap();
    assert_eq!(b.wait(Duration::from_secs(1)), Wake::Data);
    assert!(hub.now() < 14 * MS);
    assert!(subscription.take_valid(&mut b).unwrap().is_some());
    b.interrupt();
    assert_eq!(b.wait(MS), Wake::Shutdown);
    assert_eq!(b.wait(MS), Wake::Timeout, "a signal is reported once");
}

/// Sends requests and repeats them, like the simulator.
struct Asker {
    publisher: Publisher<Stress>,
    subscription: Subscription<StrainRate>,
    sequence: u64,
    last: u64,
    answers: Rc<RefCell<Vec<u64>>>,
}

impl Node for Asker {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        while let Some((rate, _)) = self.subscription.take_valid(bus)? {
            if rate.sequence == self.sequence {
                self.answers.borrow_mut().push(rate.sequence);
                self.sequence += 1;
            }
        }
        if self.sequence > self.last {
            return Ok(Next::Finished(Exit::Done));
        }
        self.publisher.publish(bus, &Stress { sequence: self.sequence, ..Stress::default() })?;
        Ok(Next::Wait(20 * MS))
    }
}

/// Answers each request, like the servo.
struct Answerer {
    publisher: Publisher<StrainRate>,
    subscription: Subscription<Stress>,
}

impl Node for Answerer {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        while let Some((stress, _)) = self.subscription.take_valid(bus)? {
            self.publisher.publish(bus, &rate(stress.sequence))?;
        }
        Ok(Next::Wait(Duration::from_secs(1)))
    }
}

#[test]
fn a_lockstep_that_repeats_survives_any_loss_and_the_scheduler_is_deterministic() {
    let run = |seed| {
        let hub = Hub::new(seed);
        for topic in ["/lab/stress", "/lab/strain_rate"] {
            hub.set_faults(topic, Faults { drop: 0.4, duplicate: 0.2, delay: 5 * MS });
        }
        let (mut a, mut b) = (bus_of(&hub, "sim"), bus_of(&hub, "servo"));
        let answers = Rc::default();
        let asker = Asker {
            publisher: Publisher::advertise(&mut a, &topics::STRESS).unwrap(),
            subscription: Subscription::subscribe(&mut a, &topics::STRAIN_RATE, Demand::best_effort(64))
                .unwrap(),
            sequence: 1,
            last: 100,
            answers: Rc::clone(&answers),
        };
        let answerer = Answerer {
            publisher: Publisher::advertise(&mut b, &topics::STRAIN_RATE).unwrap(),
            subscription: Subscription::subscribe(&mut b, &topics::STRESS, Demand::best_effort(64)).unwrap(),
        };
        let mut actors = [Actor::new(Box::new(asker), a), Actor::new(Box::new(answerer), b)];
        let done = run_until(&hub, &mut actors, Duration::from_secs(60), |actors| actors[0].ended.is_some());
        let asked = actors[0].bus.published()[0].count;
        assert!(done && matches!(actors[0].ended.as_ref(), Some(Ok(Exit::Done))));
        (answers.take(), asked, hub.now())
    };
    let (answers, asked, took) = run(11);
    assert_eq!(answers, (1..=100).collect::<Vec<u64>>());
    assert!(asked > 100, "losses were repeated");
    assert_eq!(run(11), (answers, asked, took));
}

#[test]
fn on_the_bus_in_memory_a_job_is_done_as_soon_as_it_is_given() {
    let mut total = 0;
    let mut worker = Worker::new(&bus_of(&Hub::new(1), "worker"), "sum", move |job: u64| {
        total += job;
        total
    })
    .unwrap();
    for (job, sum) in [(2, 2), (5, 7)] {
        assert!(!worker.is_busy() && worker.result().is_none());
        worker.give(job);
        assert!(worker.is_busy());
        assert_eq!(worker.result(), Some(sum));
    }
}
