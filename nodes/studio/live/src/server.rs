//! HTTP on the loopback interface: the page, its events, the packings.

use crate::connections::Connections;
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
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::io::ErrorKind;
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;
use tokio::sync::{oneshot, watch};
use tokio::task::JoinSet;

/// Port that is tried first.
pub const DEFAULT_PORT: u16 = 8808;

/// Time for a request to arrive whole, and for which a connection is kept without one.
const HEADER_TIMEOUT: Duration = Duration::from_secs(10);

/// Time for a refused connection to send what it has begun to send.
const REFUSAL_TIMEOUT: Duration = Duration::from_secs(1);

/// Answer to a connection beyond the maximum.
const FULL: &[u8] = b"HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\n\r\nThe page has too many connections: close some of its windows.\n";

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
    let (mut connections, mut refused) = (Connections::default(), JoinSet::new());
    let router = Router::new()
        .route("/", get(async || Html(page())))
        .route("/events", get(events))
        .route("/packings", get(packings))
        .layer(from_fn(guard))
        .with_state(board);
    loop {
        let stream = match listener.accept().await {
            Ok((stream, _)) => stream,
            // The process has no descriptor left; connections that end return theirs.
            Err(error) if error.raw_os_error() == Some(libc::EMFILE) => {
                tokio::time::sleep(HEADER_TIMEOUT).await;
                continue;
            }
            // The other side has gone.
            Err(error) if error.kind() == ErrorKind::ConnectionAborted => continue,
            Err(error) => return Err(error),
        };
        if !connections.make_room().await {
            while refused.try_join_next().is_some() {}
            // More of them are closed without an answer.
            if refused.len() < Connections::MAX {
                refused.spawn(refuse(stream));
            }
            continue;
        }
        let service = TowerToHyperService::new(router.clone());
        connections.serve(|asked| async move {
            let service = service_fn(move |request| {
                asked.store(true, Ordering::Relaxed);
                service.call(request)
            });
            let mut http = http1::Builder::new();
            http.timer(TokioTimer::new()).header_read_timeout(HEADER_TIMEOUT);
            // A browser that breaks off is no fault of the page.
            _ = http.serve_connection(TokioIo::new(stream), service).await;
        });
        // A request that has arrived is read before the next connection may need the place of this one.
        tokio::task::yield_now().await;
    }
}

/// Tells a browser that there is no room. What the browser sends is read, because closing a connection with unread bytes resets it, and
/// the browser would not see the answer.
async fn refuse(mut stream: TcpStream) {
    let answered = async {
        stream.write_all(FULL).await?;
        stream.shutdown().await?;
        tokio::io::copy(&mut stream, &mut tokio::io::sink()).await
    };
    // A browser that breaks off is no fault of the page.
    _ = tokio::time::timeout(REFUSAL_TIMEOUT, answered).await;
}

/// Refuses requests under other names: a page of another site whose name was made to resolve to this host (DNS rebinding).
async fn guard(request: Request, next: Next) -> Response {
    let mut hosts = request.headers().get_all(header::HOST).iter();
    let host = hosts.next().and_then(|h| h.to_str().ok());
    // A second name contradicts the first one (RFC 9112, 3.2).
    if !host.is_some_and(is_loopback) || hosts.next().is_some() {
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
