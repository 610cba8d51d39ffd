//! The exchange over ros2-client without the bus of this crate.

use super::exchange::{GIVE_UP, IDLE, REPEAT, WARM_UP, answer, question};
use crate::bus_error::BusError;
use crate::dds::Network;
use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::{Message, Topic, topics};
use mio::{Events, Interest, Poll, Token};
use ros2_client::qos::{History, WhenFull};
use ros2_client::{MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, QosProfile, Subscription};

use std::fmt::Display;
use std::time::{Duration, Instant};

fn failed(what: &str, reason: impl Display) -> BusError {
    BusError::Network { what: format!("bare ros2-client: {what}"), reason: reason.to_string() }
}

/// Both ends of one role. Fields are dropped in this order: endpoints before their node.
struct Ends<Out: serde::Serialize, In> {
    publisher: Publisher<Out>,
    subscription: Subscription<In>,
    poll: Poll,
    events: Events,
    _node: Node,
}

impl<Out: Message, In: Message> Ends<Out, In> {
    fn open(network: Network, name: &str, output: &Topic, input: &Topic) -> Result<Self, BusError> {
        let context = network.context()?;
        let name = NodeName::new("/", name).map_err(|e| failed("node name", format!("{e:?}")))?;
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let mut node = context.new_node(name, options).map_err(|e| failed("node", e))?;

        let reliable = QosProfile::publisher_default()
            .reliability_reliable(WhenFull::DEFAULT)
            .history(History::KeepLast { depth: topics::STRESS.qos.depth as usize });
        let best_effort = QosProfile::subscription_default().history(History::KeepLast { depth: 64 });
        let topic = |topic: &Topic| {
            let name = Name::new("/", topic.name).map_err(|e| failed("topic name", format!("{e:?}")))?;
            let message_type = MessageTypeName::new(topic.info.package, topic.info.name);
            node.create_topic(&name, message_type, &reliable).map_err(|e| failed(topic.name, e))
        };
        let (output, input) = (topic(output)?, topic(input)?);
        let publisher = node.create_publisher(&output, None).map_err(|e| failed("publisher", e))?;
        let mut subscription =
            node.create_subscription(&input, Some(best_effort)).map_err(|e| failed("subscription", e))?;
        let poll = Poll::new().map_err(|e| failed("poll", e))?;
        poll.registry()
            .register(&mut subscription, Token(0), Interest::READABLE)
            .map_err(|e| failed("poll", e))?;
        Ok(Self { publisher, subscription, poll, events: Events::with_capacity(8), _node: node })
    }

    fn publish(&self, message: Out) -> Result<(), BusError> {
        self.publisher.publish(message).map_err(|e| failed("publish", e))
    }

    /// The next message, if one comes within `timeout`.
    fn receive(&mut self, timeout: Duration) -> Result<Option<In>, BusError> {
        let start = Instant::now();
        loop {
            if let Some((message, _)) = self.subscription.take().map_err(|e| failed("take", e))? {
                return Ok(Some(message));
            }
            let left = timeout.saturating_sub(start.elapsed());
            if left.is_zero() {
                return Ok(None);
            }
            match self.poll.poll(&mut self.events, Some(left)) {
                Ok(()) => {}
                Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
                Err(e) => return Err(failed("poll", e)),
            }
        }
    }
}

/// [`super::bus_ping`] over bare ros2-client.
pub fn bare_ping(network: Network, exchanges: u64) -> Result<Vec<f64>, BusError> {
    let mut ends =
        Ends::<Stress, StrainRate>::open(network, "bare_ping", &topics::STRESS, &topics::STRAIN_RATE)?;
    let mut micros = Vec::with_capacity(exchanges as usize);
    for sequence in 1..=exchanges + WARM_UP {
        let start = Instant::now();
        ends.publish(question(sequence))?;
        loop {
            match ends.receive(REPEAT)? {
                Some(rate) if rate.sequence == sequence => break,
                Some(_) => {}
                None if start.elapsed() > GIVE_UP => return Ok(micros),
                None => ends.publish(question(sequence))?,
            }
        }
        if sequence > WARM_UP {
            micros.push(start.elapsed().as_secs_f64() * 1e6);
        }
    }
    Ok(micros)
}

/// [`super::bus_pong`] over bare ros2-client.
pub fn bare_pong(network: Network) -> Result<u64, BusError> {
    let mut ends =
        Ends::<StrainRate, Stress>::open(network, "bare_pong", &topics::STRAIN_RATE, &topics::STRESS)?;
    let mut answers = 0;
    while let Some(stress) = ends.receive(if answers > 0 { IDLE } else { GIVE_UP })? {
        ends.publish(answer(&stress))?;
        answers += 1;
    }
    Ok(answers)
}
