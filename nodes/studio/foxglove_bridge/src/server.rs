//! The WebSocket server, and what its clients ask for.

use crate::client::Client;
use crate::protocol::{self, Asked, Level, SUBPROTOCOLS};
use futures::{SinkExt, StreamExt};
use grainlab_node_kit::Caller;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::{Builder, Runtime};
use tokio::sync::Notify;
use tokio_tungstenite::accept_hdr_async_with_config;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::handshake::server as handshake;
use tokio_tungstenite::tungstenite::http::{HeaderValue, StatusCode, header::SEC_WEBSOCKET_PROTOCOL};
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;

/// Longest message from a client, bytes.
const REQUEST: usize = 1 << 20;

/// Time in which a client has to open its connection.
const HANDSHAKE: Duration = Duration::from_secs(10);

/// Time after which the next connection is accepted, if the system refused one.
const REFUSED: Duration = Duration::from_millis(100);

/// A client that subscribed to a channel since the last call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Request {
    pub(crate) channel: u64,
    pub(crate) client: u64,
}

/// Channels and clients, by their numbers.
#[derive(Default)]
struct Registry {
    channels: BTreeMap<u64, Value>,
    clients: BTreeMap<u64, Client>,
    requests: BTreeSet<Request>,
    last: u64,
}

impl Registry {
    fn number(&mut self) -> u64 {
        self.last += 1;
        self.last
    }

    /// Tells a client. One that left too much unread is let go.
    fn tell(&mut self, id: u64, text: String) {
        if let Some(client) = self.clients.get_mut(&id)
            && !client.tell(text)
        {
            client.gone.notify_one();
            self.clients.remove(&id);
        }
    }

    fn tell_all(&mut self, text: &str) {
        for id in self.clients.keys().copied().collect::<Vec<_>>() {
            self.tell(id, text.to_owned());
        }
    }

    fn subscribe(&mut self, id: u64, asked: Vec<protocol::Subscription>) {
        for subscription in asked {
            let channel = subscription.channel_id;
            let Some(client) = self.clients.get_mut(&id) else { return };
            if !self.channels.contains_key(&channel) {
                self.tell(id, protocol::status(Level::Error, &format!("there is no channel {channel}")));
            } else if let Err(fault) = client.subscribe(subscription) {
                self.tell(id, fault);
            } else {
                self.requests.insert(Request { channel, client: id });
            }
        }
    }

    fn unsubscribe(&mut self, id: u64, ended: Vec<u32>) {
        for subscription in ended {
            if self.clients.get_mut(&id).is_some_and(|client| !client.unsubscribe(subscription)) {
                let text = format!("there is no subscription {subscription}");
                self.tell(id, protocol::status(Level::Warning, &text));
            }
        }
    }
}

/// The state, between the node and the connections.
struct Shared {
    /// Time of the start, nanoseconds: tells a client that connects again that the numbers are new.
    session: u128,
    state: Mutex<Registry>,
    caller: Option<Caller>,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, Registry> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wake(&self) {
        if let Some(caller) = &self.caller {
            caller.call();
        }
    }

    /// Adds a client that is connected, and tells it what there is.
    fn join(&self) -> (u64, Arc<Notify>, Arc<Notify>) {
        let mut state = self.state();
        let id = state.number();
        let client = Client::default();
        let signals = (Arc::clone(&client.ready), Arc::clone(&client.gone));
        state.clients.insert(id, client);
        state.tell(id, protocol::server_info(self.session));
        let channels = protocol::advertise(state.channels.values());
        state.tell(id, channels);
        (id, signals.0, signals.1)
    }

    fn leave(&self, id: u64) {
        self.state().clients.remove(&id);
        self.wake();
    }

    /// Does what a client asked for, or tells it why not.
    fn answer(&self, id: u64, message: &Message) {
        let asked = match message {
            Message::Text(text) => {
                serde_json::from_str(text).map_err(|e| format!("no message of the protocol: {e}"))
            }
            Message::Binary(_) => Err("nothing can be published here".to_owned()),
            _ => return,
        };
        let mut state = self.state();
        match asked {
            Ok(Asked::Subscribe { subscriptions }) => state.subscribe(id, subscriptions),
            Ok(Asked::Unsubscribe { subscription_ids }) => state.unsubscribe(id, subscription_ids),
            Ok(Asked::Other) => {
                state.tell(id, protocol::status(Level::Warning, "only subscriptions are offered here"));
            }
            Err(fault) => state.tell(id, protocol::status(Level::Error, &fault)),
        }
        drop(state);
        self.wake();
    }

    async fn connection(self: Arc<Self>, stream: TcpStream) {
        let limits = WebSocketConfig::default().max_message_size(Some(REQUEST)).max_frame_size(Some(REQUEST));
        let opened = accept_hdr_async_with_config(stream, negotiated, Some(limits));
        let Ok(Ok(socket)) = tokio::time::timeout(HANDSHAKE, opened).await else { return };
        let (id, ready, gone) = self.join();
        let (mut sink, mut source) = socket.split();
        let sending = async {
            loop {
                let next = self.state().clients.get_mut(&id).and_then(Client::next);
                let Some(message) = next else {
                    ready.notified().await;
                    continue;
                };
                if sink.send(message).await.is_err() {
                    break;
                }
            }
        };
        // An error ends the connection: after a fault in a frame nothing tells where the next one begins.
        let receiving = async {
            while let Some(Ok(message)) = source.next().await {
                self.answer(id, &message);
            }
        };
        tokio::select! {
            () = sending => {}
            () = receiving => {}
            () = gone.notified() => {}
        }
        self.leave(id);
    }
}

/// Chooses a subprotocol that the client offers.
#[expect(clippy::result_large_err, reason = "the signature is that of the library")]
fn negotiated(
    request: &handshake::Request,
    mut response: handshake::Response,
) -> Result<handshake::Response, handshake::ErrorResponse> {
    let offered = request.headers().get_all(SEC_WEBSOCKET_PROTOCOL).iter().filter_map(|h| h.to_str().ok());
    let offered: Vec<&str> = offered.flat_map(|header| header.split(',')).map(str::trim).collect();
    let Some(chosen) = SUBPROTOCOLS.into_iter().find(|known| offered.contains(known)) else {
        let text = format!("offer one of the subprotocols {}\n", SUBPROTOCOLS.join(", "));
        let mut refused = handshake::ErrorResponse::new(Some(text));
        *refused.status_mut() = StatusCode::BAD_REQUEST;
        return Err(refused);
    };
    response.headers_mut().insert(SEC_WEBSOCKET_PROTOCOL, HeaderValue::from_static(chosen));
    Ok(response)
}

/// A topic that clients can subscribe to, until it is dropped.
pub(crate) struct Channel {
    id: u64,
    shared: Arc<Shared>,
}

impl Channel {
    pub(crate) fn id(&self) -> u64 {
        self.id
    }

    /// True if a client subscribes to it.
    pub(crate) fn is_wanted(&self) -> bool {
        self.shared.state().clients.values().any(|client| client.has(self.id))
    }

    /// Queues a message, of this time in nanoseconds, for the clients that subscribe to it, or for one of them.
    pub(crate) fn send(&self, body: &[u8], time: u64, only: Option<u64>) {
        if !self.is_wanted() {
            return;
        }
        let body = Arc::from(body);
        for (id, client) in &mut self.shared.state().clients {
            if only.is_none_or(|only| only == *id) {
                client.offer(self.id, time, &body);
            }
        }
    }
}

impl Drop for Channel {
    fn drop(&mut self) {
        let mut state = self.shared.state();
        state.channels.remove(&self.id);
        state.clients.values_mut().for_each(|client| client.forget(self.id));
        state.tell_all(&protocol::unadvertise(self.id));
    }
}

/// The server. It ends when this is dropped.
pub(crate) struct Server {
    shared: Arc<Shared>,
    port: u16,
    runtime: Option<Runtime>,
}

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ServerError {
    /// The system cannot start a thread.
    #[error("cannot start the server: {0}")]
    Thread(#[from] std::io::Error),
    /// The port is in use, or the address is not one of this host.
    #[error("cannot listen on {address}, port {port}: {source}; choose another port with -p port:=PORT")]
    Listen { address: IpAddr, port: u16, source: std::io::Error },
}

impl Server {
    /// Listens. `caller` wakes the node when a client subscribes.
    pub(crate) fn start(address: IpAddr, port: u16, caller: Option<Caller>) -> Result<Self, ServerError> {
        let runtime =
            Builder::new_multi_thread().worker_threads(1).thread_name("websocket").enable_all().build()?;
        let session = SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default().as_nanos();
        let shared = Arc::new(Shared { session, state: Mutex::default(), caller });
        let refused = |source| ServerError::Listen { address, port, source };
        let listener = runtime.block_on(TcpListener::bind((address, port))).map_err(refused)?;
        let port = listener.local_addr().map_err(refused)?.port();
        let clients = Arc::clone(&shared);
        runtime.spawn(async move {
            loop {
                match listener.accept().await {
                    Ok((stream, _)) => drop(tokio::spawn(Arc::clone(&clients).connection(stream))),
                    Err(_) => tokio::time::sleep(REFUSED).await,
                }
            }
        });
        Ok(Self { shared, port, runtime: Some(runtime) })
    }

    /// The port that it listens on.
    pub(crate) fn port(&self) -> u16 {
        self.port
    }

    /// Number of connected clients.
    pub(crate) fn clients(&self) -> usize {
        self.shared.state().clients.len()
    }

    /// Advertises a topic with messages in CDR.
    pub(crate) fn channel(&self, topic: &str, type_name: &str, definition: &str) -> Channel {
        let mut state = self.shared.state();
        let id = state.number();
        let channel = protocol::channel(id, topic, type_name, definition);
        state.tell_all(&protocol::advertise([&channel].into_iter()));
        state.channels.insert(id, channel);
        Channel { id, shared: Arc::clone(&self.shared) }
    }

    /// The subscriptions of clients since the last call.
    pub(crate) fn requests(&self) -> BTreeSet<Request> {
        std::mem::take(&mut self.shared.state().requests)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}
