//! `grainlab analyze` of many files: order, invalid files, interruption.

use crate::{GLASS, REFERENCE, dump, grainlab};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};
use system_tests::process::{Ended, send};

fn analyze(arguments: &[&str]) -> Ended {
    grainlab(&[&["analyze"], arguments].concat())
}

/// Writes a file into the folder; its path as an argument.
fn file(folder: &tempfile::TempDir, name: &str, text: &str) -> String {
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

#[test]
fn one_bad_file_of_ten_loses_none_of_the_others_and_sets_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let mut names = Vec::new();
    for k in 0..10u64 {
        let text = dump(0.19, &[100 * k, 100 * k + 1, 100 * k + 2]);
        // The invalid one ends in the middle of its second frame: its first one counts.
        let text = if k == 4 { text[..text.len() / 2].to_owned() } else { text };
        names.push(file(&folder, &format!("{k}.dump"), &text));
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    // Two grains have no network; a file that cannot be read has the worse exit code.
    let out = analyze(&[&names[..], &GLASS, &["--format", "json"]].concat()).assert_code(1);
    assert!(out.stderr.contains("4.dump: line ") && out.stderr.lines().count() == 1, "{}", out.stderr);
    let states: Value = out.json();
    let steps: Vec<u64> = states.as_array().unwrap().iter().map(|s| s["step"].as_u64().unwrap()).collect();
    let expected =
        (0..10).flat_map(|k| if k == 4 { vec![400] } else { vec![100 * k, 100 * k + 1, 100 * k + 2] });
    assert_eq!(steps, expected.collect::<Vec<_>>(), "in the order given");
}

#[test]
fn missing_properties_of_a_file_are_listed_and_the_exit_code_is_that_of_usage() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.txt", "#format x_y_z_r\n0.1\t0\t0\t0.1\n0.29\t0\t0\t0.1\n");
    analyze(&[&path]).assert_code(2).assert_says(&["a.txt", "--cell", "--shear-modulus", "--friction"]);
    // Two grains have no network.
    analyze(&[&[path.as_str()], &GLASS[..], &["--cell", "1,1,1"]].concat())
        .assert_code(4)
        .assert_prints(&["2 grains, 1 contact, 2 rattlers"]);
}

#[test]
fn numbers_out_of_range_are_refused_by_the_name_of_their_flag() {
    for (flag, values) in [
        ("--friction", &["-1"][..]),
        ("--shear-modulus", &["-2e9", "0", "NaN"]),
        ("--poisson", &["0.9"]),
        ("--density", &["-1"]),
        ("--tolerance", &["-0.5"]),
        ("--amplitude", &["0", "0.1"]),
    ] {
        for value in values {
            let method = if flag == "--amplitude" { "probe" } else { "network" };
            let ended = analyze(&["x.csv", flag, value, "--method", method]);
            ended.assert_code(2).assert_says(&[flag, "out of range"]);
        }
    }
}

#[test]
fn the_script_for_yade_is_printed() {
    analyze(&["--yade-script"]).assert_code(0).assert_prints(&["def export(name)"]);
}

#[test]
fn a_recording_that_exists_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    for code in [0, 2] {
        analyze(&[REFERENCE, "--record", &out.to_string_lossy()]).assert_code(code);
    }
}

#[test]
fn an_interrupted_analysis_prints_what_it_has() {
    const FILES: usize = 300;
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    command.arg("analyze").args([REFERENCE; FILES]).args(["--format", "json"]).stdin(Stdio::null());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut out = BufReader::new(child.stdout.take().unwrap());
    let mut text = String::new();
    // The first result: long before the last.
    while !text.contains("\"step\"") {
        assert_ne!(out.read_line(&mut text).unwrap(), 0, "{text}");
    }
    send(child.id(), libc::SIGINT);
    out.read_to_string(&mut text).unwrap();
    let ended = child.wait_with_output().unwrap();
    let err = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(130), "{err}");
    let states: Value = serde_json::from_str(&text).unwrap();
    let count = states.as_array().unwrap().len();
    assert!((1..FILES).contains(&count), "{count}");
    assert!(err.contains(&format!("interrupted: {count} packing")), "{err}");
}

/// Measures 500 grains without friction: their moduli, and whether these belong to smooth grains.
fn of_smooth_grains(command: &str, flags: &[&str]) -> Value {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/packings/smooth_500.csv.gz");
    let out = grainlab(&[&[command, file, "--format", "json"], flags].concat()).assert_code(0);
    let mut states: Value = out.json();
    let state = states[0].take();
    serde_json::json!([state["smooth"], state["stiffness_pa"], state["theta_bound_pa"], state["g12_pa"]])
}

#[test]
fn grains_without_friction_have_no_tangential_springs_in_analyze_and_probe_unless_asked_for() {
    let smooth = of_smooth_grains("analyze", &[]);
    assert_eq!(smooth[0], true);
    assert_eq!(smooth, of_smooth_grains("analyze", &["--smooth"]));
    assert_eq!(smooth, of_smooth_grains("analyze", &["--springs", "normal"]));
    assert_eq!(smooth, of_smooth_grains("probe", &["--survey", "three"]));
    let both = of_smooth_grains("analyze", &["--springs", "both"]);
    assert_eq!(both[0], false);
    assert!(both[3].as_f64() > Some(2.0 * smooth[3].as_f64().unwrap()), "{both} {smooth}");
}

#[test]
fn warnings_that_a_table_has_no_column_for_are_printed_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "pair.dump", &dump(0.19, &[7]));
    analyze(&[&[path.as_str()], &GLASS[..], &["--format", "csv"]].concat())
        .assert_says(&["pair.dump, step 7: contacts were found from positions"]);
}

#[test]
fn flags_that_change_nothing_are_refused_with_what_they_need() {
    for (flags, word) in [
        (&["--amplitude", "1e-6"][..], "--method probe"),
        (&["--method", "probe", "--tolerance", "1e-8"], "another --method"),
        (&["--topic", "nothing"], "recordings"),
    ] {
        analyze(&[&[REFERENCE], flags].concat()).assert_code(2).assert_says(&[word]);
    }
}

#[test]
fn overlaps_beyond_every_contact_law_are_exit_4_for_every_command_that_reads_a_packing() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    std::fs::write(path("deep.dump"), dump(0.17, &[7])).unwrap();
    std::fs::write(
        path("deep.toml"),
        "name = 'deep'\nfriction = 0.3\n[start]\npacking = 'deep.dump'\n[material]\nshear_modulus = 29e9\npoisson_ratio = 0.2\n\
         density = 2500\n[[phase]]\nkind = 'relax'\nuntil = { elapsed = 1e-4 }\n",
    )
    .unwrap();
    let (deep, scene, page, out) = (path("deep.dump"), path("deep.toml"), path("deep.html"), path("out"));
    let glass = GLASS.join(" ");
    for (words, has_result) in [
        (format!("analyze {deep} {glass}"), true),
        (format!("probe {deep} {glass}"), true),
        (format!("view {deep} {glass} -o {page}"), true),
        (format!("bag export {deep} {glass} --format csv --out {out}"), true),
        (format!("scene check {scene}"), false),
        (format!("launch --scene {scene} --one-process --run {}", path("run")), false),
    ] {
        let ended = grainlab(&words.split(' ').collect::<Vec<_>>()).assert_code(4);
        let (said, printed) = (&ended.stderr, &ended.stdout);
        let all = format!("{said}{printed}").split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(all.contains("overlaps by more than 10 % of the smaller diameter"), "{words}: {all}");
        assert!(!printed.is_empty() || !has_result, "{words}");
    }
}

/// A row of each packing, whatever its moduli are.
#[test]
fn a_packing_without_moduli_keeps_its_row_beside_one_with_moduli() {
    let folder = tempfile::tempdir().unwrap();
    let grains = "p,1,0.1,0.1,0.1,0.11,0,0,0,0,0,0,0\np,2,0.1,0.1,0.28,0.11,0,0,0,0,0,0,0\n";
    let deep = file(&folder, "deep.csv", grains);
    let sidecar = r#"{"G": 29e9, "nu": 0.2, "density": 2500, "mu_prep": 0.3, "box_L": [1, 1, 1]}"#;
    file(&folder, "deep.json", sidecar);
    let columns = ["--format", "csv", "--columns", "step,pressure_pa,theta_pa"];
    let ended = analyze(&[&[deep.as_str(), REFERENCE], &columns[..]].concat()).assert_code(4);
    let cells = |row: &str| row.split(',').map(|cell| !cell.is_empty()).collect::<Vec<_>>();
    let rows: Vec<Vec<bool>> = ended.stdout.lines().skip(1).map(cells).collect();
    assert_eq!(rows, [vec![true, true, false], vec![true; 3]], "{}", ended.stdout);
}

/// Waves of the other packing do not make up for it.
#[test]
fn a_packing_that_overlaps_too_deeply_is_exit_4_of_probe_beside_one_with_wave_speeds() {
    let folder = tempfile::tempdir().unwrap();
    let edge = 0.178;
    let contacts =
        "c,0,0,-1,0,0,0.022,1e6,0,0,0\nc,0,0,0,-1,0,0.022,1e6,0,0,0\nc,0,0,0,0,-1,0.022,1e6,0,0,0\n";
    let deep = file(&folder, "deep.csv", &format!("p,0,0,0,0,0.1,10,0,0,0,0,0,0\n{contacts}"));
    let sidecar = format!(
        "{{\"G\": 29e9, \"nu\": 0.2, \"density\": 2500, \"mu_prep\": 0.3, \"box_L\": [{edge}, {edge}, {edge}]}}"
    );
    file(&folder, "deep.json", &sidecar);
    grainlab(&["probe", &deep, REFERENCE]).assert_code(4);
}
