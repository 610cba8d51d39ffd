//! The exchange over the bus of this crate.

use super::exchange::{GIVE_UP, IDLE, REPEAT, WARM_UP, answer, question};
use crate::bus::Bus;
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::typed::{Publisher, Subscription};
use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::topics;
use std::time::{Duration, Instant};

/// Depth of the partner's best-effort reader.
const PARTNER: Demand = Demand::best_effort(64);

/// Makes `exchanges` exchanges and returns the duration of each in microseconds, encoding and decoding included.
/// Returns fewer if the partner leaves.
pub fn bus_ping(bus: &mut dyn Bus, exchanges: u64) -> Result<Vec<f64>, BusError> {
    let publisher = Publisher::<Stress>::advertise(bus, &topics::STRESS)?;
    let subscription = Subscription::<StrainRate>::subscribe(bus, &topics::STRAIN_RATE, PARTNER)?;
    let mut micros = Vec::with_capacity(exchanges as usize);
    for sequence in 1..=exchanges + WARM_UP {
        let start = Instant::now();
        publisher.publish(bus, &question(sequence))?;
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
                publisher.publish(bus, &question(sequence))?;
                asked = Instant::now();
            }
        }
        if sequence > WARM_UP {
            micros.push(start.elapsed().as_secs_f64() * 1e6);
        }
    }
    Ok(micros)
}

/// Answers until no request arrives for some seconds after the first one; returns the number of answers.
pub fn bus_pong(bus: &mut dyn Bus) -> Result<u64, BusError> {
    let publisher = Publisher::<StrainRate>::advertise(bus, &topics::STRAIN_RATE)?;
    let subscription = Subscription::<Stress>::subscribe(bus, &topics::STRESS, PARTNER)?;
    listen(bus, |bus| {
        let mut answers = 0;
        while let Some((stress, _)) = subscription.take_valid(bus)? {
            publisher.publish(bus, &answer(&stress))?;
            answers += 1;
        }
        Ok(answers)
    })
}

/// Reads both topics reliably, as the recorder does; returns the numbers of samples received and missing.
pub fn bus_listen(bus: &mut dyn Bus) -> Result<(u64, u64), BusError> {
    const RECORDER: Demand = Demand::reliable(20_000);
    let both = [bus.subscribe(&topics::STRESS, RECORDER)?, bus.subscribe(&topics::STRAIN_RATE, RECORDER)?];
    let (mut last, mut missing) = ([None; 2], 0);
    let received = listen(bus, |bus| {
        let mut received = 0;
        for (subscription, last) in both.iter().zip(&mut last) {
            while let Some(sample) = bus.take(*subscription)? {
                received += 1;
                let sequence = sample.info.sequence;
                missing += last.map_or(0, |last: i64| (sequence - last - 1).max(0) as u64);
                *last = Some(sequence);
            }
        }
        Ok(received)
    })?;
    Ok((received, missing))
}

/// Calls `take` whenever something arrives, until nothing does for [`IDLE`] after the first time, or for [`GIVE_UP`]
/// before it.
fn listen(
    bus: &mut dyn Bus,
    mut take: impl FnMut(&mut dyn Bus) -> Result<u64, BusError>,
) -> Result<u64, BusError> {
    let (mut total, mut heard) = (0, bus.now());
    loop {
        let taken = take(bus)?;
        if taken > 0 {
            total += taken;
            heard = bus.now();
        } else if bus.now() - heard > if total > 0 { IDLE } else { GIVE_UP } {
            return Ok(total);
        }
        bus.wait(Duration::from_secs(1));
    }
}
