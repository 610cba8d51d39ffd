//! The paper and an independent code, by the commands of the README.

use std::time::Duration;

use serde_json::Value;
use system_tests::lab::{Lab, golden};

#[test]
fn invert_reproduces_table_iii_from_the_moduli_it_implies() {
    let lab = Lab::new();
    let table = golden("table3.csv");
    let text = std::fs::read_to_string(&table).unwrap();
    let mut lines = text.lines().filter(|l| !l.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |row: &[&str], name: &str| -> f64 {
        let at = header.iter().position(|h| *h == name).unwrap_or_else(|| panic!("no column {name}"));
        row[at].parse().unwrap()
    };
    let mut rows = 0;
    for line in lines {
        let row: Vec<&str> = line.split(',').collect();
        for (model, theta) in [("ratio", "theta_pa"), ("ratio-as-printed", "theta_printed_pa")] {
            let given = |name: &str| format!("{:e}", column(&row, name));
            let arguments = [
                "invert".to_string(),
                format!("--g12={}", given("g12_pa")),
                format!("--g13={}", given("g13_pa")),
                format!("--theta={}", given(theta)),
                format!("--pressure={:e}", 1e3 * column(&row, "p_kpa")),
                format!("--gamma-over-delta={}", given("gamma_over_delta")),
                format!("--model={model}"),
                "--format=json".to_string(),
            ];
            let ended = lab.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
            assert_eq!(ended.code, Some(0), "{line}\n{}", ended.stderr);
            let answer: Value = serde_json::from_str(&ended.stdout).unwrap();
            let result = &answer["results"][0];
            assert_eq!(result["model"], model);
            for key in ["k", "k_hat", "eps"] {
                let (found, printed) = (result[key].as_f64().unwrap(), column(&row, key));
                assert!((found - printed).abs() < 1e-6, "{model} {key} of {line}: {found}");
            }
        }
        rows += 1;
    }
    assert_eq!(rows, 16);
    let all = lab.run(&["invert", "--table", &table.to_string_lossy(), "--format", "csv"]);
    assert_eq!(all.code, Some(0), "{}", all.stderr);
    let mut results = all.stdout.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let names = results.next().unwrap();
    let cell = |row: &[&str], name: &str| row[names.iter().position(|n| *n == name).unwrap()].to_owned();
    let results: Vec<Vec<&str>> = results.collect();
    for model in ["ratio", "ratio-as-printed"] {
        let of_model: Vec<_> = results.iter().filter(|r| cell(r, "model") == model).collect();
        assert_eq!(of_model.len(), 16, "{model}:\n{}", all.stdout);
        for (line, found) in text.lines().filter(|l| !l.starts_with('#')).skip(1).zip(of_model) {
            let row: Vec<&str> = line.split(',').collect();
            assert_eq!(cell(found, "sample"), row[0]);
            for key in ["k", "k_hat", "eps"] {
                let found: f64 = cell(found, key).parse().unwrap();
                assert!((found - column(&row, key)).abs() < 1e-6, "{model} {key} of {line}: {found}");
            }
        }
    }
}

#[test]
fn analyze_by_probe_gives_the_columns_of_lammps_and_warns_where_contacts_open() {
    let lab = Lab::new();
    let reference = golden("reference/ref_packing_500.csv.gz");
    let by_probe = |amplitude: &str| -> Value {
        let arguments = ["--method", "probe", "--amplitude", amplitude, "--format", "json"];
        let ended = lab.run(&[&["analyze", &reference.to_string_lossy()], &arguments[..]].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        serde_json::from_str::<Value>(&ended.stdout).unwrap()[0].take()
    };
    let sidecar: Value =
        serde_json::from_slice(&std::fs::read(golden("reference/ref_packing_500.json")).unwrap()).unwrap();
    let found = by_probe("1e-7");
    let lammps = &sidecar["lammps_C_Pa_eps_1e-7"];
    let c = |m: &Value, i: usize, j: usize| m[i][j].as_f64().unwrap();
    for i in 0..6 {
        for j in 0..6 {
            let (ours, theirs) = (c(&found["stiffness_pa"], i, j), c(lammps, i, j));
            assert!((ours - theirs).abs() < 1e-3 * c(lammps, 0, 0), "C[{i}][{j}] {ours} {theirs}");
        }
    }
    let about_amplitude = |of: &Value| {
        of["warnings"].as_array().unwrap().iter().any(|w| w.as_str().unwrap().contains("--amplitude"))
    };
    // The only note is on contacts at the Coulomb limit.
    let notes = found["warnings"].as_array().unwrap();
    assert!(notes.len() == 1 && !about_amplitude(&found), "{notes:?}");
    let far = by_probe("1e-5");
    assert!(about_amplitude(&far), "{}", far["warnings"]);
}

#[test]
fn analyze_reproduces_the_numbers_of_lammps_on_its_own_packing() {
    let lab = Lab::new();
    let ended = lab.run(&[
        "analyze",
        &golden("reference/ref_packing_500.csv.gz").to_string_lossy(),
        "--format",
        "json",
    ]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let found: Value = serde_json::from_str(&ended.stdout).unwrap();
    let found = &found[0];
    let sidecar: Value =
        serde_json::from_slice(&std::fs::read(golden("reference/ref_packing_500.json")).unwrap()).unwrap();
    assert_eq!(found["grains"], 500);
    assert_eq!(found["contacts"], 1277);
    assert_eq!(found["rattlers"], 24);
    assert_eq!(found["k"], sidecar["Z_all"]);
    assert_eq!(found["z"], sidecar["Z_no_rattlers"]);
    let pressure = sidecar["pressure_from_contacts"].as_f64().unwrap();
    let s = &sidecar["stress_from_contacts"];
    for (i, (a, b)) in [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)].into_iter().enumerate() {
        let (ours, theirs) = (found["stress_pa"][i].as_f64().unwrap(), s[a][b].as_f64().unwrap());
        assert!((ours - theirs).abs() < 1e-9 * pressure, "stress {i}: {ours} {theirs}");
    }
    let c = |m: &Value, i: usize, j: usize| m[i][j].as_f64().unwrap();
    let sparse = &sidecar["C_relaxed_matrix_Pa_stiffness_matrix_mu_inf"];
    let c11 = c(sparse, 0, 0);
    // LAMMPS's columns: response to a strain, rows xx yy zz xy xz yz.
    let raw = &sidecar["lammps_static_moduli"]["raw"];
    let rows = [0, 1, 2, 5, 4, 3];
    for i in 0..6 {
        for j in 0..6 {
            let ours = c(&found["stiffness_pa"], i, j);
            assert!((ours - c(sparse, i, j)).abs() < 1e-5 * c11, "C[{i}][{j}] against the sparse solve");
            let column = ["xx", "yy", "zz", "yz", "xz", "xy"][j];
            let probe = raw[column]["1e-7"][rows[i]].as_f64().unwrap_or_else(|| panic!("no probe {column}"));
            assert!((ours - probe).abs() < 1e-3 * c11, "C[{i}][{j}] {ours} against the probe {probe}");
        }
    }
}

/// The sixteen states with 500 grains and one seed, whose scatter is some .02 in ε and .03 in γ/Δ.
#[test]
fn the_sixteen_states_of_the_paper_are_near_its_tables() {
    let lab = Lab::new();
    let ended = lab.start(&["reproduce", "--quick"]).ended(Duration::from_secs(300));
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    let folder = lab.folder().join("recordings/campaigns/paper-500");
    let text = std::fs::read(folder.join("reproduction.json")).unwrap();
    let found: Value = serde_json::from_slice(&text).unwrap();
    let states = found["states"].as_array().unwrap();
    let of = |quantity: &'static str| states.iter().filter(move |s| s["quantity"] == quantity);
    for (quantity, tolerance, relative) in
        [("z", 0.05, true), ("eps", 0.025, false), ("phi", 0.006, false), ("g_total", 0.045, false)]
    {
        let mut compared = 0;
        for state in of(quantity) {
            let Some(paper) = state["paper"].as_f64() else { continue };
            let ours = state["ours"].as_f64().unwrap();
            let error = (ours - paper).abs() / if relative { paper } else { 1.0 };
            assert!(error <= tolerance, "{state}");
            compared += 1;
        }
        assert_eq!(compared, if quantity == "phi" { 4 } else { 16 }, "{quantity}");
    }
    for claim in found["claims"].as_array().unwrap() {
        let text = claim["claim"].as_str().unwrap();
        let is_of_the_paper = ["coordination in the order", "G13 > G12", "ratios of moduli"];
        if is_of_the_paper.iter().any(|start| text.starts_with(start)) {
            assert_eq!(claim["verdict"], "holds", "{claim}");
        }
    }
    // One page without references to other files.
    let page = std::fs::read_to_string(folder.join("index.html")).unwrap();
    for outside in ["http://", "https://", "src=", "<link", "url(", "@import"] {
        let rest = page.replace("http://www.w3.org/2000/svg", "").replace("url(#", "");
        assert!(!rest.contains(outside), "{outside}");
    }
    assert!(!page.contains("NaN") && page.matches("<svg").count() == 20);
}
