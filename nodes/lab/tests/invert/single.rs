//! One state from flags.

use crate::{grainlab, text};
use serde_json::Value;

const S1: [&str; 6] = [
    "invert",
    "--g12=121708340.234",
    "--g13=127373906.955",
    "--theta=144375790.847",
    "--pressure=50e3",
    "--gamma-over-delta=-0.0623",
];

fn json(flags: &[&str]) -> Value {
    let output = grainlab(&[flags, &["--format=json"]].concat(), b"");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn every_model_with_its_inputs_has_a_result_and_the_others_name_what_they_need() {
    let answer = json(&S1);
    let results = answer["results"].as_array().unwrap();
    let result = |model: &str| results.iter().find(|r| r["model"] == model).unwrap();
    assert!((result("ratio")["k"].as_f64().unwrap() - 5.73).abs() < 1e-6);
    assert_eq!(
        (&result("ratio")["calibration"], &result("ratio")["status"]),
        (&"paper".into(), &"ok".into())
    );
    let without_phi = result("emt");
    assert_eq!(without_phi["status"], "unknown");
    assert!(without_phi["warnings"][0].as_str().unwrap().contains("solid fraction"), "{without_phi}");
    let with_phi = json(&[&S1[..], &["--phi=0.636", "--model=emt"]].concat());
    assert!(with_phi["results"][0]["k"].as_f64().is_some(), "{with_phi}");
}

#[test]
fn several_calibrations_answer_one_after_the_other() {
    let answer = json(&[&S1[..], &["--model=ratio", "--calibration=grainlab,paper"]].concat());
    let names: Vec<_> =
        answer["results"].as_array().unwrap().iter().map(|r| r["calibration"].clone()).collect();
    assert_eq!(names, ["grainlab", "paper"]);
    assert_ne!(answer["results"][0]["k"], answer["results"][1]["k"]);
    let refused = grainlab(&[&S1[..], &["--calibration=nowhere.toml"]].concat(), b"");
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("nowhere.toml"));
}

#[test]
fn explained_shares_sum_to_the_variance() {
    let answer = json(&[&S1[..], &["--error=0.01", "--model=ratio", "--explain"]].concat());
    let explained = answer["explained"].as_array().unwrap();
    assert_eq!(explained.iter().map(|e| e["quantity"].clone()).collect::<Vec<_>>(), ["k", "k_hat", "eps"]);
    for e in explained {
        let shares: Vec<f64> =
            e["information"].as_object().unwrap().values().map(|s| s.as_f64().unwrap()).collect();
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{e}");
        assert_eq!(
            e["sigma"], e["sigma_data"],
            "the paper's calibration knows nothing of what its model leaves out"
        );
        assert!(e["sigma_model"].is_null() && e["condition_number"].as_f64().unwrap() > 1.0);
    }
    assert!(explained[0]["information"]["Theta"].as_f64().unwrap() > 0.9, "k follows Theta almost alone");
    assert!(explained[2]["information"]["Theta"].is_null(), "and eps does not hear of it");

    let people = grainlab(&[&S1[..], &["--error=0.01", "--explain"]].concat(), b"");
    let people = text(&people.stdout);
    for word in ["from data", "from model", "condition", "G13", "98 %"] {
        assert!(people.contains(word), "{word:?} is missing:\n{people}");
    }
}

#[test]
fn the_error_of_the_model_is_separate_from_the_errors_of_the_data() {
    let flags = ["--error=0.01", "--phi=0.636", "--model=relaxed", "--explain"];
    let answer = json(&[&S1[..], &flags].concat());
    for e in answer["explained"].as_array().unwrap() {
        let [sigma, data, model] = ["sigma", "sigma_data", "sigma_model"].map(|k| e[k].as_f64().unwrap());
        assert!(data > 0.0 && model > 0.0, "{e}");
        assert!((sigma - data.hypot(model)).abs() < 1e-9 * sigma, "{e}");
    }
}

#[test]
fn small_errors_sampled_agree_with_those_propagated_and_a_seed_repeats_them() {
    let flags = ["--error=0.001", "--model=ratio", "--samples=20000", "--seed=7"];
    let answer = json(&[&S1[..], &flags].concat());
    let sampled = answer["sampled"].as_array().unwrap();
    assert_eq!(sampled.iter().map(|s| s["quantity"].clone()).collect::<Vec<_>>(), ["k", "k_hat", "eps"]);
    for s in sampled {
        let quantity = s["quantity"].as_str().unwrap();
        let linear = answer["results"][0]["sigma"][quantity].as_f64().unwrap();
        // The standard deviation of 20,000 draws has an error of half a percent.
        assert!((s["sigma"].as_f64().unwrap() / linear - 1.0).abs() < 0.02, "{s}");
        assert_eq!((s["draws"].as_u64(), s["unsolved"].as_u64()), (Some(20000), Some(0)));
    }
    assert_eq!(answer, json(&[&S1[..], &flags].concat()));
    let people = grainlab(&[&S1[..], &flags].concat(), b"");
    assert!(text(&people.stdout).contains("without solution"));
}

/// v = √(C/ρ) along and across the axis.
#[test]
fn wave_speeds_give_what_their_moduli_give() {
    const MODULI: [f64; 4] = [271.4e6, 285.6e6, 105.1e6, 108.9e6];
    const DENSITY: f64 = 1500.0;
    let state = ["invert", "--pressure=50e3", "--stress-ratio=0", "--size-spread=0", "--model=relaxed"];
    let flags = ["--c11", "--c33", "--g12", "--g13"].iter().zip(MODULI).map(|(f, m)| format!("{f}={m}"));
    let flags: Vec<String> = flags.chain(["--error=0.01".to_owned()]).collect();
    let by_moduli = json(&[&state[..], &flags.iter().map(String::as_str).collect::<Vec<_>>()].concat());
    let mut table = "angle_deg,mode,speed,speed_sigma\n".to_owned();
    for ((angle, mode), modulus) in [(90, "p"), (0, "p"), (90, "sh"), (0, "sv")].iter().zip(MODULI) {
        let speed = (modulus / DENSITY).sqrt();
        table += &format!("{angle},{mode},{speed},{}\n", 0.005 * speed);
    }
    let output = grainlab(
        &[&state[..], &["--speeds=-", "--density=1500", "--format=json"]].concat(),
        table.as_bytes(),
    );
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("do not determine Theta, C13"), "{}", text(&output.stderr));
    let by_speeds: Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in ["k", "z", "eps", "eps_stiffness"] {
        let [moduli, speeds] = [&by_moduli, &by_speeds].map(|a| a["results"][0][key].as_f64().unwrap());
        assert!((moduli - speeds).abs() < 1e-9, "{key}: {moduli} {speeds}");
    }
    let refused =
        grainlab(&[&state[..], &["--speeds=-", "--density=1500"]].concat(), b"angle_deg,mode,speed\n0,q,1\n");
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("line 2: mode"), "{}", text(&refused.stderr));
}
