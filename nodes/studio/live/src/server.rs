//! HTTP on the loopback interface: the page, its events, the packings.

use crate::page::page;
use crate::snapshot::Snapshot;
use axum::Router;
use axum::extract::{Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use futures::Stream;
use grainlab_console::Failure;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;
use std::thread::JoinHandle;
use tokio::sync::{oneshot, watch};

/// Port that is tried first.
pub const DEFAULT_PORT: u16 = 8808;

/// Content that a browser may load: scripts and styles of the page itself, and data of this server.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src 'self' data: blob:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The latest snapshot, for any number of browsers: each that follows has a receiver.
type Board = Arc<watch::Sender<Arc<Snapshot>>>;

/// A server in a thread of its own; dropping it ends it with all its connections.
#[derive(Debug)]
pub struct Server {
    /// Port on 127.0.0.1.
    pub port: u16,
    board: Board,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Listens on a port of 127.0.0.1: the one given, 0 for any free one; without one the default, or any if that is taken.
    ///
    /// # Errors
    /// If the port is taken.
    pub fn listen(port: Option<u16>) -> Result<Self, Failure> {
        let bind = |port| TcpListener::bind((Ipv4Addr::LOCALHOST, port));
        let listener = match port {
            Some(port) => {
                bind(port).map_err(|e| Failure::failed(format!("--port {port}: {e}; 0 is any free port")))
            }
            None => bind(DEFAULT_PORT).or_else(|_| bind(0)).map_err(Failure::failed),
        }?;
        listener.set_nonblocking(true).map_err(Failure::failed)?;
        let port = listener.local_addr().map_err(Failure::failed)?.port();
        let board = Board::new(watch::Sender::new(Arc::default()));
        let shared = Arc::clone(&board);
        let (stop, stopped) = oneshot::channel();
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(Failure::failed)?;
        let thread = std::thread::Builder::new().name("page server".into()).spawn(move || {
            runtime.block_on(async {
                tokio::select! {
                    served = serve(listener, shared) => {
                        if let Err(error) = served {
                            grainlab_console::say!("grainlab: the page is no longer served: {error}");
                        }
                    }
                    _ = stopped => {}
                }
            });
        });
        let thread = thread.map_err(Failure::failed)?;
        Ok(Self { port, board, stop: Some(stop), thread: Some(thread) })
    }

    /// Address of the page.
    pub fn url(&self) -> String {
        format!("http://{}:{}/", Ipv4Addr::LOCALHOST, self.port)
    }

    /// Number of browsers that follow.
    pub fn browsers(&self) -> usize {
        self.board.receiver_count()
    }

    /// Shows this from now on. Never waits.
    pub fn show(&self, snapshot: Snapshot) {
        self.board.send_replace(Arc::new(snapshot));
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.stop.take();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

async fn serve(listener: TcpListener, board: Board) -> std::io::Result<()> {
    let listener = tokio::net::TcpListener::from_std(listener)?;
    let router = Router::new()
        .route("/", get(async || Html(page())))
        .route("/events", get(events))
        .route("/packings", get(packings))
        .layer(from_fn(guard))
        .with_state(board);
    axum::serve(listener, router).await
}

/// Refuses requests under other names: a page of another site whose name was made to resolve to this host (DNS rebinding).
async fn guard(request: Request, next: Next) -> Response {
    let host = request.headers().get(header::HOST).and_then(|h| h.to_str().ok());
    if !host.is_some_and(is_loopback) {
        let text = "This page is served to 127.0.0.1 and localhost only.\n";
        return (StatusCode::FORBIDDEN, text).into_response();
    }
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY));
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    response
}

/// True for a Host header that names this host, with or without a port.
fn is_loopback(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.parse::<u16>().is_ok() => name,
        Some(_) => return false,
        None => host,
    };
    name == "127.0.0.1" || name.eq_ignore_ascii_case("localhost")
}

async fn events(State(board): State<Board>) -> impl IntoResponse {
    Sse::new(changes(board.subscribe())).keep_alive(KeepAlive::default())
}

/// Everything at first, then what has changed. The next snapshot is taken when the browser has received the one before.
fn changes(latest: watch::Receiver<Arc<Snapshot>>) -> impl Stream<Item = Result<Event, Infallible>> {
    let begin = (latest, Arc::new(Snapshot::default()), VecDeque::new(), true);
    futures::stream::unfold(begin, async |(mut latest, mut before, mut waiting, mut is_first)| {
        loop {
            if let Some((name, data)) = waiting.pop_front() {
                let event = Event::default().event(name).data::<String>(data);
                return Some((Ok(event), (latest, before, waiting, is_first)));
            }
            if !std::mem::take(&mut is_first) {
                latest.changed().await.ok()?;
            }
            let now = Arc::clone(&latest.borrow_and_update());
            waiting.extend(now.since(&before));
            before = now;
        }
    })
}

async fn packings(State(board): State<Board>) -> Response {
    let json = board.borrow().pictures.as_ref().map(|p| p.json.to_string());
    match json {
        Some(json) => ([(header::CONTENT_TYPE, "application/json")], json).into_response(),
        None => (StatusCode::NOT_FOUND, "The run has not published a packing yet.\n").into_response(),
    }
}

#[cfg(test)]
mod tests;
