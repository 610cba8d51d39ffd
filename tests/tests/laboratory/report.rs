//! The page of a run, that of many runs, and pictures without a display.

use grainlab_msgs::{from_cdr, msg};
use grainlab_recordings::{Recording, Selection};
use serde_json::Value;
use system_tests::lab::{Lab, golden};
use system_tests::python;

/// The texts of a page: without scripts and data.
fn visible(page: &str) -> String {
    page.split("<script").map(|part| part.split_once("</script>").map_or(part, |(_, rest)| rest)).collect()
}

fn read(path: &std::path::Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn a_launch_writes_a_page_with_the_results_of_its_summary() {
    let lab = Lab::new();
    let run = lab.launch(&golden("scenes/tiny.toml"), &[]);
    let page = read(&run.join("report.html"));
    let summary: Value = serde_json::from_str(&read(&run.join("summary.json"))).unwrap();
    let state = summary["states"].as_array().and_then(|s| s.last()).expect("the run has a state");
    let number = |key: &str| state[key].as_f64().unwrap_or_else(|| panic!("{key}: {state}"));
    let page = visible(&page);
    let texts = [
        format!("{:.3}", number("k")),
        format!("{:.3}", number("z")),
        format!("{:.4}", number("eps")).replace('-', "−"),
        format!("{:.4}", number("phi")),
        format!("{:.2}", number("pressure_pa") / 1e3),
        format!("{:.2}", number("g12_pa") / 1e6),
        format!("{:.2}", number("theta_pa") / 1e6),
        summary["exchanges"].to_string(),
        summary["run"].as_str().unwrap().to_owned(),
    ];
    for text in texts {
        assert!(page.contains(&text), "{text} is missing");
    }
    assert!(page.contains("Complete") && !page.contains("Missing or not readable"));
    // The command makes the same page again.
    let before = read(&run.join("report.html"));
    std::fs::remove_file(run.join("report.html")).unwrap();
    let again = lab.run(&["report", &run.to_string_lossy()]);
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    assert!(read(&run.join("report.html")).len() == before.len());
}

#[test]
fn every_page_is_valid_html_and_loads_nothing() {
    let Some(python) = python::with("html5lib") else { return };
    let lab = Lab::new();
    let scene = golden("scenes/tiny.toml");
    let first = lab.launch(&scene, &["--set", "numerics.energy_balance=true"]);
    let second = lab.launch(&scene, &["--seed", "3"]);
    let texts = [first.display().to_string(), second.display().to_string()];
    let many = lab.run(&["report", "-o", "all.html", &texts[0], &texts[1]]);
    assert_eq!(many.code, Some(0), "{}", many.stderr);
    let view = lab.run(&["view", &texts[0], "-o", "view.html"]);
    assert_eq!(view.code, Some(0), "{}", view.stderr);
    let pages = [first.join("report.html"), lab.folder().join("all.html"), lab.folder().join("view.html")];
    let pages: Vec<String> = pages.iter().map(|p| p.display().to_string()).collect();
    let arguments: Vec<&str> = pages.iter().map(String::as_str).collect();
    let checked = python::tool(&python, "check_html.py", &arguments);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
}

#[test]
fn the_energy_balance_that_a_scene_asks_for_is_recorded_and_shown() {
    let lab = Lab::new();
    let run = lab.launch(&golden("scenes/tiny.toml"), &["--set", "numerics.energy_balance=true"]);
    let recording = Recording::open(&run).unwrap();
    let selection = Selection::topics(["/energy"]);
    let balances: Vec<msg::EnergyBalance> =
        recording.messages(&selection).unwrap().map(|m| from_cdr(&m.payload).unwrap()).collect();
    let summary: Value = serde_json::from_str(&read(&run.join("summary.json"))).unwrap();
    assert!(balances.len() >= 3, "{balances:?} {}", summary["topics"]);
    let page = visible(&read(&run.join("report.html")));
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
    let without = lab.launch(&golden("scenes/tiny.toml"), &[]);
    assert!(!visible(&read(&without.join("report.html"))).contains("Energy dissipated"));
}

#[test]
fn a_report_that_cannot_be_written_changes_neither_the_exit_code_nor_the_run() {
    let lab = Lab::new();
    let scene = golden("scenes/tiny.toml");
    let run = lab.folder().join("mine");
    // A folder in its place cannot be replaced.
    std::fs::create_dir_all(run.join("report.html")).unwrap();
    let arguments = ["launch", "--scene", &scene.to_string_lossy(), "--run", &run.to_string_lossy()];
    let ended = lab.run(&arguments);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    assert!(ended.stderr.contains("no report"), "{}", ended.stderr);
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
        let ended = lab.run(&arguments);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        std::fs::read(lab.folder().join(name)).unwrap()
    };
    let first = draw("a.png", &[]);
    assert!(first.starts_with(b"\x89PNG") && first == draw("b.png", &[]));
    assert_ne!(first, draw("c.png", &["--color", "force"]));
    for (wrong, code) in [("--size=9", 2), ("--state=0", 2), ("--state=2", 1), ("--state=-2", 1)] {
        let ended = lab.run(&["view", &packing.to_string_lossy(), "--png", "d.png", wrong]);
        assert_eq!(ended.code, Some(code), "{wrong}: {}", ended.stderr);
        assert!(!lab.folder().join("d.png").exists());
    }
}

#[test]
fn a_page_of_a_packing_from_another_program_is_written_beside_it() {
    let lab = Lab::new();
    let packing = lab.folder().join("mine.data.gz");
    std::fs::copy(golden("packings/packing_2000.data.gz"), &packing).unwrap();
    let flags = ["--shear-modulus", "29e9", "--poisson", "0.2", "--density", "2500", "--friction", "0.3"];
    let ended = lab.run(&[&["view", &packing.to_string_lossy()], &flags[..]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let path = lab.folder().join("mine.view.html");
    assert_eq!(ended.stdout.trim(), path.display().to_string());
    let page = read(&path);
    assert!(page.len() < 6_000_000 && page.contains("2000 grains") && page.contains("viewer-state-0"));
}
