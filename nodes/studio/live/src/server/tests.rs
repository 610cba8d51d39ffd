use super::*;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;

fn request(server: &Server, path: &str, host: &str) -> TcpStream {
    let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, server.port)).unwrap();
    stream.set_read_timeout(Some(std::time::Duration::from_secs(20))).unwrap();
    write!(stream, "GET {path} HTTP/1.0\r\nHost: {host}\r\n\r\n").unwrap();
    stream
}

fn answer(server: &Server, path: &str, host: &str) -> String {
    let mut text = String::new();
    request(server, path, host).read_to_string(&mut text).unwrap();
    text
}

fn snapshot(text: &str) -> Snapshot {
    let mut snapshot = Snapshot::default();
    snapshot.set("cards", text.into());
    snapshot
}

#[test]
fn only_requests_for_this_host_are_answered() {
    let server = Server::listen(Some(0)).unwrap();
    for host in ["127.0.0.1", "localhost", "LOCALHOST:80", &format!("127.0.0.1:{}", server.port)] {
        assert!(answer(&server, "/", host).contains(" 200 OK"), "{host}");
    }
    for host in ["evil.example", "evil.example:8808", "127.0.0.1.evil.example", "localhost:x", "[::1]", ""] {
        for path in ["/", "/events", "/packings"] {
            let text = answer(&server, path, host);
            assert!(text.starts_with("HTTP/1.0 403") && !text.contains("<html"), "{host} {path}: {text}");
        }
    }
}

#[test]
fn a_request_under_two_names_is_refused() {
    let server = Server::listen(Some(0)).unwrap();
    let text = answer(&server, "/", "localhost\r\nHost: evil.example");
    assert!(text.starts_with("HTTP/1.0 403"), "{text}");
}

fn connect(server: &Server) -> TcpStream {
    let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, server.port)).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    stream
}

#[test]
fn half_requests_and_silent_connections_keep_no_browser_out() {
    let server = Server::listen(Some(0)).unwrap();
    server.show(snapshot("1"));
    let mut follower = BufReader::new(request(&server, "/events", "localhost"));
    assert_eq!(event(&mut follower).1, r#"{"cards":"1"}"#);
    // Half of them say nothing.
    let half = |n| {
        let mut half = connect(&server);
        // The server may have closed it already.
        _ = write!(half, "{}", if n % 2 == 0 { "" } else { "GET / HTTP/1.1\r\nHost: local" });
        half
    };
    let begin = std::time::Instant::now();
    let mut halves: Vec<TcpStream> = Vec::new();
    for n in 0..600 {
        halves.push(half(n));
        if n % 100 == 99 {
            let text = answer(&server, "/", "localhost");
            assert!(text.contains(" 200 OK"), "after {n}: {text}");
        }
    }
    assert!(begin.elapsed() < HEADER_TIMEOUT, "the half requests did not end by themselves");
    // Who has asked keeps the connection.
    server.show(snapshot("2"));
    assert_eq!(event(&mut follower).1, r#"{"cards":"2"}"#);
}

#[test]
fn a_browser_beyond_the_maximum_is_told_why() {
    let server = Server::listen(Some(0)).unwrap();
    server.show(snapshot("1"));
    let followers: Vec<_> = (0..Connections::MAX)
        .map(|_| {
            let mut follower = BufReader::new(request(&server, "/events", "localhost"));
            event(&mut follower);
            follower
        })
        .collect();
    for _ in 0..20 {
        let text = answer(&server, "/", "localhost");
        assert!(text.starts_with("HTTP/1.1 503") && text.contains("close some of its windows"), "{text}");
    }
    drop(followers);
    let until = std::time::Instant::now() + Duration::from_secs(20);
    while !answer(&server, "/", "localhost").contains(" 200 OK") {
        assert!(std::time::Instant::now() < until, "the places of closed windows are not free");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn the_page_loads_nothing_from_elsewhere() {
    let server = Server::listen(Some(0)).unwrap();
    let text = answer(&server, "/", "localhost").to_lowercase();
    assert!(text.contains("content-security-policy: default-src 'none'"));
    let (_, body) = text.split_once("<!doctype html>").unwrap();
    for reference in ["<iframe", "@import", "src=\"http", "href=\"http", "url(http"] {
        assert!(!body.contains(reference), "{reference}");
    }
}

#[test]
fn a_port_that_is_taken_is_an_error_that_names_it_and_without_one_another_is_found() {
    let first = Server::listen(Some(0)).unwrap();
    let error = Server::listen(Some(first.port)).unwrap_err().to_string();
    assert!(error.contains(&format!("--port {}", first.port)), "{error}");
    let others = [Server::listen(None).unwrap(), Server::listen(None).unwrap()];
    assert_ne!(others[0].port, others[1].port);
}

/// The next event of a stream: its name and data.
fn event(stream: &mut impl BufRead) -> (String, String) {
    let mut found = (String::new(), String::new());
    loop {
        let mut line = String::new();
        assert!(stream.read_line(&mut line).unwrap() > 0, "the stream has ended");
        match line.trim_end().split_once(": ") {
            Some(("event", name)) => found.0 = name.to_owned(),
            Some(("data", data)) => found.1 = data.to_owned(),
            _ if !found.0.is_empty() && line.trim_end().is_empty() => return found,
            _ => {}
        }
    }
}

#[test]
fn each_browser_receives_the_whole_state_when_it_comes_and_then_changes() {
    let server = Server::listen(Some(0)).unwrap();
    server.show(snapshot("1"));
    let mut early = BufReader::new(request(&server, "/events", "localhost"));
    assert_eq!(event(&mut early), ("parts".into(), r#"{"cards":"1"}"#.into()));
    let mut next = snapshot("1");
    next.set("nodes", "n".into());
    server.show(next);
    assert_eq!(event(&mut early), ("parts".into(), r#"{"nodes":"n"}"#.into()));
    let mut late = BufReader::new(request(&server, "/events", "localhost"));
    assert_eq!(event(&mut late).1, r#"{"cards":"1","nodes":"n"}"#);
    assert_eq!(server.browsers(), 2);
}

#[test]
fn a_browser_that_does_not_read_holds_up_nobody_and_nothing_is_queued_for_it() {
    let server = Server::listen(Some(0)).unwrap();
    let stopped = request(&server, "/events", "localhost");
    // More than the buffers of both sockets hold.
    for n in 0..200 {
        server.show(snapshot(&format!("{n}{}", "x".repeat(200_000))));
    }
    server.show(snapshot("last"));
    let mut other = BufReader::new(request(&server, "/events", "localhost"));
    assert_eq!(event(&mut other).1, r#"{"cards":"last"}"#);
    drop(stopped);
}

#[test]
fn the_end_of_the_server_ends_the_streams() {
    let server = Server::listen(Some(0)).unwrap();
    server.show(snapshot("1"));
    let mut stream = BufReader::new(request(&server, "/events", "localhost"));
    event(&mut stream);
    drop(server);
    let mut rest = Vec::new();
    // Closed in order or reset.
    let _ = stream.read_to_end(&mut rest);
}
