//! The page of a running laboratory.

use grainlab_msgs::{from_cdr, msg, simulated_seconds};
use grainlab_recordings::{Recording, Selection};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, channel};
use system_tests::bodies::{assert_same, distinct};
use system_tests::lab::{LIMIT, Lab, golden, until};
use system_tests::process::Process;

/// A running `grainlab view --live`.
struct Page {
    process: Process,
    port: u16,
}

impl Page {
    fn open(lab: &Lab) -> Self {
        let free = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let port = free.local_addr().unwrap().port();
        drop(free);
        let process = lab.start(&["view", "--live", "--port", &port.to_string()]);
        let page = Self { process, port };
        until("the page is served", || TcpStream::connect((Ipv4Addr::LOCALHOST, port)).is_ok());
        page
    }

    fn get(&self, path: &str) -> BufReader<TcpStream> {
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        // Version 1.0: a stream without chunks.
        write!(stream, "GET {path} HTTP/1.0\r\nHost: localhost\r\n\r\n").unwrap();
        BufReader::new(stream)
    }

    /// The events from now on: name and data.
    fn events(&self) -> Receiver<(String, Value)> {
        let (sender, events) = channel();
        let stream = self.get("/events");
        std::thread::spawn(move || {
            let mut name = String::new();
            for line in stream.lines().map_while(Result::ok) {
                match line.split_once(": ") {
                    Some(("event", found)) => name = found.to_owned(),
                    Some(("data", data)) => {
                        let data = serde_json::from_str(data).unwrap_or_else(|e| panic!("{e}: {data}"));
                        if sender.send((name.clone(), data)).is_err() {
                            return;
                        }
                    }
                    _ => {}
                }
            }
        });
        events
    }
}

/// The events up to a heading with this text.
fn until_heading(events: &Receiver<(String, Value)>, text: &str) -> Vec<(String, Value)> {
    let mut found = Vec::new();
    loop {
        let event =
            events.recv_timeout(LIMIT).unwrap_or_else(|e| panic!("no heading {text:?}: {e}; {found:?}"));
        let is_last = event.1["heading"].as_str().is_some_and(|h| h.contains(text));
        found.push(event);
        if is_last {
            return found;
        }
    }
}

/// The digits behind a text.
fn after<'a>(text: &'a str, mark: &str) -> Option<&'a str> {
    text.split_once(mark)?.1.split(|c: char| !c.is_ascii_digit()).next()
}

#[test]
fn the_page_shows_values_of_the_recording_and_the_recording_is_that_of_a_run_without_it() {
    let (alone, followed) = (Lab::new(), Lab::new());
    let scene = golden("scenes/tiny.toml");
    let expected = alone.launch(&scene, &[]);

    let page = Page::open(&followed);
    let events = page.events();
    until_heading(&events, "Waiting for a run");
    let run = followed.launch(&scene, &[]);
    let shown = until_heading(&events, "Complete");
    assert_same(&expected, &run);

    let recording = Recording::open(&run).unwrap();
    assert!(recording.channels().iter().all(|c| !c.topic.contains("sampled")), "samples are not recorded");
    let requests: Vec<msg::Stress> = (recording.messages(&Selection::topics(["/stress"])).unwrap())
        .map(|m| from_cdr(&m.payload).unwrap())
        .collect();
    let cards = shown.iter().filter_map(|(_, data)| data["cards"].as_str());
    let cards: Vec<(&str, u64)> =
        cards.filter_map(|c| Some((c, after(c, ">step ")?.parse().ok()?))).collect();
    assert!(!cards.is_empty(), "{shown:?}");
    for (card, step) in cards {
        let r = requests.iter().find(|r| r.step == step).expect("the recording has the exchange");
        let time = 1e3 * simulated_seconds(&r.header.stamp);
        for value in
            [format!("{:.4}", r.solid_fraction), format!("{:.3}", r.coordination), format!("{time:.4} ")]
        {
            assert!(card.contains(&format!("class=\"value\">{value}")), "{value} at step {step}: {card}");
        }
    }
    // The last packing is in the pictures, and its structure on the page.
    let mut packings = String::new();
    page.get("/packings").read_to_string(&mut packings).unwrap();
    let (_, body) = packings.split_once("\r\n\r\n").unwrap();
    let packings: Value = serde_json::from_str(body).unwrap();
    assert_eq!(packings["about"]["grains"], 80);
    assert_eq!(packings["states"].as_array().unwrap().len(), distinct(&run, "/packing").len());
    let report: msg::PackingReport = from_cdr(distinct(&run, "/packing_report").last().unwrap()).unwrap();
    let mut late = until_heading(&page.events(), "Complete");
    let parts = late.pop().unwrap().1;
    let text = |id: &str| parts[id].as_str().unwrap_or_else(|| panic!("{id}: {parts}")).to_owned();
    assert!(text("structure").contains(&format!("{:.3}", report.contacts.mechanical_coordination)));
    assert!(text("nodes").contains("/servo_controller") && text("curves").contains("plot-stress"));

    page.process.signal(libc::SIGTERM);
    let ended = page.process.ended(LIMIT);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    assert_eq!(ended.stdout, format!("http://127.0.0.1:{}/\n", page.port));
}

#[test]
fn a_stopped_page_holds_up_no_run_and_the_page_goes_on_with_the_next_run() {
    let lab = Lab::new();
    let scene = golden("scenes/tiny.toml");
    let page = Page::open(&lab);
    let events = page.events();
    lab.launch(&scene, &[]);
    until_heading(&events, "Complete");
    page.process.signal(libc::SIGSTOP);
    let stopped = lab.launch(&scene, &["--out", "stopped", "--seed", "4"]);
    assert!(stopped.exists());
    page.process.signal(libc::SIGCONT);
    lab.launch(&scene, &["--out", "next", "--seed", "5"]);
    let heading = until_heading(&events, "Running").pop().unwrap().1;
    assert!(heading["heading"].is_string());
    until_heading(&events, "Complete");
}

#[test]
fn a_page_of_no_file_and_of_a_file_at_once_is_refused() {
    let lab = Lab::new();
    for arguments in [&["view"][..], &["view", "x.csv", "--live"], &["view", "x.csv", "--port", "1"]] {
        assert_eq!(lab.run(arguments).code, Some(2), "{arguments:?}");
    }
}
