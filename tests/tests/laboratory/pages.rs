//! Pages and pictures: of a run, of many runs, of a packing, and the page of a running laboratory.

use grainlab_msgs::{msg, simulated_seconds};
use grainlab_recordings::Recording;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use system_tests::bodies::{assert_same, decoded, distinct};
use system_tests::lab::{Lab, golden, number, summary, undisturbed};
use system_tests::process::Process;
use system_tests::python;
use system_tests::wait::{LIMIT, until};

/// The texts of a page: without scripts and data.
fn visible(page: &str) -> String {
    page.split("<script").map(|part| part.split_once("</script>").map_or(part, |(_, rest)| rest)).collect()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// A run whose scene asks for the energy balance has it recorded, and on its page.
#[test]
fn a_launch_writes_a_page_with_the_results_of_its_summary_and_the_energy_balance() {
    let lab = Lab::new();
    let run = lab.launch(&golden("scenes/tiny.toml"), &["--set", "numerics.energy_balance=true"]);
    let summary = summary(&run);
    let state = summary["states"].as_array().and_then(|s| s.last()).expect("the run has a state");
    let value = |key: &str| number(&state[key]);
    let whole = read(&run.join("report.html"));
    let page = visible(&whole);
    for text in [
        format!("{:.3}", value("k")),
        format!("{:.3}", value("z")),
        format!("{:.4}", value("eps")).replace('-', "−"),
        format!("{:.4}", value("phi")),
        format!("{:.2}", value("pressure_pa") / 1e3),
        format!("{:.2}", value("g12_pa") / 1e6),
        format!("{:.2}", value("theta_pa") / 1e6),
        summary["exchanges"].to_string(),
        summary["run"].as_str().unwrap().to_owned(),
    ] {
        assert!(page.contains(&text), "{text} is missing");
    }
    assert!(page.contains("Complete") && !page.contains("Missing or not readable"));

    let balances: Vec<msg::EnergyBalance> = decoded(&run, "/energy");
    assert!(balances.len() >= 3, "{balances:?} {}", summary["topics"]);
    for b in &balances {
        let springs = b.normal_springs + b.tangential_springs + b.rolling_springs;
        let damping = [b.normal_damping, b.tangential_damping, b.rolling_damping, b.drag, b.thermostat];
        let lost = [&damping[..], &[b.sliding, b.rolling, b.history]].concat();
        let size = b.strain_work.abs().max(lost.iter().map(|v| v.abs()).sum());
        let residual =
            b.start + b.strain_work + b.integration - b.kinetic - springs - lost.iter().sum::<f64>();
        assert!(residual.abs() < 1e-9 * size.max(b.start), "{b:?}");
        assert!(page.contains(&format!("{:.3e}", b.strain_work)), "{}", b.phase_name);
    }
    let without = undisturbed(&[]);
    assert!(!visible(&read(&without.join("report.html"))).contains("Energy dissipated"));

    // The command makes the same page again.
    std::fs::remove_file(run.join("report.html")).unwrap();
    let [first, second] = [&run, &without].map(|run| run.display().to_string());
    lab.run(&["report", &first]).assert_code(0);
    assert_eq!(read(&run.join("report.html")).len(), whole.len());

    // Every page is valid HTML and loads nothing.
    let Some(python) = python::with("html5lib") else { return };
    lab.run(&["report", "-o", "all.html", &first, &second]).assert_code(0);
    lab.run(&["view", &first, "-o", "view.html"]).assert_code(0);
    let pages = [run.join("report.html"), lab.folder().join("all.html"), lab.folder().join("view.html")];
    let pages = pages.each_ref().map(|page| page.to_str().unwrap());
    let checked = python::tool(&python, "check_html.py", &pages);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
}

#[test]
fn a_report_that_cannot_be_written_changes_neither_the_exit_code_nor_the_run() {
    let lab = Lab::new();
    let launcher = lab.start_launch("tiny", &[]);
    lab.until_recorded(20);
    let run = lab.last_run();
    // A folder in its place cannot be replaced.
    std::fs::create_dir(run.join("report.html")).unwrap();
    let ended = launcher.ended(LIMIT).assert_code(0).assert_says(&["no report"]);
    assert!(run.join("summary.json").exists() && !ended.stdout.contains("report.html"));
}

#[test]
fn a_picture_is_drawn_without_a_display_and_is_the_same_every_time() {
    let lab = Lab::new();
    let packing = golden("packings/isotropic_2000.csv.gz");
    let draw = |name: &str, extra: &[&str]| {
        let packing = packing.to_string_lossy();
        let mut arguments = vec!["view", &packing, "--png", name, "--size", "300x200"];
        arguments.extend(extra);
        lab.run(&arguments).assert_code(0);
        std::fs::read(lab.folder().join(name)).unwrap()
    };
    let first = draw("a.png", &[]);
    assert!(first.starts_with(b"\x89PNG") && first == draw("b.png", &[]));
    assert_ne!(first, draw("c.png", &["--color", "force"]));
    for (wrong, code) in [("--size=9", 2), ("--state=0", 2), ("--state=2", 1), ("--state=-2", 1)] {
        lab.run(&["view", &packing.to_string_lossy(), "--png", "d.png", wrong]).assert_code(code);
        assert!(!lab.folder().join("d.png").exists());
    }
}

#[test]
fn a_page_of_a_packing_from_another_program_is_written_beside_it() {
    let lab = Lab::new();
    let packing = lab.folder().join("mine.data.gz");
    std::fs::copy(golden("packings/packing_2000.data.gz"), &packing).unwrap();
    let flags = ["--shear-modulus", "29e9", "--poisson", "0.2", "--density", "2500", "--friction", "0.3"];
    let ended = lab.run(&[&["view", &packing.to_string_lossy()], &flags[..]].concat()).assert_code(0);
    let path = lab.folder().join("mine.view.html");
    assert_eq!(ended.stdout.trim(), path.display().to_string());
    let page = read(&path);
    assert!(page.len() < 6_000_000 && page.contains("2000 grains") && page.contains("viewer-state-0"));
}

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
fn the_live_page_shows_values_of_the_recording_changes_no_byte_and_goes_on_after_it_was_stopped() {
    let (lab, scene) = (Lab::new(), golden("scenes/tiny.toml"));
    let page = Page::open(&lab);
    let events = page.events();
    until_heading(&events, "Waiting for a run");
    let run = lab.launch(&scene, &[]);
    let shown = until_heading(&events, "Complete");
    assert_same(&undisturbed(&[]), &run);

    let channels = Recording::open(&run).unwrap().channels();
    assert!(channels.iter().all(|c| !c.topic.contains("sampled")), "samples are not recorded");
    let requests: Vec<msg::Stress> = decoded(&run, "/stress");
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
    let report: msg::PackingReport = decoded(&run, "/packing_report").pop().unwrap();
    let mut late = until_heading(&page.events(), "Complete");
    let parts = late.pop().unwrap().1;
    let text = |id: &str| parts[id].as_str().unwrap_or_else(|| panic!("{id}: {parts}")).to_owned();
    assert!(text("structure").contains(&format!("{:.3}", report.contacts.mechanical_coordination)));
    assert!(text("nodes").contains("/servo_controller") && text("curves").contains("plot-stress"));

    // A stopped page holds up no run, and the page goes on with the next run.
    page.process.signal(libc::SIGSTOP);
    lab.launch(&scene, &["--out", "stopped", "--seed", "4"]);
    page.process.signal(libc::SIGCONT);
    lab.launch(&scene, &["--out", "next", "--seed", "5"]);
    until_heading(&events, "Running");
    until_heading(&events, "Complete");

    let ended = page.process.ended_by(libc::SIGTERM);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    assert_eq!(ended.stdout, format!("http://127.0.0.1:{}/\n", page.port));
}

#[test]
fn a_page_of_no_file_and_of_a_file_at_once_is_refused() {
    let lab = Lab::new();
    for arguments in [&["view"][..], &["view", "x.csv", "--live"], &["view", "x.csv", "--port", "1"]] {
        lab.run(arguments).assert_code(2);
    }
}
