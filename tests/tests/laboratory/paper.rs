//! The paper, an independent code, and programs that analyse posteriors, by the commands of the README.

use std::time::Duration;

use serde_json::Value;
use system_tests::lab::{Lab, golden, json_file};
use system_tests::python;

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
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 16);
    let all = lab.run(&["invert", "--table", &table.to_string_lossy(), "--format", "csv"]).assert_code(0);
    let mut results = all.stdout.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let names = results.next().unwrap();
    let cell = |row: &[&str], name: &str| row[names.iter().position(|n| *n == name).unwrap()].to_owned();
    let results: Vec<Vec<&str>> = results.collect();
    for (model, theta) in [("ratio", "theta_pa"), ("ratio-as-printed", "theta_printed_pa")] {
        let of_model: Vec<_> = results.iter().filter(|r| cell(r, "model") == model).collect();
        assert_eq!(of_model.len(), 16, "{model}:\n{}", all.stdout);
        for (row, of_table) in rows.iter().zip(of_model) {
            let given = |flag: &str, name: &str| format!("--{flag}={:e}", column(row, name));
            let ended = lab.run(&[
                "invert",
                "--format=json",
                &format!("--model={model}"),
                &given("g12", "g12_pa"),
                &given("g13", "g13_pa"),
                &given("theta", theta),
                &given("gamma-over-delta", "gamma_over_delta"),
                &format!("--pressure={:e}", 1e3 * column(row, "p_kpa")),
            ]);
            let by_flags = &ended.assert_code(0).json()["results"][0];
            assert_eq!((&by_flags["model"], cell(of_table, "sample").as_str()), (&model.into(), row[0]));
            for key in ["k", "k_hat", "eps"] {
                for found in [by_flags[key].as_f64().unwrap(), cell(of_table, key).parse().unwrap()] {
                    assert!((found - column(row, key)).abs() < 1e-6, "{model} {key} of {row:?}: {found}");
                }
            }
        }
    }
}

#[test]
fn analyze_by_probe_warns_where_contacts_open() {
    let lab = Lab::new();
    let reference = golden("reference/ref_packing_500.csv.gz");
    let by_probe = |amplitude: &str| -> Value {
        let arguments = ["--method", "probe", "--amplitude", amplitude, "--format", "json"];
        let ended = lab.run(&[&["analyze", &reference.to_string_lossy()], &arguments[..]].concat());
        ended.assert_code(0).json()[0].take()
    };
    let found = by_probe("1e-7");
    let about_amplitude = |of: &Value| {
        of["warnings"].as_array().unwrap().iter().any(|w| w.as_str().unwrap().contains("--amplitude"))
    };
    // The only note is on contacts at the Coulomb limit.
    let notes = found["warnings"].as_array().unwrap();
    assert!(notes.len() == 1 && !about_amplitude(&found), "{notes:?}");
    let far = by_probe("1e-5");
    assert!(about_amplitude(&far), "{}", far["warnings"]);
}

/// The sixteen states with 500 grains and one seed, whose scatter is some .02 in ε and .03 in γ/Δ.
#[test]
fn the_sixteen_states_of_the_paper_are_near_its_tables() {
    let lab = Lab::new();
    lab.start(&["reproduce", "--quick"]).ended(Duration::from_secs(300)).assert_code(0);
    let folder = lab.folder().join("recordings/campaigns/paper-500");
    let found = json_file(&folder.join("reproduction.json"));
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

/// The first state of the ensemble `wide`.
const STATE: [&str; 14] = [
    "invert",
    "--model=relaxed",
    "--g12=74.224e6",
    "--g13=81.816e6",
    "--theta=136.988e6",
    "--c11=226.698e6",
    "--c33=264.817e6",
    "--c13=89.544e6",
    "--pressure=50e3",
    "--stress-ratio=0",
    "--size-spread=0",
    "--grain-shear-modulus=35.3e9",
    "--poisson=0.212",
    "--error=0.01",
];

#[test]
fn arviz_corner_and_pandas_read_draws_and_find_the_estimate() {
    let Some(python) = python::with("arviz, corner, pandas") else { return };
    let lab = Lab::new();
    let [json, csv, estimate] =
        ["draws.json", "draws.csv", "estimate.json"].map(|name| lab.folder().join(name));
    for file in [&json, &csv] {
        let run = lab.run(&[&STATE[..], &["--format=json", "--draws", file.to_str().unwrap()]].concat());
        std::fs::write(&estimate, run.assert_code(0).stdout).unwrap();
    }
    let files = [&json, &csv, &estimate].map(|path| path.to_str().unwrap());
    let read = python::tool(&python, "check_draws.py", &files);
    let (out, err) = (String::from_utf8_lossy(&read.stdout), String::from_utf8_lossy(&read.stderr));
    assert!(read.status.success(), "{out}{err}");
}
