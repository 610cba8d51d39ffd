//! Reports of runs that are made here, message by message.

use grainlab_core::{Cell, ComponentControl, Packing, ServoLaw, SymTensor, Vec3};
use grainlab_micromechanics::{Settings, analyze};
use grainlab_msgs::boundary::{packing_message, packing_report_message};
use grainlab_msgs::{Guid, msg, to_cdr, topics};
use grainlab_recordings::{Incoming, RunWriter, TopicSpec, WriterOptions};
use grainlab_report::{FILE, Run, overview, write_report};
use grainlab_servo::{ServoInput, ServoRequest};
use std::path::Path;

/// Exchanges of each of the two phases.
const EXCHANGES: u64 = 3000;

/// Largest size of a page, bytes.
const LARGEST: usize = 6_000_000;

fn request(sequence: u64) -> msg::Stress {
    // One exchange has a stress far beyond the others.
    let stress = if sequence == 1234 { 987_654.0 } else { 10.0 * (sequence % 17) as f64 };
    let request = ServoRequest {
        sequence,
        step: 10 * sequence,
        phase: (sequence / EXCHANGES) as u32,
        time: 1e-6 * sequence as f64,
        input: ServoInput {
            stress: SymTensor::from_voigt([stress, 0.0, 0.0, 0.0, 0.0, 0.0]),
            controls: [ComponentControl::Held; 6],
            rate: [0.0; 6],
            rate_limit: 1.0,
            law: ServoLaw::Scaled { response_time: 1e-5 },
            tangent: Some([0.0; 6]),
            control_interval: 1e-6,
        },
        asymmetry: 0.0,
        strain: SymTensor::from_voigt([0.0; 6]),
        solid_fraction: 0.6,
        coordination: 4.0,
        unbalanced: 1e-3,
    };
    msg::Stress::try_from(&request).unwrap()
}

fn packing() -> Packing {
    Packing {
        step: 60_000,
        time: 6e-3,
        friction: 0.3,
        time_step: 1e-7,
        ..Packing::at_rest(
            Cell::cube(4e-3).unwrap(),
            vec![1e-3; 2],
            vec![Vec3::new(1e-3, 1e-3, 1e-3), Vec3::new(3e-3, 3e-3, 3e-3)],
        )
    }
}

/// A recording with stress against time and one packing, in `folder`.
fn record(folder: &Path) {
    let requests = (0..2 * EXCHANGES).map(|n| ("/stress", n + 1, to_cdr(&request(n))));
    let packing = to_cdr(&packing_message(&packing(), "made", Vec::new()));
    record_these(folder, requests.chain([("/packing", 1, packing)]));
}

fn record_these(folder: &Path, messages: impl Iterator<Item = (&'static str, u64, Vec<u8>)>) {
    let topics = [&topics::STRESS, &topics::PACKING, &topics::PACKING_REPORT];
    let specs = topics.map(|topic| TopicSpec::of_contract(topic, &format!("/{}", topic.name)));
    let mut run = RunWriter::create(folder, "r", &specs, WriterOptions::default()).unwrap();
    for (topic, number, payload) in messages {
        let sample = Incoming {
            guid: Guid([1; 16]),
            sequence: number as i64,
            source_time: None,
            receive_time: 1 + number,
            payload: &payload,
        };
        run.write(topic, &sample).unwrap();
    }
    run.set_metadata("run", "a0b1");
    run.finish().unwrap();
}

/// A summary with what a page shows of it.
fn summarise(folder: &Path, exit: u8) {
    let text = format!(
        r#"{{"scene": "made", "seed": 4711, "wall_seconds": 12.34, "exit": {exit}, "warnings": ["a <b>warning</b>"],
        "topics": [{{"name": "/stress", "published": 6003, "recorded": 6000, "lost": 3, "repeated": 17}}],
        "nodes": [{{"name": "dem_simulator", "pid": 1, "exit": null, "restarts": 2}}],
        "exchanges": 5987, "waiting_fraction": 0.125}}"#
    );
    std::fs::write(folder.join("summary.json"), text).unwrap();
}

/// The page with its scripts and data left out.
fn visible(page: &str) -> String {
    page.split("<script").map(|part| part.split_once("</script>").map_or(part, |(_, rest)| rest)).collect()
}

#[test]
fn the_page_has_the_numbers_of_the_summary_and_its_texts_are_no_markup() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("made-4711-1");
    record(&run);
    summarise(&run, 3);
    let page = Run::read(&run).html().unwrap();
    let page = visible(&page);
    for text in ["made", "4711", "12.3 s", "exit code 3", "6003", "6000", "5987", "12.5 %", "by a signal"] {
        assert!(page.contains(text), "{text} is missing");
    }
    assert!(page.contains("a &lt;b&gt;warning&lt;/b&gt;") && !page.contains("<b>warning"));
}

#[test]
fn an_extreme_of_one_exchange_is_in_the_data_of_the_page() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    let page = Run::read(folder.path()).html().unwrap();
    let line = page.lines().find(|l| l.starts_with("xx,") && l.contains(",987.654"));
    assert_eq!(line, Some("xx,0.001234,987.654"));
    assert!(page.contains("series,time_s,stress_kpa\n") && page.contains("series,time_s,solid_fraction\n"));
    let lines = page.lines().filter(|l| l.starts_with("xx,")).count();
    assert!((100..=2500).contains(&lines), "{lines} points of {} exchanges", 2 * EXCHANGES);
}

#[test]
fn a_page_loads_nothing_and_is_of_bounded_size() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    summarise(folder.path(), 0);
    let page = Run::read(folder.path()).html().unwrap();
    assert!(page.len() < LARGEST, "{} bytes", page.len());
    for loads in [" src=\"http", " href=\"http", "@import", "url(http", "<link", "<iframe"] {
        assert!(!page.contains(loads), "{loads}");
    }
    assert_eq!(page.matches("<script").count(), page.matches("</script>").count());
    let addresses = |text: &str| {
        text.match_indices("http").filter(|(n, _)| text[*n..].starts_with("http://www.w3.org/")).count()
    };
    assert_eq!(
        page.matches("http://").count() + page.matches("https://").count(),
        addresses(&page),
        "only namespaces"
    );
}

#[test]
fn the_same_run_gives_the_same_page() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    let page = || Run::read(folder.path()).html().unwrap();
    assert!(page() == page());
}

#[test]
fn what_is_not_there_is_named_and_the_rest_is_shown() {
    let empty = tempfile::tempdir().unwrap();
    let page = Run::read(empty.path()).html().unwrap();
    for text in [
        "No summary",
        "No recording",
        "No scene",
        "The end of the run is not known",
        "No packing was measured",
    ] {
        assert!(page.contains(text), "{text} is missing");
    }
    let broken = tempfile::tempdir().unwrap();
    std::fs::write(broken.path().join("summary.json"), "{\"exit\": \"x").unwrap();
    std::fs::write(broken.path().join("r_0.mcap"), b"not a recording").unwrap();
    std::fs::write(broken.path().join("scene.toml"), "grains = \"<none>\"").unwrap();
    let page = Run::read(broken.path()).html().unwrap();
    assert!(
        page.contains("No summary")
            && page.contains("No recording")
            && page.contains("grains = &quot;&lt;none&gt;&quot;")
    );
}

#[test]
fn a_recording_that_was_cut_off_is_shown_as_far_as_it_goes() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    let file = folder.path().join("r_0.mcap");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() * 2 / 3]).unwrap();
    let page = Run::read(folder.path()).html().unwrap();
    assert!(page.contains("Missing or not readable"), "the damage is named");
    std::fs::write(folder.path().join("summary.json"), "{\"exit\": 0}").unwrap();
    let run = Run::read(folder.path());
    let page = run.html().unwrap();
    assert!(page.contains(">Damaged: ") && !page.contains(">Complete"), "the page begins with the damage");
    assert!(overview(&[(run, "r.html".to_owned())]).contains("<td class=\"bad\">damaged</td>"));
}

#[test]
fn a_chunk_that_is_damaged_without_truncation_is_named() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    assert!(!Run::read(folder.path()).html().unwrap().contains("is left out"));
    let file = folder.path().join("r_0.mcap");
    let mut bytes = std::fs::read(&file).unwrap();
    let at = bytes.len() / 3;
    bytes[at..at + 64].fill(0xa5);
    std::fs::write(&file, &bytes).unwrap();
    assert!(Run::read(folder.path()).html().unwrap().contains("is left out"), "the damaged chunk is named");
}

#[test]
fn a_page_is_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_report(folder.path()).unwrap();
    assert_eq!(path, folder.path().join(FILE));
    std::fs::remove_file(&path).unwrap();
    std::fs::create_dir(&path).unwrap();
    assert!(write_report(folder.path()).unwrap_err().to_string().contains(FILE));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no partial file remains");
}

#[test]
fn the_table_of_many_runs_has_a_row_for_each_and_leads_to_their_pages() {
    let folder = tempfile::tempdir().unwrap();
    let runs = ["one", "two & three"].map(|name| {
        let run = folder.path().join(name);
        std::fs::create_dir(&run).unwrap();
        summarise(&run, 0);
        (Run::read(&run), format!("{}/{FILE}", name.replace(' ', "%20")))
    });
    let page = overview(&runs);
    assert!(page.contains("2 runs of made") && page.contains("href=\"one/report.html\""));
    assert!(page.contains("<th scope=\"row\" class=\"n\">2</th><td><a href=\"two%20"), "rows are numbered");
    // These runs have only a summary.
    assert!(page.contains("two &amp; three</a>") && page.contains("damaged") && !page.contains(">complete<"));
}

#[test]
fn the_table_of_many_runs_marks_what_differs_among_runs_with_the_same_settings() {
    let folder = tempfile::tempdir().unwrap();
    // The sixth run differs in its result alone, and the seventh in a setting, too.
    let runs: Vec<_> = (1..=7)
        .map(|n| {
            let run = folder.path().join(n.to_string());
            std::fs::create_dir(&run).unwrap();
            let found = Packing { radii: vec![if n >= 6 { 0.5e-3 } else { 1e-3 }; 2], ..packing() };
            let sent = packing_message(&found, "made", Vec::new());
            let report = analyze(&found, &Settings::default()).unwrap().report;
            let report = packing_report_message(sent.header.clone(), &report).unwrap();
            let messages = [("/packing", 1, to_cdr(&sent)), ("/packing_report", 1, to_cdr(&report))];
            record_these(&run, messages.into_iter());
            summarise(&run, 0);
            let scene = format!("seed = {n}\nnumerics.skin = {}", if n == 7 { 0.2 } else { 0.1 });
            std::fs::write(run.join("scene.toml"), scene).unwrap();
            (Run::read(&run), format!("{n}/{FILE}"))
        })
        .collect();
    let repeats = |a: usize, b: usize| runs[a].0.repeats(&runs[b].0);
    assert!(repeats(1, 1) && !repeats(1, 2) && !repeats(4, 5) && !repeats(5, 6));
    let page = overview(&runs);
    let rows = page.split("<tr>").filter(|row| row.contains(FILE));
    let marked: Vec<usize> = rows.map(|row| row.matches("class=\"n outlier\"").count()).collect();
    assert_eq!(marked, [0, 0, 0, 0, 0, 1, 0]);
}

#[test]
fn requests_of_two_runs_are_not_drawn_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let spec = TopicSpec::of_contract(&topics::STRESS, "/stress");
    let mut run = RunWriter::create(folder.path(), "r", &[spec], WriterOptions::default()).unwrap();
    for (n, sequence) in [0, 1, 2, 1, 2].into_iter().enumerate() {
        // The second run begins with the third request: other strains under the same numbers.
        let message = msg::Stress { solid_fraction: if n < 4 { 0.6 } else { 0.61 }, ..request(sequence) };
        let sample = Incoming {
            guid: Guid([1; 16]),
            sequence: n as i64 + 1,
            source_time: None,
            receive_time: 1 + n as u64,
            payload: &to_cdr(&message),
        };
        run.write("/stress", &sample).unwrap();
    }
    run.finish().unwrap();
    let run = Run::read(folder.path());
    let several = run.several_runs().map(ToString::to_string).unwrap_or_default();
    assert!(several.contains("two different requests of number 2"), "{several}");
    assert!(run.html().unwrap().contains("holds several runs"));
}

#[test]
fn a_run_with_a_part_of_a_killed_recorder_does_not_claim_that_nothing_was_lost() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    summarise(folder.path(), 0);
    let page = || Run::read(folder.path()).html().unwrap();
    assert!(!page().contains("not counting"));
    let file = folder.path().join("r_0.mcap");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() * 2 / 3]).unwrap();
    grainlab_recordings::recover(folder.path()).unwrap();
    assert!(page().contains(" lost, not counting 1 file whose recorder ended early"));
}

#[test]
fn a_summary_of_another_run_is_left_out_and_said_to_be() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    let page = |run: &str| {
        let text = format!(r#"{{"run": "{run}", "wall_seconds": 12.34, "exit": 0}}"#);
        std::fs::write(folder.path().join("summary.json"), text).unwrap();
        Run::read(folder.path()).html().unwrap()
    };
    assert!(page("a0b1").contains("12.3 s"));
    let other = page("c2d3");
    assert!(other.contains("summary.json is of run c2d3, and the recording of run a0b1"));
    assert!(!other.contains("12.3 s") && !other.contains(">Complete"));
}

#[test]
fn the_command_that_repeats_a_run_has_its_launch_file_and_arguments() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path());
    let page = || Run::read(folder.path()).html().unwrap();
    assert!(page().contains("how it was launched is not recorded") && !page().contains("the same bytes"));
    let launched = r#"{"launch": "", "arguments": {}, "seed": 1, "words": ["my lab.yaml", "simd:=scalar"]}"#;
    std::fs::write(folder.path().join("launch.json"), launched).unwrap();
    assert!(visible(&page()).contains("grainlab launch 'my lab.yaml' simd:=scalar --scene"));
}

/// One grain with the modulus of a rubber, which touches its own images along the three edges.
#[test]
fn moduli_and_pressure_of_soft_grains_keep_three_digits_on_a_page() {
    let radius = 1e-4;
    let contact = |axis: usize| {
        let (mut image, mut normal) = ([0; 3], Vec3::zeros());
        (image[axis], normal[axis]) = (1, 1.0);
        grainlab_core::Contact::pressed([0, 0], image, normal, 1e-8, 1e-7)
    };
    let mut soft = Packing {
        step: 12,
        friction: 0.3,
        time_step: 1e-7,
        contacts: [2, 1, 0].map(contact).to_vec(),
        ..Packing::at_rest(Cell::cube(2.0 * radius - 1e-8).unwrap(), vec![radius], vec![Vec3::zeros()])
    };
    soft.material.shear_modulus = 1e6;
    let report = analyze(&soft, &Settings::default()).unwrap().report;
    let packing = packing_message(&soft, "made", Vec::new());
    let message = packing_report_message(packing.header.clone(), &report).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("soft-1-1");
    record_these(
        &run,
        [("/packing", 1, to_cdr(&packing)), ("/packing_report", 2, to_cdr(&message))].into_iter(),
    );
    summarise(&run, 0);
    let page = Run::read(&run).html().unwrap();
    let [g12, _, theta] = grainlab_results::brief::moduli(&report);
    let pressure = report.pressure() / 1e3;
    for (name, value) in [("G12", g12.unwrap()), ("theta", theta.unwrap()), ("p", pressure)] {
        let text = grainlab_console::three_digits(Some(value), 2);
        assert!(value < 0.01 && visible(&page).contains(&text), "{name} {text} is missing");
    }
}

#[test]
fn a_run_is_said_to_repeat_only_with_the_scene_and_the_seed_of_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let scene = grainlab_scene::Draft::of_text("base = 'demo'\nname = 'made'\nseed = 3").unwrap();
    let scene = scene.resolve().unwrap().toml;
    let mut run = RunWriter::create(folder.path(), "r", &[], WriterOptions::default()).unwrap();
    run.attach("scene.toml", "application/toml", scene.as_bytes()).unwrap();
    run.finish().unwrap();
    put("scene.toml", &scene);
    put("launch.json", r#"{"launch": "", "arguments": {}, "seed": 3, "words": []}"#);
    put("summary.json", r#"{"scene": "made", "seed": 3, "exit": 0}"#);
    let page = || visible(&Run::read(folder.path()).html().unwrap());
    assert!(page().contains("--seed 3    # the same run: the same bytes"));
    put("summary.json", r#"{"scene": "made", "seed": 7, "exit": 0}"#);
    assert!(page().contains("states the seed 7") && page().contains("--seed 3    # the same run"));
    put("summary.json", r#"{"scene": "made", "seed": 3, "exit": 0}"#);
    put("scene.toml", &scene.replace("friction = 0.3", "friction = 0.8"));
    assert!(
        page().contains("another run: scene.toml is not the scene") && !page().contains("the same bytes")
    );
    std::fs::remove_file(folder.path().join("scene.toml")).unwrap();
    assert!(page().contains("this does not run") && !page().contains("the same bytes"));
}
