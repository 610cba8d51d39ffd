//! Messages of the Foxglove WebSocket protocol, as text and bytes.

use serde::Deserialize;
use serde_json::{Value, json};

/// Subprotocols that a client may ask for, the best one first: all have the messages used here.
pub(crate) const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

/// First byte of a message with data of a channel.
const MESSAGE_DATA: u8 = 1;

/// Severity of a status.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Level {
    Warning = 1,
    Error = 2,
}

/// A message from a client.
#[derive(Debug, Deserialize)]
#[serde(tag = "op", rename_all = "camelCase", rename_all_fields = "camelCase")]
pub(crate) enum Asked {
    Subscribe {
        subscriptions: Vec<Subscription>,
    },
    Unsubscribe {
        subscription_ids: Vec<u32>,
    },
    /// Parameters, services and others, which are not offered.
    #[serde(other)]
    Other,
}

/// A client's own number for the messages of a channel.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Subscription {
    pub(crate) id: u32,
    pub(crate) channel_id: u64,
}

/// The first message to a client.
pub(crate) fn server_info(session: u128) -> String {
    json!({"op": "serverInfo", "name": "grainlab", "capabilities": [], "sessionId": session.to_string()})
        .to_string()
}

/// A channel with messages in CDR, as clients are told of it.
pub(crate) fn channel(id: u64, topic: &str, type_name: &str, definition: &str) -> Value {
    json!({
        "id": id, "topic": topic, "encoding": "cdr",
        "schemaName": type_name, "schemaEncoding": "ros2msg", "schema": definition,
    })
}

pub(crate) fn advertise<'a>(channels: impl Iterator<Item = &'a Value>) -> String {
    json!({"op": "advertise", "channels": channels.collect::<Vec<_>>()}).to_string()
}

pub(crate) fn unadvertise(channel: u64) -> String {
    json!({"op": "unadvertise", "channelIds": [channel]}).to_string()
}

pub(crate) fn status(level: Level, message: &str) -> String {
    json!({"op": "status", "level": level as u8, "message": message}).to_string()
}

/// A message of a channel, with its time in nanoseconds.
pub(crate) fn data(subscription: u32, time: u64, body: &[u8]) -> Vec<u8> {
    [&[MESSAGE_DATA][..], &subscription.to_le_bytes(), &time.to_le_bytes(), body].concat()
}
