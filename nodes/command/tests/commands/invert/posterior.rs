//! Priors, draws, evidence and predictive checks.

use crate::invert::{grainlab, table};
use serde_json::Value;

const STATE: [&str; 10] = [
    "invert",
    "--g12=74.224e6",
    "--g13=81.816e6",
    "--theta=136.988e6",
    "--pressure=50e3",
    "--stress-ratio=0",
    "--size-spread=0",
    "--grain-shear-modulus=35.3e9",
    "--poisson=0.212",
    "--error=0.01",
];

fn json(flags: &[&str]) -> Value {
    let output = grainlab(&[&STATE[..], flags, &["--format=json"]].concat(), b"").assert_code(0);
    output.json()
}

/// A file in a folder that is removed at the end.
fn file(name: &str, content: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    let path = path.to_string_lossy().into_owned();
    (folder, path)
}

#[test]
fn the_printed_prior_is_read_back_and_changes_nothing_but_rounding() {
    let printed = grainlab(&["invert", "--print-prior"], b"").assert_code(0);
    let printed = printed.stdout;
    assert!(printed.contains("[z]") && printed.contains("[eps]") && printed.contains("relaxed"), "{printed}");
    let (_folder, path) = file("prior.toml", &printed);
    let again = grainlab(&["invert", "--print-prior", "--prior", &path], b"");
    assert_eq!(again.stdout, printed);
    let [without, with] = [
        &["--model=relaxed", "--probe=sticking"][..],
        &["--model=relaxed", "--probe=sticking", "--prior", &path],
    ]
    .map(|flags| json(flags)["results"][0].clone());
    for key in ["k", "z", "eps", "eps_stiffness"] {
        let [a, b] = [&without, &with].map(|r| r[key].as_f64().unwrap());
        let sigma = without["sigma"][key].as_f64().unwrap();
        assert!((a - b).abs() < 1e-3 * sigma, "{key}: {a} {b}");
    }
}

#[test]
fn a_prior_moves_the_estimate_and_its_part_of_the_uncertainty_is_explained() {
    let (_folder, path) = file("prior.toml", "[z]\ndistribution = \"normal\"\nmean = 4.8\nstddev = 0.02\n");
    let answer = json(&["--model=relaxed", "--prior", &path, "--explain"]);
    let (z, free) = (answer["results"][0]["z"].as_f64().unwrap(), json(&["--model=relaxed"]));
    let free = free["results"][0]["z"].as_f64().unwrap();
    assert!((z - 4.8).abs() < 0.5 * (free - 4.8).abs(), "{free} {z}");
    let explained = answer["explained"].as_array().unwrap();
    let of_z = explained.iter().find(|e| e["quantity"] == "z").unwrap();
    let parts = ["sigma_data", "sigma_model", "sigma_prior"].map(|k| of_z[k].as_f64().unwrap());
    let sigma = of_z["sigma"].as_f64().unwrap();
    assert!(
        (parts.iter().map(|p| p * p).sum::<f64>().sqrt() / sigma - 1.0).abs() < 1e-9 && sigma < 0.02,
        "{of_z}"
    );
    let (code, rows, errors) = table(
        "pressure_pa,g12_pa,g13_pa,theta_pa\n5e4,74e6,82e6,137e6\n",
        &["--model=relaxed", "--error=0.01", "--prior", &path],
    );
    // Three moduli for two unknowns: these contradict each other at 1 %.
    assert_eq!((code, rows[0]["status"].as_str()), (4, Some("contradictory")), "{errors}");
    assert!((crate::invert::number(&rows[0], "z") - 4.8).abs() < 0.05, "{rows:?}");
}

#[test]
fn priors_that_cannot_be_meant_are_refused_with_file_and_place() {
    for (content, model, words) in [
        (
            "[z]\ndistribution = \"uniform\"\nlow = 8\nhigh = 9\n",
            "relaxed",
            &["prior.toml", "prior of z", "relaxed"][..],
        ),
        (
            "[z]\ndistribution = \"normal\"\nmean = 5\nstddev = 0.1\n",
            "ratio",
            &["prior.toml", "[z]", "no model infers it"],
        ),
        (
            "[z]\ndistribution = \"normal\"\nmean = 5\n",
            "relaxed",
            &["prior.toml", "[z]", "stddev is missing"],
        ),
    ] {
        let (_folder, path) = file("prior.toml", content);
        let output = grainlab(&[&STATE[..], &["--model", model, "--prior", &path]].concat(), b"");
        assert_eq!(output.code, Some(2), "{content}");
        let errors = output.stderr;
        assert!(words.iter().all(|word| errors.contains(word)), "{errors}");
    }
    let missing = grainlab(&[&STATE[..], &["--prior=nowhere.toml"]].concat(), b"");
    assert_eq!(missing.code, Some(1));
}

#[test]
fn draws_are_written_in_both_forms_and_a_seed_repeats_them() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, flags: &[&str]| {
        let path = folder.path().join(name).to_string_lossy().into_owned();
        let flags =
            [&STATE[..], &["--model=relaxed", "--draws", &path, "--draws-per-chain=50"], flags].concat();
        grainlab(&flags, b"").assert_code(0);
        std::fs::read_to_string(path).unwrap()
    };
    let csv = write("a.csv", &[]);
    assert_eq!(csv.lines().count(), 201);
    assert_eq!(write("b.csv", &[]), csv);
    assert_ne!(write("c.csv", &["--seed=1"]), csv);
    let data: Value = serde_json::from_str(&write("d.json", &["--chains=2"])).unwrap();
    assert_eq!(data["posterior"]["z"].as_array().unwrap().len(), 2);
    let z = data["posterior"]["z"][0][0].as_f64().unwrap();
    let first: Vec<&str> = csv.lines().nth(1).unwrap().split(',').collect();
    assert_eq!(first[2].parse::<f64>().unwrap(), z);
    assert_eq!(data["coords"]["modulus"], serde_json::json!(["G12", "G13", "Theta"]));
    let refused = grainlab(&[&STATE[..], &["--draws=draws.txt", "--model=relaxed"]].concat(), b"");
    assert!(refused.code == Some(2) && refused.stderr.contains("draws.txt"));
    let refused = grainlab(&[&STATE[..], &["--draws=draws.csv"]].concat(), b"");
    assert!(refused.code == Some(2) && refused.stderr.contains("--model relaxed"));
}

#[test]
fn probabilities_are_of_models_with_the_same_moduli_and_follow_the_prior_odds() {
    let flags =
        ["--calibration=grainlab", "--evidence", "--model=relaxed,ratio,ratio-as-printed,directional"];
    let probabilities = |flags: &[&str]| {
        let answer = json(flags);
        let models = answer["evidence"].as_array().unwrap().clone();
        let none = models.iter().find(|m| m["model"] == "directional").unwrap().clone();
        assert!(
            none["probability"].is_null() && none["reason"].as_str().unwrap().contains("fewer"),
            "{none}"
        );
        let of = |model: &str| {
            let found = models.iter().find(|m| m["model"] == model).unwrap();
            [found["ln_evidence"].as_f64().unwrap(), found["probability"].as_f64().unwrap()]
        };
        ["relaxed", "ratio", "ratio-as-printed"].map(of)
    };
    let even = probabilities(&flags);
    assert!((even.iter().map(|m| m[1]).sum::<f64>() - 1.0).abs() < 1e-9);
    let ratio = (even[1][1] / even[0][1]).ln();
    assert!((ratio - (even[1][0] - even[0][0])).abs() < 1e-9, "{even:?}");
    let odd = probabilities(&[&flags[..], &["--prior-odds=ratio=3"]].concat());
    assert!((odd[1][1] / odd[0][1] / (even[1][1] / even[0][1]) - 3.0).abs() < 1e-6, "{odd:?}");
    // Whatever the digits of the moduli.
    for theta in ["136e6", "136.1e6", "137.3e6"] {
        let state =
            ["invert", "--g12=104.2e6", "--g13=112.4e6", "--pressure=50e3", "--error=0.01", "--format=json"];
        let output = grainlab(&[&state[..], &flags, &["--theta", theta]].concat(), b"");
        let answer: Value = output.json();
        let known =
            answer["evidence"].as_array().unwrap().iter().filter(|m| m["probability"].is_number()).count();
        assert_eq!(known, 3, "{theta}");
    }
    // With C11, C33 and C13 the models do not use the same moduli.
    let more = ["--c11=226.698e6", "--c33=264.817e6", "--c13=89.544e6"];
    let answer = json(&[&flags[..], &more].concat());
    let relaxed =
        answer["evidence"].as_array().unwrap().iter().find(|m| m["model"] == "relaxed").unwrap().clone();
    assert!(relaxed["ln_evidence"].is_number() && relaxed["probability"].is_null(), "{relaxed}");
    let people = grainlab(&[&STATE[..], &flags, &more].concat(), b"");
    assert!(people.stdout.contains("not comparable"), "{}", people.stdout);
}

#[test]
fn moduli_unlike_any_packing_are_contradictory_when_explained() {
    let moduli = ["--c11=226.698e6", "--c33=264.817e6"];
    let ordinary = json(&[&moduli[..], &["--model=relaxed", "--explain"]].concat());
    let ordinary = &ordinary["predictive"][0];
    assert_eq!((&ordinary["model"], &ordinary["unlikely"]), (&"relaxed".into(), &false.into()), "{ordinary}");
    assert_eq!(ordinary["moduli"].as_array().unwrap().len(), 5);
    let odd = [&STATE[..], &["--c11=280e6", "--c33=264.817e6", "--model=relaxed", "--explain"]].concat();
    let output = grainlab(&odd, b"").assert_code(4);
    let odd = output.stdout;
    assert!(odd.contains("p left out") && odd.contains("contradictory"), "{odd}");
}

#[test]
fn draws_that_scatter_otherwise_than_the_estimate_are_said_to_do_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("draws.csv").to_string_lossy().into_owned();
    let said = |pressure: &str| {
        let state =
            ["invert", "--g12=104.2e6", "--g13=112.4e6", "--theta=136e6", "--pressure=50e3", "--error=0.01"];
        let rest = ["--stress-ratio=0", "--size-spread=0", "--model=relaxed", "--draws", &path, pressure];
        let output = grainlab(&[&state[..], &rest].concat(), b"").assert_code(0);
        output.stderr.contains("the draws of eps scatter by")
    };
    assert!(said("--pressure-sigma=40e3"));
}
