//! Pictures of the packings of a topic, made while a client wants them.

use crate::server::{Channel, Request, Server};
use grainlab_pictures::{Drawn, Picture, packing};

/// The channels beside a topic with packings.
pub(crate) struct Pictures(Vec<(Picture, Channel)>);

impl Pictures {
    /// Advertises those that no process on the bus publishes.
    pub(crate) fn advertise(server: &Server, packings: &str, published: impl Fn(&str) -> bool) -> Self {
        let missing = Picture::ALL.into_iter().filter(|p| !published(&p.beside(packings)));
        let channel = |picture: Picture| {
            let info = &picture.topic().info;
            (picture, server.channel(&picture.beside(packings), info.type_name, info.definition))
        };
        Self(missing.map(channel).collect())
    }

    /// True if a client wants one.
    pub(crate) fn wanted(&self) -> bool {
        self.0.iter().any(|(_, channel)| channel.is_wanted())
    }

    /// True if one of them has this channel.
    pub(crate) fn has(&self, id: u64) -> bool {
        self.0.iter().any(|(_, channel)| channel.id() == id)
    }

    /// Sends the pictures of a packing to the clients that want them, or one of them to one client.
    pub(crate) fn send(&self, body: &[u8], time: u64, only: Option<Request>) {
        let due = |channel: &Channel| match only {
            Some(request) => channel.id() == request.channel,
            None => channel.is_wanted(),
        };
        let due: Vec<_> = self.0.iter().filter(|(_, channel)| due(channel)).collect();
        if due.is_empty() {
            return;
        }
        match packing(body) {
            Ok(packing) => {
                let drawn = Drawn::new(&packing);
                for (picture, channel) in due {
                    channel.send(&picture.encoded(&drawn), time, only.map(|request| request.client));
                }
            }
            Err(error) => log::error!("no picture of a packing: {error}"),
        }
    }
}
