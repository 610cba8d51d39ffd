//! The exchange of the lockstep alone, for measurements.
//!
//! Each function is one role of one process: the pinging side publishes a `Stress`, the answering side a `StrainRate`
//! with the same sequence. Writers are reliable, the partners read best effort and the pinging side repeats, as in the
//! real exchange.

use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::topics;
use grainlab_node_kit::{Bus, BusError, Demand, Publisher, Subscription};
use std::time::{Duration, Instant};

/// Number of exchanges before the measurement: discovery, first allocations.
const WARM_UP: u64 = 200;

/// A request without an answer after this time is repeated. Some hundred exchanges long: only a loss takes this long.
const REPEAT: Duration = Duration::from_millis(20);

/// The answering side ends if no request arrives for this long.
const IDLE: Duration = Duration::from_secs(5);

/// The requesting side ends if no answer arrives for this long, and the answering one before its first request.
const GIVE_UP: Duration = Duration::from_secs(30);

/// Depth of the partner's best-effort reader.
const PARTNER: Demand = Demand::best_effort(64);

/// Makes `exchanges` exchanges and returns the duration of each in microseconds, encoding and decoding included.
/// Returns fewer if the partner leaves.
pub fn bus_ping(bus: &mut dyn Bus, exchanges: u64) -> Result<Vec<f64>, BusError> {
    let publisher = Publisher::<Stress>::advertise(bus, &topics::STRESS)?;
    let subscription = Subscription::<StrainRate>::subscribe(bus, &topics::STRAIN_RATE, PARTNER)?;
    let mut micros = Vec::with_capacity(exchanges as usize);
    for sequence in 1..=exchanges + WARM_UP {
        let mut question = Stress { sequence, ..Stress::default() };
        question.header.frame_id = "cell".into();
        let start = Instant::now();
        publisher.publish(bus, &question)?;
        let mut asked = start;
        'answered: loop {
            while let Some((rate, _)) = subscription.take_valid(bus)? {
                if rate.sequence == sequence {
                    break 'answered;
                }
            }
            bus.wait(REPEAT.saturating_sub(asked.elapsed()));
            if asked.elapsed() >= REPEAT {
                if start.elapsed() > GIVE_UP {
                    return Ok(micros);
                }
                publisher.publish(bus, &question)?;
                asked = Instant::now();
            }
        }
        if sequence > WARM_UP {
            micros.push(start.elapsed().as_secs_f64() * 1e6);
        }
    }
    Ok(micros)
}

/// Answers until no request arrives for some seconds after the first one.
pub fn bus_pong(bus: &mut dyn Bus) -> Result<(), BusError> {
    let publisher = Publisher::<StrainRate>::advertise(bus, &topics::STRAIN_RATE)?;
    let subscription = Subscription::<Stress>::subscribe(bus, &topics::STRESS, PARTNER)?;
    let (mut patience, mut heard) = (GIVE_UP, bus.now());
    while bus.now() - heard <= patience {
        while let Some((Stress { header, sequence, .. }, _)) = subscription.take_valid(bus)? {
            publisher.publish(bus, &StrainRate { header, sequence, ..StrainRate::default() })?;
            (patience, heard) = (IDLE, bus.now());
        }
        bus.wait(Duration::from_secs(1));
    }
    Ok(())
}
