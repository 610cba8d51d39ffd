//! The WebSocket server, and what its clients ask for.

use foxglove::websocket::{ChannelView, Client, ServerListener};
use foxglove::{ChannelBuilder, ChannelId, Context, FoxgloveError, RawChannel, Schema, SinkId};
use foxglove::{WebSocketServer, WebSocketServerHandle};
use grainlab_node_kit::Caller;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::runtime::{Builder, Runtime};

/// Messages queued for a client. When a client does not read, the oldest ones are dropped.
const BACKLOG: usize = 256;

/// A client that subscribed to a channel since the last call.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Request {
    pub(crate) channel: ChannelId,
    pub(crate) client: SinkId,
}

/// Collects requests, and wakes the node.
struct Requests {
    list: Mutex<Vec<Request>>,
    caller: Option<Caller>,
}

impl Requests {
    fn wake(&self) {
        if let Some(caller) = &self.caller {
            caller.call();
        }
    }
}

impl ServerListener for Requests {
    fn on_subscribe(&self, client: Client, channel: ChannelView<'_>) {
        if let Some(client) = client.sink_id() {
            let request = Request { channel: channel.id(), client };
            self.list.lock().unwrap_or_else(PoisonError::into_inner).push(request);
        }
        self.wake();
    }

    fn on_unsubscribe(&self, _client: Client, _channel: ChannelView<'_>) {
        self.wake();
    }
}

/// The server. It ends when this is dropped.
pub(crate) struct Server {
    context: Arc<Context>,
    requests: Arc<Requests>,
    handle: Option<WebSocketServerHandle>,
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
    Listen { address: IpAddr, port: u16, source: FoxgloveError },
}

impl Server {
    /// Listens. `caller` wakes the node when a client subscribes.
    pub(crate) fn start(address: IpAddr, port: u16, caller: Option<Caller>) -> Result<Self, ServerError> {
        let runtime =
            Builder::new_multi_thread().worker_threads(1).thread_name("websocket").enable_all().build()?;
        let context = Context::new();
        let requests = Arc::new(Requests { list: Mutex::default(), caller });
        let host = if address.is_ipv6() { format!("[{address}]") } else { address.to_string() };
        let server = WebSocketServer::new()
            .name("grainlab")
            .bind(host, port)
            .message_backlog_size(BACKLOG)
            .listener(Arc::clone(&requests) as Arc<dyn ServerListener>)
            .context(&context);
        let handle = runtime.block_on(server.start());
        let handle = handle.map_err(|source| ServerError::Listen { address, port, source })?;
        Ok(Self { context, requests, handle: Some(handle), runtime: Some(runtime) })
    }

    /// The port that it listens on.
    pub(crate) fn port(&self) -> u16 {
        self.handle.as_ref().map_or(0, WebSocketServerHandle::port)
    }

    /// Number of connected clients.
    pub(crate) fn clients(&self) -> usize {
        self.handle.as_ref().map_or(0, WebSocketServerHandle::client_count)
    }

    /// Advertises a topic with messages in CDR.
    pub(crate) fn channel(&self, topic: &str, type_name: &str, definition: &str) -> Option<Arc<RawChannel>> {
        let schema = Schema::new(type_name, "ros2msg", definition.as_bytes().to_vec());
        let builder = ChannelBuilder::new(topic).context(&self.context);
        builder.message_encoding("cdr").schema(schema).build_raw().ok()
    }

    /// The subscriptions of clients since the last call.
    pub(crate) fn requests(&self) -> Vec<Request> {
        std::mem::take(&mut *self.requests.list.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(handle) = self.handle.take() {
            handle.stop().detach_all();
        }
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}
