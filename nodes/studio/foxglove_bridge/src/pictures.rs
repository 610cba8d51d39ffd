//! Pictures of the packings of a topic, made while a client wants them.

use crate::server::Server;
use foxglove::{ChannelId, PartialMetadata, RawChannel, SinkId};
use grainlab_pictures::{Drawn, Picture, packing};
use std::sync::Arc;

/// The channels beside a topic with packings.
#[derive(Debug)]
pub(crate) struct Pictures(Vec<(Picture, Arc<RawChannel>)>);

impl Pictures {
    /// Advertises those that no process on the bus publishes.
    pub(crate) fn advertise(server: &Server, packings: &str, published: impl Fn(&str) -> bool) -> Self {
        let missing = Picture::ALL.into_iter().filter(|p| !published(&p.beside(packings)));
        let channel = |picture: Picture| {
            let info = &picture.topic().info;
            let channel = server.channel(&picture.beside(packings), info.type_name, info.definition)?;
            Some((picture, channel))
        };
        Self(missing.filter_map(channel).collect())
    }

    /// Whether a client wants one.
    pub(crate) fn wanted(&self) -> bool {
        self.0.iter().any(|(_, channel)| channel.has_sinks())
    }

    /// Whether one of them has this channel.
    pub(crate) fn has(&self, id: ChannelId) -> bool {
        self.0.iter().any(|(_, channel)| channel.id() == id)
    }

    /// Sends the pictures of a packing to the clients that want them, or one of them to one client.
    pub(crate) fn send(&self, body: &[u8], time: PartialMetadata, only: Option<(ChannelId, SinkId)>) {
        let due = |channel: &RawChannel| match only {
            Some((id, _)) => channel.id() == id,
            None => channel.has_sinks(),
        };
        let due: Vec<_> = self.0.iter().filter(|(_, channel)| due(channel)).collect();
        if due.is_empty() {
            return;
        }
        match packing(body) {
            Ok(packing) => {
                let drawn = Drawn::new(&packing);
                for (picture, channel) in due {
                    channel.log_with_meta_to_sink(
                        &picture.encoded(&drawn),
                        time,
                        only.map(|(_, client)| client),
                    );
                }
            }
            Err(error) => log::error!("no picture of a packing: {error}"),
        }
    }

    /// Takes them back.
    pub(crate) fn close(&self) {
        self.0.iter().for_each(|(_, channel)| channel.close());
    }
}
