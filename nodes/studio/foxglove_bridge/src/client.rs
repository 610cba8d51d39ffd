//! One client: its subscriptions, and its queue.

use crate::protocol::{self, Level, Subscription};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use tokio::sync::Notify;
use tokio_tungstenite::tungstenite::Message;

/// Messages queued for a client. When a client does not read, the oldest ones are dropped.
const BACKLOG: usize = 256;

/// Texts queued for a client, none of which may be dropped.
const TEXTS: usize = 1024;

/// An entry of the queue. Clients share the bytes of a message.
enum Queued {
    Text(String),
    Data { subscription: u32, time: u64, body: Arc<[u8]> },
}

/// A connected client.
#[derive(Default)]
pub(crate) struct Client {
    /// The subscription to each channel.
    subscriptions: BTreeMap<u64, u32>,
    queue: VecDeque<Queued>,
    /// Called when the queue has an entry.
    pub(crate) ready: Arc<Notify>,
    /// Called when the connection has to end.
    pub(crate) gone: Arc<Notify>,
}

impl Client {
    /// Queues a text; false if the client left so many unread that it cannot follow any longer.
    #[must_use]
    pub(crate) fn tell(&mut self, text: String) -> bool {
        self.queue.push_back(Queued::Text(text));
        self.ready.notify_one();
        self.queue.iter().filter(|queued| matches!(queued, Queued::Text(_))).count() <= TEXTS
    }

    /// Queues a message of a channel, if the client subscribes to it.
    pub(crate) fn offer(&mut self, channel: u64, time: u64, body: &Arc<[u8]>) {
        let Some(&subscription) = self.subscriptions.get(&channel) else { return };
        let is_data = |queued: &Queued| matches!(queued, Queued::Data { .. });
        if self.queue.iter().filter(|queued| is_data(queued)).count() >= BACKLOG
            && let Some(oldest) = self.queue.iter().position(is_data)
        {
            self.queue.remove(oldest);
        }
        self.queue.push_back(Queued::Data { subscription, time, body: Arc::clone(body) });
        self.ready.notify_one();
    }

    /// The oldest entry of the queue, in the form of the protocol.
    pub(crate) fn next(&mut self) -> Option<Message> {
        Some(match self.queue.pop_front()? {
            Queued::Text(text) => text.into(),
            Queued::Data { subscription, time, body } => protocol::data(subscription, time, &body).into(),
        })
    }

    pub(crate) fn has(&self, channel: u64) -> bool {
        self.subscriptions.contains_key(&channel)
    }

    /// Begins a subscription to a channel that exists; the fault, if there is one.
    pub(crate) fn subscribe(&mut self, Subscription { id, channel_id }: Subscription) -> Result<(), String> {
        if self.has(channel_id) {
            return Err(protocol::status(
                Level::Warning,
                &format!("channel {channel_id} is already subscribed to"),
            ));
        }
        if self.subscriptions.values().any(|used| *used == id) {
            return Err(protocol::status(Level::Error, &format!("subscription {id} is already in use")));
        }
        self.subscriptions.insert(channel_id, id);
        Ok(())
    }

    /// Ends a subscription, and drops its messages. False: there is no such subscription.
    pub(crate) fn unsubscribe(&mut self, id: u32) -> bool {
        let before = self.subscriptions.len();
        self.subscriptions.retain(|_, used| *used != id);
        self.queue.retain(|q| !matches!(q, Queued::Data { subscription, .. } if *subscription == id));
        self.subscriptions.len() < before
    }

    /// Ends the subscription to a channel that is gone.
    pub(crate) fn forget(&mut self, channel: u64) {
        if let Some(&id) = self.subscriptions.get(&channel) {
            self.unsubscribe(id);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subscribed() -> Client {
        let mut client = Client::default();
        client.subscribe(Subscription { id: 7, channel_id: 1 }).unwrap();
        client
    }

    #[test]
    fn a_client_that_does_not_read_loses_the_oldest_messages_and_no_text() {
        let mut client = subscribed();
        client.offer(1, 0, &[9][..].into());
        assert!(client.tell("text".to_owned()));
        (1..=BACKLOG as u64).for_each(|time| client.offer(1, time, &[9][..].into()));
        client.offer(2, 0, &[9][..].into());
        assert_eq!(client.next(), Some("text".into()));
        let rest: Vec<Message> = std::iter::from_fn(|| client.next()).collect();
        assert_eq!(rest.len(), BACKLOG, "of the channel that it subscribes to");
        assert_eq!(rest[0].clone().into_data(), [&[1, 7, 0, 0, 0, 1][..], &[0; 7], &[9]].concat());
    }

    #[test]
    fn texts_are_bounded_too() {
        let mut client = Client::default();
        assert!((0..TEXTS).all(|_| client.tell(String::new())));
        assert!(!client.tell(String::new()));
    }

    #[test]
    fn a_subscription_that_ended_leaves_no_message_and_its_number_is_free() {
        let mut client = subscribed();
        assert!(client.subscribe(Subscription { id: 8, channel_id: 1 }).unwrap_err().contains("channel 1"));
        assert!(
            client.subscribe(Subscription { id: 7, channel_id: 2 }).unwrap_err().contains("subscription 7")
        );
        client.offer(1, 0, &[9][..].into());
        assert!(client.unsubscribe(7) && !client.unsubscribe(7));
        assert!(client.next().is_none() && !client.has(1));
        client.subscribe(Subscription { id: 7, channel_id: 2 }).unwrap();
        client.forget(2);
        assert!(!client.has(2));
    }
}
